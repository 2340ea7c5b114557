// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_SHAPES_BODY_BOXES_H
#define FCL_CCD_SHAPES_BODY_BOXES_H

#include <algorithm>
#include <cassert>
#include <cstdint>

#include "base/bits.h"
#include "mesh/vertex_frames.h"
#include "numerics/moving_vector.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief A box in the frame of its body. Its points are center + sum of c_i axis_i + r,
/// with |c_i| <= extent_i and |r| <= pad. The axes are unit vectors at right angles, up
/// to rounding that the pad includes.
struct BodyBox {
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
struct alignas(64) BodyBoxes {
  static constexpr int kWidth = 8;
  double center[3][kWidth];
  double axis[3][3][kWidth];
  double extent[3][kWidth];
  double pad[kWidth];
  double radius[kWidth];
  double displacement[kWidth];

  void set(int lane, const BodyBox& box) {
    assert(0 <= lane && lane < kWidth);
    assert(!(box.pad < 0) && !(box.extent[0] < 0) && !(box.extent[1] < 0) &&
           !(box.extent[2] < 0));
    for (int k = 0; k < 3; ++k) {
      center[k][lane] = box.center[k];
      extent[k][lane] = box.extent[k];
      for (int i = 0; i < 3; ++i) axis[i][k][lane] = box.axis[i][k];
    }
    pad[lane] = box.pad;
    radius[lane] = box.radius;
    displacement[lane] = box.displacement;
  }
  BodyBox get(int lane) const {
    assert(0 <= lane && lane < kWidth);
    BodyBox box;
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

/// @brief Up to eight triangles in the frame of their body, stored by coordinate. A rigid
/// body has one frame.
struct alignas(64) BodyTriangles {
  /// Positions by frame, corner and coordinate.
  double corner[2][3][3][BodyBoxes::kWidth];
};

/// @brief The corners of a triangle in the world, at the beginning, in the middle and at
/// the end of a span.
struct SpanTriangle {
  double corner[3][3][3];
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
  double lo[BodyBoxes::kWidth];
  double hi[BodyBoxes::kWidth];
  /// A bit for each of these boxes that is apart at the beginning, in the middle and at
  /// the end of the span by so much that it is provably apart in parts of the span, if
  /// that is known.
  unsigned soon_apart{0};
  /// The largest of the gaps along directions, less their margins: the least of each one
  /// during the span. Set by what measures gaps, also for boxes that are apart.
  double gap[BodyBoxes::kWidth];

  /// @brief Whether the boxes are among the first `count`, and their windows begin and
  /// end in the span. For assertions, as those below.
  bool areInSpan(int count) const {
    bool are = mask >> count == 0;
    for (unsigned bits = mask; are && bits != 0; bits &= bits - 1) {
      const int lane = lowestBit(bits);
      are = !(lo[lane] < 0 || lo[lane] > 1) && !(hi[lane] < 0 || hi[lane] > 1);
    }
    return are;
  }
  /// @brief Whether no window ends before it begins, up to rounding.
  bool areOrdered() const {
    bool are = true;
    for (unsigned bits = mask; bits != 0; bits &= bits - 1)
      are &= !(lo[lowestBit(bits)] > hi[lowestBit(bits)] + 0x1p-50);
    return are;
  }
  /// @brief Whether all boxes with a gap are known to be apart.
  bool haveNoGap() const {
    bool have = true;
    for (unsigned bits = mask; bits != 0; bits &= bits - 1)
      have &= !(gap[lowestBit(bits)] > 0);
    return have;
  }
};

/// @brief What is known of the triangles of a node beside a triangle of the other side.
struct TriangleHalves {
  /// A bit for each triangle that was tested.
  unsigned tested{0};
  /// A bit for each of these that may meet the other one in a half of the span.
  unsigned meeting[2]{0, 0};

  unsigned left() const { return ~tested | meeting[0] | meeting[1]; }

  void narrow(MeetingWindows& windows) const {
    assert(((meeting[0] | meeting[1]) & ~tested) == 0);
    windows.mask &= left();
    for (unsigned bits = windows.mask & tested; bits != 0; bits &= bits - 1) {
      const int lane = lowestBit(bits);
      double &lo = windows.lo[lane], &hi = windows.hi[lane];
      if ((meeting[0] >> lane & 1U) == 0) lo = std::max(lo, 0.5);
      if ((meeting[1] >> lane & 1U) == 0) hi = std::min(hi, 0.5);
    }
  }
};

/// @brief Shortens a window to the part in which a gap may not be positive. The gap is at
/// least the line between its values at the beginning and at the end of the span. Rounds
/// outward.
/// @return whether there is such a part
inline bool narrowWindow(double first, double last, double& lo, double& hi) {
  assert(!(lo < 0) && !(hi > 1));
  if (first > 0 && last > 0) return false;
  const double root = first / (first - last);
  // A gap that changes its sign does so within the span.
  assert(!((first > 0) != (last > 0)) || !(root < 0 || root > 1));
  if (first > 0) lo = std::max(lo, root * (1 - 0x1p-40));
  if (last > 0) hi = std::min(hi, root * (1 + 0x1p-40));
  return true;
}

/// @brief A direction along which points deviate less from straight lines than along
/// others.
struct CalmDirection {
  /// Null: there is none.
  const Vec* direction;
  double margin[BodyBoxes::kWidth];
};

struct BodyKernels {
  /// The instruction set, as Highway calls it; "plain" without Highway.
  const char* name;

  /// Computes the windows of eight boxes of body b against one of body a. Along a fixed
  /// direction a point deviates by at most `margin` from the straight lines between its
  /// positions at the beginning, in the middle and at the end of the span. So boxes are
  /// apart while the gap between them, interpolated between these times, is larger than
  /// that. The directions are the axes of both boxes in the middle of the span, the line
  /// between the centers, and the calm directions, which have margins of their own.
  /// @param a, b  boxes at these times
  /// @param margin  for each pair: deviation from straight lines in a half of the span,
  /// pads, requested distance and rounding, for unit directions; 0 for unused pairs
  /// @param count  the number of used pairs
  void (*meetingWindows)(const BodyBox* const (&a)[3], const SpanPoses& pose_a,
                         const BodyBoxes* const (&b)[3], const SpanPoses& pose_b,
                         const double (&margin)[8], const CalmDirection (&calm)[2],
                         int count, MeetingWindows& out);

  /// The same, and measures gaps: MeetingWindows::gap.
  decltype(meetingWindows) meetingWindowsWithGaps;

  /// Tests eight triangles of body b against one of body a in both halves of a span.
  /// Along a direction the gap of two corners is at least the line between its values at
  /// both ends of the half, less 4 deviation s (1 - s) at the fraction s of the half. The
  /// triangles are apart if this is above the margin for all nine pairs of corners. The
  /// directions are those at right angles to a triangle, and to a triangle's normal and
  /// one of its edges, in the middle of the span.
  /// @param times  of the span: for corners of b that move in its frame; null: b is rigid
  /// @param deviation  the largest deviation of each pair from straight lines in a half
  /// @param margin  requested distance and rounding, for unit directions
  /// @param tested  a bit for each triangle of b that is tested
  /// @param meeting  gets a bit for each of these that may meet a in a half
  void (*meetingHalves)(const SpanTriangle& a, const BodyTriangles& b,
                        const double* times, const SpanPoses& pose_b,
                        const double (&deviation)[8], double margin, unsigned tested,
                        unsigned (&meeting)[2]);
};

/// @brief The kernels for this machine.
const BodyKernels& bodyKernels();

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
