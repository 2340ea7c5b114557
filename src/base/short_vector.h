// SPDX-License-Identifier: BSD-3-Clause
//
// Short vectors of gcc and clang: compilers turn elementwise operations on them into
// vector instructions of whatever the target has, without a change in any result. Another
// compiler needs classes with the same operations here. Longer vectors, whose
// instructions are chosen at run time, are those of kernels/.
#ifndef FCL_CCD_BASE_SHORT_VECTOR_H
#define FCL_CCD_BASE_SHORT_VECTOR_H

#include <cstdint>
#include <type_traits>

#if !defined(__GNUC__) && !defined(__clang__)
#error "This compiler has no vector_size: see base/short_vector.h"
#endif

namespace fcl {
namespace detail {
namespace deformable {

typedef float Float2 __attribute__((vector_size(8)));
typedef float Float4 __attribute__((vector_size(16)));
typedef double Double2 __attribute__((vector_size(16)));
typedef std::uint32_t Word4 __attribute__((vector_size(16)));
typedef std::int64_t Long2 __attribute__((vector_size(16)));

/// A comparison of two Float4: all bits of a lane, or none.
typedef int Mask4 __attribute__((vector_size(16)));

/// @brief A bit for each lane.
inline int bitsOf(const Mask4& mask) {
#if defined(__SSE__)
  return __builtin_ia32_movmskps(reinterpret_cast<const Float4&>(mask));
#else
  return (mask[0] & 1) | (mask[1] & 2) | (mask[2] & 4) | (mask[3] & 8);
#endif
}

inline bool isAny(const Mask4& mask) { return bitsOf(mask) != 0; }

/// @brief Rounded to floats.
inline Float2 roundedToFloats(const Double2& x) {
  return __builtin_convertvector(x, Float2);
}

/// @brief A vector of chosen elements of a and b, whose numbers run through a, then b.
/// clang and gcc have a builtin for this, gcc from 12 on.
template <int... kChosen, typename Vector>
inline auto shuffle(const Vector& a, const Vector& b) {
#if __has_builtin(__builtin_shufflevector)
  return __builtin_shufflevector(a, b, kChosen...);
#else
  using Element = std::decay_t<decltype(a[0])>;
  constexpr int kSize = sizeof(Vector) / sizeof(Element);
  typedef Element Chosen
      __attribute__((vector_size(sizeof...(kChosen) * sizeof(Element))));
  return Chosen{(kChosen < kSize ? a : b)[kChosen % kSize]...};
#endif
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
