// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_ELEMENTARY_FRAME_DIGITS_H
#define FCL_CCD_ELEMENTARY_FRAME_DIGITS_H

#include <algorithm>
#include <cstdlib>

#include "elementary/feature_points.h"
#include "numerics/integer_coordinates.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief The powers of two by which a pair's coordinates become integers, and the clock
/// of these integers.
///
/// All coordinates of a frame share a power of two. Frames of very different size have
/// different powers, p and q. The vector (1 - t) 2^p a + t 2^q b is a positive multiple
/// of (1 - s) a + s b with s / (1 - s) = 2^(q - p) t / (1 - t). The factor decides
/// nothing, and s runs from 0 to 1 as t does.
struct FrameDigits {
  /// p and q.
  int lowest[2];
  /// q - p; 0 if s = t.
  int clock_exponent{0};
  /// The largest number of digits of an integer.
  int num_digits{0};

  explicit FrameDigits(const FeaturePoints& x) {
    // Up to this spread larger integers with one power cost less than fractions for t.
    constexpr int kMaxCommonSpread = 64;
    DigitRange range[2];
    for (int i = 0; i < 4; ++i)
      for (int k = 0; k < 3; ++k) {
        range[0].add(x[i].t0[k]);
        range[1].add(x[i].t1[k]);
      }
    const int common = std::min(range[0].lowest, range[1].lowest);
    lowest[0] = lowest[1] = common;
    if (!range[0].isEmpty() && !range[1].isEmpty() &&
        std::abs(range[0].highest - range[1].highest) > kMaxCommonSpread) {
      for (int frame = 0; frame < 2; ++frame) lowest[frame] = range[frame].lowest;
      clock_exponent = lowest[1] - lowest[0];
    }
    for (int frame = 0; frame < 2; ++frame)
      if (!range[frame].isEmpty())
        num_digits = std::max(num_digits, range[frame].highest - lowest[frame] + 1);
  }
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
