// SPDX-License-Identifier: BSD-3-Clause
//
// Coordinates as integers: doubles times a common power of two.
#ifndef FCL_CCD_NUMERICS_INTEGER_COORDINATES_H
#define FCL_CCD_NUMERICS_INTEGER_COORDINATES_H

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

#include "base/bits.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief A finite double as digits * 2^exponent. digits is odd, or 0 for the number 0.
/// It has at most 53 bits, or 24 if the number was a float.
struct BinaryDigits {
  std::int64_t digits;
  int exponent;

  explicit BinaryDigits(double value) : digits{0}, exponent{0} {
    std::uint64_t bits;
    assert(std::isfinite(value));
    std::memcpy(&bits, &value, sizeof bits);
    constexpr std::uint64_t kHidden = std::uint64_t{1} << 52;
    const auto field = static_cast<int>(bits >> 52 & 0x7ff);
    const std::uint64_t all = (bits & (kHidden - 1)) | (field == 0 ? 0 : kHidden);
    if (all == 0) return;
    const int zeros = lowestBit(all);
    digits = static_cast<std::int64_t>(all >> zeros);
    if (bits >> 63 != 0) digits = -digits;
    exponent = std::max(field, 1) - 1075 + zeros;
    assert(digits % 2 != 0);
    assert(std::ldexp(static_cast<double>(digits), exponent) == value);
  }

  int numDigits() const {
    assert(digits != 0);
    return 64 - leadingZeros(static_cast<std::uint64_t>(digits < 0 ? -digits : digits));
  }
};

/// @brief The exponents of the lowest and the highest bit of a set of numbers that are
/// not 0.
struct DigitRange {
  int lowest{std::numeric_limits<int>::max()};
  int highest{std::numeric_limits<int>::min()};

  void add(double value) {
    const BinaryDigits x(value);
    if (x.digits == 0) return;
    lowest = std::min(lowest, x.exponent);
    highest = std::max(highest, x.exponent + x.numDigits() - 1);
  }
  bool isEmpty() const { return lowest > highest; }
  /// @brief The number of bits of the integers. The range must not be empty.
  int numDigits() const {
    assert(!isEmpty());
    return highest - lowest + 1;
  }
};

/// @brief value * 2^-lowest, for a finite value in a DigitRange.
template <typename Integer>
Integer toInteger(double value, int lowest) {
  const BinaryDigits x(value);
  if (x.digits == 0) return 0;
  assert(x.exponent >= lowest);
  return Integer(x.digits) << static_cast<unsigned>(x.exponent - lowest);
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
