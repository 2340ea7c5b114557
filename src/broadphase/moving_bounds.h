// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_BROADPHASE_MOVING_BOUNDS_H
#define FCL_CCD_BROADPHASE_MOVING_BOUNDS_H

#include <cassert>
#include <cstddef>

#include "broadphase/moving_flat.h"
#include "mesh/moving_kdop.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief An axis-aligned box: minus the lower bounds along x, y, z, then the upper ones.
/// Infinity: no bound. No NaN.
struct HalfAxisBox {
  static constexpr int kSides = 6;
  double half[kSides];

  static int opposite(int side) { return (side + 3) % kSides; }
};

/// @brief The box of an object that moves: boxes at equally spaced times from 0 to 1. At
/// any time the object is in the box interpolated between the two neighbours. A plane or
/// halfspace may also be bounded by itself.
struct MovingBounds {
  const HalfAxisBox* boxes;
  /// The number of spans, a power of two; there is one box more.
  int num_spans;
  /// Null: the object has no bounds but the boxes.
  const MovingFlat* flat{nullptr};
};

/// @brief The part of the step in which two objects may be near each other. Empty if lo >
/// hi.
struct MeetingWindow {
  double lo, hi;
  bool isEmpty() const { return lo > hi; }
};

/// @brief From the first to the last time at which the boxes are within a distance along
/// all axes, and the box of one is within this distance of the flat of the other. It is
/// rounded outward.
MeetingWindow meetingWindow(const MovingBounds& a, const MovingBounds& b,
                            double distance);

/// @brief A box that moves linearly during the whole step, as a node of a tree has it.
/// For each axis: minus the lower bound at t = 0 and t = 1, then the upper bound at t = 0
/// and t = 1, rounded outward.
struct alignas(16) LinearBox {
  float axis[3][4];
};

/// @brief The least linear box around moving bounds whose ends are parallel to theirs.
LinearBox linearBox(const MovingBounds& bounds);

/// @brief The sum of the widths at both ends: what a random box meets grows with it.
inline float widthOf(const LinearBox& box) {
  Float4 sum{};
  for (const auto& axis : box.axis) sum += Float4{axis[0], axis[1], axis[2], axis[3]};
  return (sum[0] + sum[1]) + (sum[2] + sum[3]);
}

/// @brief Which pairs of linear boxes a traversal visits.
struct LinearQuery {
  /// Boxes count if they come within this distance along all axes,
  float distance;
  /// before this time.
  float latest;

  LinearQuery(double distance, double latest);
};

/// @brief Whether a linear box may come within the distance of a flat before the latest
/// time of a query.
bool mayMeet(const LinearBox& box, const MovingFlat& flat, const LinearQuery& query);

/// More than the rounding of a quotient of sums of floats, 2^-22 of itself.
constexpr float kFloatWindowLoss = 0x1p-20f;

/// @brief Whether linear depths are all >= 0 at one time in [0, latest], rounded outward.
/// There are two for each axis: their values at t = 0 and t = 1.
/// @pre no depth is negative at both ends
inline bool haveCommonTime(const Float4 (&depth)[3], float latest) {
  for ([[maybe_unused]] const Float4& d : depth)
    assert(!(d[0] < 0 && d[1] < 0) && !(d[2] < 0 && d[3] < 0));
  const Float4 &x = depth[0], &y = depth[1], &z = depth[2];
  const Float4 at_0[2] = {{x[0], x[2], y[0], y[2]}, {z[0], z[2], z[0], z[2]}},
               at_1[2] = {{x[1], x[3], y[1], y[3]}, {z[1], z[3], z[1], z[3]}};
  Float4 enter{}, leave = Float4{} + latest;
  for (int i = 0; i < 2; ++i) {
    const Float4 t = at_0[i] / (at_0[i] - at_1[i]),
                 earliest = at_0[i] < 0 ? t * (1 - kFloatWindowLoss) : enter,
                 last = at_1[i] < 0 ? t * (1 + kFloatWindowLoss) : leave;
    enter = enter > earliest ? enter : earliest;
    leave = leave < last ? leave : last;
  }
  // The latest beginning comes before each end: one lane has it after two maxima.
  const Float4 halves{enter[2], enter[3], enter[0], enter[1]};
  enter = enter > halves ? enter : halves;
  const Float4 others{enter[1], enter[0], enter[3], enter[2]};
  return !isAny((enter > leave) | (others > leave));
}

/// @brief Whether two linear boxes may be near each other. Along each of the six sides
/// the depth s(t) of the overlap is linear; the boxes are near while all are >= 0. The
/// sign of a float sum is exact. (LinearQuery enlarges the distance for the second sum.)
inline bool mayMeet(const LinearBox& a, const LinearBox& b, const LinearQuery& query) {
  Float4 depth[3];
  Mask4 apart{}, at_an_end{};
  for (int k = 0; k < 3; ++k) {
    const float* other = b.axis[k];
    const Float4 one = {a.axis[k][0], a.axis[k][1], a.axis[k][2], a.axis[k][3]},
                 two = {other[2], other[3], other[0], other[1]};
    depth[k] = one + two + query.distance;
    const Mask4 negative = depth[k] < 0,
                other_end = {negative[1], negative[0], negative[3], negative[2]};
    apart |= negative & other_end;
    at_an_end |= negative;
  }
  // Most pairs are apart along one side at all times, or along none at any. Which of the
  // two is unpredictable: so one branch is for both. It is taken if there is a bit of the
  // 4 in at_an_end, and none in apart.
  const int apart_bits = bitsOf(apart);
  if (bitsOf(at_an_end) <= 16 * apart_bits) return apart_bits == 0;
  return haveCommonTime(depth, query.latest);
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
