// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_MOTION_MOTION_BOXES_H
#define FCL_CCD_MOTION_MOTION_BOXES_H

#include <algorithm>
#include <cstdint>

#include "mesh/vertex_frames.h"
#include "numerics/moving_vector.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief A box in the frame of its body. Its points are center + sum of c_i axis_i + r,
/// with |c_i| <= extent_i and |r| <= pad. The axes are unit vectors at right angles, up
/// to rounding that the pad includes.
struct MotionBox {
  double center[3];
  double axis[3][3];
  double extent[3];
  double pad;
  /// The radius of a ball around the center that contains the box.
  double radius;
  /// Bound on the motion of a point in the body frame during the step.
  double displacement;
};

/// @brief Up to eight boxes, stored by member: each array has one member of all boxes.
struct alignas(64) MotionBoxes {
  static constexpr int kWidth = 8;
  double center[3][kWidth];
  double axis[3][3][kWidth];
  double extent[3][kWidth];
  double pad[kWidth];
  double radius[kWidth];
  double displacement[kWidth];

  void set(int lane, const MotionBox& box) {
    for (int k = 0; k < 3; ++k) {
      center[k][lane] = box.center[k];
      extent[k][lane] = box.extent[k];
      for (int i = 0; i < 3; ++i) axis[i][k][lane] = box.axis[i][k];
    }
    pad[lane] = box.pad;
    radius[lane] = box.radius;
    displacement[lane] = box.displacement;
  }
  MotionBox get(int lane) const {
    MotionBox box;
    for (int k = 0; k < 3; ++k) {
      box.center[k] = center[k][lane];
      box.extent[k] = extent[k][lane];
      for (int i = 0; i < 3; ++i) box.axis[i][k] = axis[i][k][lane];
    }
    box.pad = pad[lane];
    box.radius = radius[lane];
    box.displacement = displacement[lane];
    return box;
  }
};

/// @brief The poses of a body at the beginning, in the middle and at the end of a span.
struct SpanPoses {
  Pose beginning, middle, end;
};

/// @brief The windows in which eight boxes may overlap another one, as fractions of a
/// span.
struct MeetingWindows {
  /// A bit for each box that may overlap the other one.
  unsigned mask;
  double lo[MotionBoxes::kWidth];
  double hi[MotionBoxes::kWidth];
};

/// @brief Shortens a window to the part in which a gap may not be positive. The gap is at
/// least the line between its values at the beginning and at the end of the span. Rounds
/// outward.
/// @return whether there is such a part
inline bool narrowWindow(double first, double last, double& lo, double& hi) {
  if (first > 0 && last > 0) return false;
  const double root = first / (first - last);
  if (first > 0) lo = std::max(lo, root * (1 - 0x1p-40));
  if (last > 0) hi = std::min(hi, root * (1 + 0x1p-40));
  return true;
}

/// @brief A direction along which points deviate less from straight lines than along
/// others.
struct CalmDirection {
  /// Null: there is none.
  const Vec* direction;
  double margin[MotionBoxes::kWidth];
};

struct MotionKernels {
  /// The instruction set, as Highway calls it; "plain" without Highway.
  const char* name;

  /// Computes the windows of eight boxes of body b against one of body a. Along a fixed
  /// direction a point deviates by at most `margin` from the straight line between its
  /// positions at both ends of the span. So boxes are apart while the gap between them,
  /// interpolated between both ends, is larger than that. The directions are the axes of
  /// both boxes in the middle of the span, the line between the centers, and the calm
  /// directions, which have margins of their own.
  /// @param a, b  boxes at both ends
  /// @param margin  for each pair: deviation from straight lines, pads, requested
  /// distance and rounding, for unit directions; 0 for unused pairs
  /// @param count  the number of used pairs
  void (*meetingWindows)(const MotionBox (&a)[2], const SpanPoses& pose_a,
                         const MotionBoxes* const (&b)[2], const SpanPoses& pose_b,
                         const double (&margin)[8], const CalmDirection (&calm)[2],
                         int count, MeetingWindows& out);
};

/// @brief The kernels for this machine.
const MotionKernels& motionKernels();

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
