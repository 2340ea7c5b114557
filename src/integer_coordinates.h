// SPDX-License-Identifier: BSD-3-Clause
//
// Coordinates as integers: doubles times a common power of two.
#ifndef FCL_CCD_SRC_INTEGER_COORDINATES_H
#define FCL_CCD_SRC_INTEGER_COORDINATES_H

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace fcl {
namespace detail {
namespace deformable {

/// @brief Smallest and largest binary exponent of some numbers that are not 0.
struct ExponentRange {
  int lowest{std::numeric_limits<int>::max()};
  int highest{std::numeric_limits<int>::min()};

  void add(double value) {
    if (value == 0) return;
    const int exponent = std::ilogb(value);
    lowest = std::min(lowest, exponent);
    highest = std::max(highest, exponent);
  }
  bool isEmpty() const { return lowest > highest; }
};

/// @brief value * 2^(52 - lowest), an integer for every finite value whose exponent is
/// not below lowest (a subnormal has fewer bits than its exponent allows for, all zeros
/// below).
template <typename Integer>
Integer toInteger(double value, int lowest) {
  if (value == 0) return 0;
  const int exponent = std::ilogb(value);
  const auto digits = static_cast<std::int64_t>(std::scalbn(value, 52 - exponent));
  return Integer(digits) << static_cast<unsigned>(exponent - lowest);
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
