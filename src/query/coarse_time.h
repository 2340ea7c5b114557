// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_QUERY_COARSE_TIME_H
#define FCL_CCD_QUERY_COARSE_TIME_H

#include <algorithm>
#include <cassert>
#include <cmath>

namespace fcl {
namespace detail {
namespace deformable {

/// @brief Brackets that times which differ by little have in common. In a query for the
/// first contact, pairs whose points nearly meet have such a bracket, which begins no
/// earlier than apartUntil() tells. Where much nearly meets at one place, a few pairs
/// then decide the answer, and the others are left out. No bracket depends on what else
/// was found, so the answer does not depend on which pairs were left out.
class CoarseTime {
 public:
  /// Smaller tolerances have no coarse times, and smaller times could be rounded up.
  static constexpr double kLeastTocErr = 0x1p-45, kLeastTime = 0x1p-1000;

  /// @param toc_err  the width of a bracket, at most; at least kLeastTocErr
  explicit CoarseTime(double toc_err) : toc_err_(toc_err) {
    assert(toc_err >= kLeastTocErr);
    while (std::ldexp(1, -bits_) > 0.125 * toc_err) ++bits_;
  }

  /// The beginning of the bracket of a time t >= kLeastTime. It is earlier by at most a
  /// quarter of toc_err and by at most 2^-12 of t. It grows with t.
  double beginning(double t) const {
    assert(kLeastTime <= t && t <= 1);
    int exponent;
    const double digits = std::frexp(t * kScale, &exponent);
    const double down = std::ldexp(std::floor(std::ldexp(digits, bits_)), -bits_);
    // Three roundings of 2^-53.
    const double out = std::ldexp(down, exponent) / kScale * (1 - 0x1p-51);
    assert(0 < out && out <= t);
    assert(t - out <= 0.25 * toc_err_ && t - out <= 0x1p-12 * t);
    return out;
  }

  /// The width that the bracket of a contact at t or later may have before it becomes
  /// coarse: half of toc_err, and 2^-12 of t.
  double widthFor(double t) const { return std::min(0.5 * toc_err_, 0x1p-12 * t); }

  /// The end of the bracket that begins here. It is as late as the end of any bracket of
  /// that width whose beginning becomes this one: 1 / (1 - 2^-12)^2 < 1 + 2^-11 + 2^-20.
  /// It is tight.
  double end(double beginning) const {
    return std::min(
        {1., beginning + 0.875 * toc_err_, beginning * (1 + 0x1p-11 + 0x1p-20)});
  }

 private:
  /// Times that are common in scenes, such as 1/2 and 1/3, are then not where one bracket
  /// ends and the next one begins.
  static constexpr double kScale = 1.4142;

  double toc_err_;
  /// 13 digits after the point lose at most 2^-12 of a time.
  int bits_{13};
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
