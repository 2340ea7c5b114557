// SPDX-License-Identifier: BSD-3-Clause
//
// Integers of a fixed number of words on the stack. Boost's, which are as long as their
// value, take five times as long for the few operations on points that nearly meet.
#ifndef FCL_CCD_NUMERICS_FIXED_INTEGER_H
#define FCL_CCD_NUMERICS_FIXED_INTEGER_H

#include <cassert>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "base/bits.h"
#include "base/double_word.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief An integer of kWords times 64 bits, in two's complement. Results are right if
/// they fit.
template <std::size_t kWords>
class FixedInteger {
 public:
  static constexpr int kBits = 64 * static_cast<int>(kWords);

  FixedInteger() = default;
  /// @brief digits * 2^shift, shift < kBits - 64.
  FixedInteger(std::int64_t digits, unsigned shift) {
    assert(shift < static_cast<unsigned>(kBits) - 64);
    const std::uint64_t sign = digits < 0 ? ~std::uint64_t{0} : 0;
    FixedInteger value;
    for (std::uint64_t& word : value.w_) word = sign;
    value.w_[0] = static_cast<std::uint64_t>(digits);
    *this = value << shift;
  }

  friend FixedInteger operator+(const FixedInteger& a, const FixedInteger& b) {
    FixedInteger sum;
    DoubleWord carry = 0;
    for (std::size_t i = 0; i < kWords; ++i) {
      carry += DoubleWord{a.w_[i]} + b.w_[i];
      sum.w_[i] = static_cast<std::uint64_t>(carry);
      carry >>= 64;
    }
    assert(a.isNegative() != b.isNegative() || sum.isNegative() == a.isNegative());
    return sum;
  }
  friend FixedInteger operator-(const FixedInteger& a, const FixedInteger& b) {
    FixedInteger difference;
    std::uint64_t borrow = 0;
    for (std::size_t i = 0; i < kWords; ++i) {
      const DoubleWord rest = DoubleWord{a.w_[i]} - b.w_[i] - borrow;
      difference.w_[i] = static_cast<std::uint64_t>(rest);
      borrow = static_cast<std::uint64_t>(rest >> 64) & 1;
    }
    assert(a.isNegative() == b.isNegative() || difference.isNegative() == a.isNegative());
    return difference;
  }
  /// @brief b < 2^127.
  friend FixedInteger operator*(const FixedInteger& a, DoubleWord b) {
    assert((b >> 127) == 0);
    const FixedInteger low = a.times(static_cast<std::uint64_t>(b));
    const auto high = static_cast<std::uint64_t>(b >> 64);
    return high == 0 ? low : low + (a.times(high) << 64);
  }
  friend FixedInteger operator<<(const FixedInteger& a, unsigned shift) {
    const std::size_t words = shift / 64;
    const unsigned bits = shift % 64;
    FixedInteger out;
    for (std::size_t i = 0; i < kWords; ++i) {
      const std::uint64_t word = i >= words ? a.w_[i - words] : 0,
                          below = i > words ? a.w_[i - words - 1] : 0;
      out.w_[i] = bits == 0 ? word : word << bits | below >> (64 - bits);
    }
    assert(out.isNegative() == a.isNegative());
    return out;
  }

  /// @brief The nearest double.
  double toDouble() const {
    const bool negative = isNegative();
    const FixedInteger size = negative ? FixedInteger(0, 0) - *this : *this;
    std::size_t top = kWords;
    while (top > 0 && size.w_[top - 1] == 0) --top;
    if (top == 0) return 0;
    // The leading 64 bits, of which the last one tells whether there is more: converting
    // them rounds as converting all does.
    std::uint64_t head = size.w_[top - 1], rest = 0;
    const auto zeros = static_cast<unsigned>(leadingZeros(head));
    if (top > 1) {
      rest = size.w_[top - 2] << zeros;
      if (zeros > 0) head = head << zeros | size.w_[top - 2] >> (64 - zeros);
      for (std::size_t i = 0; i + 2 < top; ++i) rest |= size.w_[i];
    } else {
      head <<= zeros;
    }
    if (rest != 0) head |= 1;
    const double value =
        static_cast<double>(head) *
        powerOfTwo(64 * static_cast<int>(top - 1) - static_cast<int>(zeros));
    return negative ? -value : value;
  }

  /// @brief 2^exponent, for a normal double.
  static double powerOfTwo(int exponent) {
    assert(-1022 <= exponent && exponent <= 1023);
    const std::uint64_t bits = static_cast<std::uint64_t>(exponent + 1023) << 52;
    double value;
    std::memcpy(&value, &bits, sizeof value);
    return value;
  }

 private:
  bool isNegative() const { return w_[kWords - 1] >> 63 != 0; }
  FixedInteger times(std::uint64_t b) const {
    FixedInteger product;
    DoubleWord carry = 0;
    for (std::size_t i = 0; i < kWords; ++i) {
      carry += DoubleWord{w_[i]} * b;
      product.w_[i] = static_cast<std::uint64_t>(carry);
      carry >>= 64;
    }
    assert(b == 0 || product.isNegative() == isNegative());
    return product;
  }

  std::uint64_t w_[kWords];  // the lowest first
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
