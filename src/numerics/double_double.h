// SPDX-License-Identifier: BSD-3-Clause
//
// Numbers as unevaluated sums of two doubles: twice the digits of a double.
//
// After Dekker 1971; error bounds: Joldes, Muller, Popescu 2017, "Tight and rigorous
// error bounds for basic building blocks of double-word arithmetic", algorithms 6 and 10.
// They hold if nothing underflows or overflows. An underflow adds less than 2^-1070,
// times the later factors.
#ifndef FCL_CCD_NUMERICS_DOUBLE_DOUBLE_H
#define FCL_CCD_NUMERICS_DOUBLE_DOUBLE_H

#include <cassert>
#include <cmath>

namespace fcl {
namespace detail {
namespace deformable {

/// @brief The sum hi + lo; hi is the double nearest to it.
struct DoubleDouble {
  double hi, lo;

  /// @brief Whether hi is the double nearest to the sum, unless something overflowed.
  bool isNormalized() const { return hi + lo == hi || !std::isfinite(lo); }

  /// @brief p - q, exact (Knuth's TwoSum).
  static DoubleDouble difference(double p, double q) {
    const double d = p - q;
    const double q_virtual = p - d, p_virtual = d + q_virtual;
    const DoubleDouble out{d, (p - p_virtual) + (q_virtual - q)};
    assert(out.isNormalized());
    return out;
  }
  /// @brief s + rest for |s| >= |rest|, exact.
  static DoubleDouble normalized(double s, double rest) {
    const double hi = s + rest;
    const DoubleDouble out{hi, rest - (hi - s)};
    assert(out.isNormalized());
    return out;
  }
};

/// Relative errors, with u = 2^-53: a product 7 u^2; a sum 3 u^2 + 13 u^3, also for terms
/// of different sign. A product of two doubles (lo = 0) is exact.
constexpr double kProductBound = 0x1p-103;
constexpr double kSumBound = 0x1p-104;

inline DoubleDouble operator*(const DoubleDouble& a, const DoubleDouble& b) {
  const double p = a.hi * b.hi;
  return DoubleDouble::normalized(p,
                                  std::fma(a.hi, b.hi, -p) + (a.hi * b.lo + a.lo * b.hi));
}

inline DoubleDouble operator-(const DoubleDouble& a, const DoubleDouble& b) {
  const DoubleDouble upper = DoubleDouble::difference(a.hi, b.hi),
                     lower = DoubleDouble::difference(a.lo, b.lo);
  const DoubleDouble s = DoubleDouble::normalized(upper.hi, upper.lo + lower.hi);
  return DoubleDouble::normalized(s.hi, s.lo + lower.lo);
}

inline DoubleDouble operator+(const DoubleDouble& a, const DoubleDouble& b) {
  return a - DoubleDouble{-b.hi, -b.lo};
}

using AccurateVector = DoubleDouble[3];

inline void cross(const AccurateVector& a, const AccurateVector& b, AccurateVector& n) {
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    n[k] = a[i] * b[j] - a[j] * b[i];
  }
}

inline DoubleDouble dot(const AccurateVector& a, const AccurateVector& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
