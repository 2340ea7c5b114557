// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_BROADPHASE_MOVING_BOUNDS_H
#define FCL_CCD_BROADPHASE_MOVING_BOUNDS_H

#include <cstddef>

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
/// any time the object is in the box interpolated between the two neighbours.
struct MovingBounds {
  const HalfAxisBox* boxes;
  /// The number of spans, a power of two; there is one box more.
  int num_spans;
};

/// @brief The part of the step in which two objects may be near each other. Empty if lo >
/// hi.
struct MeetingWindow {
  double lo, hi;
  bool isEmpty() const { return lo > hi; }
};

/// @brief From the first to the last time at which the boxes are within a distance along
/// all axes. It is rounded outward.
MeetingWindow meetingWindow(const MovingBounds& a, const MovingBounds& b,
                            double distance);

/// @brief A box that moves linearly during the whole step, as a node of a tree has it:
/// HalfAxisBox at t = 0 and t = 1, in floats that are rounded outward.
struct LinearBox {
  float t0[HalfAxisBox::kSides];
  float t1[HalfAxisBox::kSides];
};

/// @brief The least linear box around moving bounds whose ends are parallel to theirs.
LinearBox linearBox(const MovingBounds& bounds);

/// @brief The sum of the widths at both ends: what a random box meets grows with it.
inline float widthOf(const LinearBox& box) {
  float sum = 0;
  for (int j = 0; j < HalfAxisBox::kSides; ++j) sum += box.t0[j] + box.t1[j];
  return sum;
}

/// @brief Which pairs of linear boxes a traversal visits.
struct LinearQuery {
  /// Boxes count when they are within this distance along all axes.
  float distance;
  /// And before this time.
  float latest;

  LinearQuery(double distance, double latest);
};

/// More than the rounding of a quotient of sums of floats, 2^-22 of itself.
constexpr float kFloatWindowLoss = 0x1p-20f;

/// @brief Whether two linear boxes may be near each other. Along a side the depth s(t) of
/// the overlap is linear; the boxes are near while all six are >= 0. The sign of a float
/// sum is exact. (LinearQuery enlarges the distance for the second sum.)
inline bool mayMeet(const LinearBox& a, const LinearBox& b, const LinearQuery& query) {
  constexpr int kSides = HalfAxisBox::kSides;
  float s0[kSides], s1[kSides], highest = 0, lowest = 0;
  // Most pairs are apart along one side at all times, or along none.
  for (int j = 0; j < kSides; ++j) {
    const int k = HalfAxisBox::opposite(j);
    s0[j] = a.t0[j] + b.t0[k] + query.distance;
    s1[j] = a.t1[j] + b.t1[k] + query.distance;
    const float more = s0[j] > s1[j] ? s0[j] : s1[j],
                less = s0[j] > s1[j] ? s1[j] : s0[j];
    highest = highest < more ? highest : more;
    lowest = lowest < less ? lowest : less;
  }
  if (highest < 0) return false;
  if (lowest >= 0) return true;
  float enter = 0, leave = query.latest;
  for (int j = 0; j < kSides; ++j) {
    if (s0[j] >= 0 && s1[j] >= 0) continue;
    const float t = s0[j] / (s0[j] - s1[j]);
    if (s0[j] < 0)
      enter = enter > t * (1 - kFloatWindowLoss) ? enter : t * (1 - kFloatWindowLoss);
    else
      leave = leave < t * (1 + kFloatWindowLoss) ? leave : t * (1 + kFloatWindowLoss);
  }
  return enter <= leave;
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
