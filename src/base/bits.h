// SPDX-License-Identifier: BSD-3-Clause
//
// Operations on bits, which C++17 has no functions for.
#ifndef FCL_CCD_BASE_BITS_H
#define FCL_CCD_BASE_BITS_H

#include <cassert>
#include <cstdint>

namespace fcl {
namespace detail {
namespace deformable {

#if defined(__GNUC__) || defined(__clang__)

/// @brief The place of the lowest bit that is set. @pre bits != 0
inline int lowestBit(std::uint32_t bits) {
  assert(bits != 0);
  return __builtin_ctz(bits);
}
inline int lowestBit(std::uint64_t bits) {
  assert(bits != 0);
  return __builtin_ctzll(bits);
}
/// @brief The number of zeros above the highest bit that is set. @pre bits != 0
inline int leadingZeros(std::uint64_t bits) {
  assert(bits != 0);
  return __builtin_clzll(bits);
}
inline int countBits(std::uint32_t bits) { return __builtin_popcount(bits); }

#else

inline int lowestBit(std::uint64_t bits) {
  assert(bits != 0);
  int place = 0;
  for (; (bits & 1) == 0; bits >>= 1) ++place;
  return place;
}
inline int lowestBit(std::uint32_t bits) { return lowestBit(std::uint64_t{bits}); }
inline int leadingZeros(std::uint64_t bits) {
  assert(bits != 0);
  int zeros = 0;
  for (; (bits >> 63) == 0; bits <<= 1) ++zeros;
  return zeros;
}
inline int countBits(std::uint32_t bits) {
  int count = 0;
  for (; bits != 0; bits &= bits - 1) ++count;
  return count;
}

#endif

inline int lowestBit(int bits) { return lowestBit(static_cast<std::uint32_t>(bits)); }
inline int countBits(int bits) { return countBits(static_cast<std::uint32_t>(bits)); }

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
