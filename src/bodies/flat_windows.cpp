// SPDX-License-Identifier: BSD-3-Clause
#include "bodies/flat_windows.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "paths/posed_vector.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

constexpr int kWidth = BodyBoxes::kWidth;

/// The heights of eight boxes above the plane: those of their centers, and half their
/// widths.
struct Heights {
  double center[kWidth], half_width[kWidth];

  Heights(const FlatShape& flat, const Pose& pose_flat, const BodyBoxes& boxes,
          const Pose& pose_boxes) {
    const Vec up = rotated(pose_flat.rotation, flat.normal),
              n = rotatedBack(pose_boxes.rotation, up);
    const double origin =
        dot(up, vecOf(pose_boxes.translation) - posed(pose_flat, flat.foot()));
    for (int lane = 0; lane < kWidth; ++lane) {
      center[lane] = origin + (n.x * boxes.center[0][lane] + n.y * boxes.center[1][lane] +
                               n.z * boxes.center[2][lane]);
      half_width[lane] = 0;
    }
    for (int i = 0; i < 3; ++i)
      for (int lane = 0; lane < kWidth; ++lane)
        half_width[lane] +=
            boxes.extent[i][lane] *
            std::abs(n.x * boxes.axis[i][0][lane] + n.y * boxes.axis[i][1][lane] +
                     n.z * boxes.axis[i][2][lane]);
  }
};

}  // namespace

void flatWindows(const FlatShape& flat, const SpanPoses& pose_flat,
                 const BodyBoxes* const (&boxes)[3], const SpanPoses& pose_boxes,
                 const double (&margin)[BodyBoxes::kWidth], int count,
                 MeetingWindows& out) {
  const Heights h0(flat, pose_flat.beginning, *boxes[0], pose_boxes.beginning),
      h1(flat, pose_flat.end, *boxes[2], pose_boxes.end);
  assert(0 < count && count <= kWidth);
  out.mask = 0;
  for (int lane = 0; lane < count; ++lane) {
    const double half0 = h0.half_width[lane] + margin[lane],
                 half1 = h1.half_width[lane] + margin[lane];
    assert(!(margin[lane] < 0) && !(half0 < 0) && !(half1 < 0));
    double &lo = out.lo[lane], &hi = out.hi[lane];
    lo = 0;
    hi = 1;
    const double above[2] = {h0.center[lane] - half0, h1.center[lane] - half1},
                 below[2] = {-h0.center[lane] - half0, -h1.center[lane] - half1};
    out.gap[lane] = std::min(above[0], above[1]);
    if (!flat.is_solid)
      out.gap[lane] = std::max(out.gap[lane], std::min(below[0], below[1]));
    if (!narrowWindow(above[0], above[1], lo, hi)) continue;
    if (!flat.is_solid && !narrowWindow(below[0], below[1], lo, hi)) continue;
    if (lo <= hi) out.mask |= 1U << lane;
  }
  assert(out.areInSpan(count) && out.areOrdered() && out.haveNoGap());
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
