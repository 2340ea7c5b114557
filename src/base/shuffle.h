// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_BASE_SHUFFLE_H
#define FCL_CCD_BASE_SHUFFLE_H

#include <type_traits>

namespace fcl {
namespace detail {
namespace deformable {

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
