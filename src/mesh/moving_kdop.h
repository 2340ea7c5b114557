// SPDX-License-Identifier: BSD-3-Clause
//
// A moving 16-DOP (8 directions, as FCL's KDOP<S, 16>): one box at t = 0 and one at t
// = 1. If vertices move on straight paths, the box interpolated between the two contains
// the subtree at every t. Tang, Manocha, Tong 2010 use one box around the whole sweep
// instead.
#ifndef FCL_CCD_MESH_MOVING_KDOP_H
#define FCL_CCD_MESH_MOVING_KDOP_H

#if __cplusplus < 201703L
#error "The moving trees of fcl_ccd need C++17: compile with -std=c++17 or later"
#endif

#include <algorithm>
#include <cassert>
#include <cfloat>
#include <cmath>
#include <limits>

#include "base/short_vector.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief Half-axis bounds: entries 0-7 are minus the lower, 8-15 the upper bound along
/// x, y, z, x+y, x+z, y+z, x-y, x-z; relative to an origin that its owner knows; rounded
/// outward, so never below kLeastHalf; infinity where a float has no bound. No NaN.
struct alignas(64) Kdop16 {
  float half[16];
};

/// @brief Whether each direction has its upper bound above its lower one, or at it. False
/// for a NaN.
inline bool isOrdered(const Kdop16& box) {
  for (int j = 0; j < 8; ++j)
    if (!(box.half[j] + box.half[j + 8] >= 0)) return false;
  return true;
}

/// @brief The box at t = 0 and the box at t = 1.
struct MovingKdop {
  Kdop16 t0;
  Kdop16 t1;
};

/// @brief The part of the step, 0 <= lo <= hi <= 1, in which two things may touch. Empty
/// if lo > hi.
struct TimeWindow {
  float lo;
  float hi;
  bool isEmpty() const { return lo > hi; }
};

/// @brief The 8 directions applied to a point, or to points in the lanes of vectors.
template <typename T>
inline void kdopCoordinates(const T (&p)[3], T (&d)[8]) {
  d[0] = p[0];
  d[1] = p[1];
  d[2] = p[2];
  d[3] = p[0] + p[1];
  d[4] = p[0] + p[2];
  d[5] = p[1] + p[2];
  d[6] = p[0] - p[1];
  d[7] = p[0] - p[2];
}

/// @brief Whether a box contains a point, given relative to its origin. Coordinates that
/// are no numbers do not count.
inline bool containsPoint(const Kdop16& box, const double (&p)[3]) {
  double d[8];
  kdopCoordinates(p, d);
  for (int j = 0; j < 8; ++j)
    if (-d[j] > double{box.half[j]} || d[j] > double{box.half[j + 8]}) return false;
  return true;
}

/// Relative outward step for a float made from a double: the conversion loses 2^-24
/// relative, the two operations of roundUp() 2^-24 each; 2^-22 covers them.
constexpr float kOutward = 0x1p-22f;

/// @brief No half-axis bound is below this, so that the sum of two is finite or plus
/// infinity.
constexpr float kLeastHalf = -0.5f * FLT_MAX;

/// @brief Whether all half-axes are such that sums of two are no NaNs.
inline bool isValid(const Kdop16& box) {
  return std::all_of(box.half, box.half + 16, [](float x) { return x >= kLeastHalf; });
}

/// @brief A float that is not less than value + pad, except for 2^-22 of the pad; pad >=
/// 0. FLT_MIN keeps it right where a float would be subnormal. Infinity for a NaN; never
/// below kLeastHalf.
inline float roundUp(double value, float pad) {
  assert(pad >= 0);
  const auto f =
      static_cast<float>(value < double{kLeastHalf} ? double{kLeastHalf} : value);
  const float up = f + (std::fabs(f) * kOutward + (pad + FLT_MIN));
  assert(!(up < value + pad * (1 - double{kOutward})));
  return up == up ? up : std::numeric_limits<float>::infinity();
}

/// @brief The pad of roundUp() for a coordinate that was rounded before, of a point at
/// most 1 away from the origin along an axis. The difference to the origin rounds by
/// 2^-53 of itself, the pose in relativeShift() by the same, and a sum of two by 2^-52 of
/// the larger: 6 * 2^-53 in all.
constexpr double kOffsetPad = 0x1p-49;

/// @brief A half-axis of a box that is moved, not less than the exact sum. The float sum
/// loses at most 2^-24 of itself if it is a normal number, and nothing if it is
/// subnormal.
inline float shifted(float half, float shift) {
  const float sum = half + shift;
  const float moved = std::max(sum + std::fabs(sum) * kOutward, kLeastHalf);
  assert(!(moved < double{half} + double{shift}));
  return moved;
}

/// @brief The shift that is added to the sum of two boxes whose origins differ.
struct KdopShift {
  Kdop16 t0;
  Kdop16 t1;
};

/// The part of the step that a window loses is multiplied by this. So it is rounded down
/// by more than its rounding: 2^-24 for each of the two sums, their difference, the
/// quotient and this product.
constexpr float kLossDown = 1.f - 0x1p-21f;
/// A window ends at this number minus the part that is lost at the end. It is 1 plus more
/// than the rounding of the subtraction.
constexpr float kWindowEnd = 1.f + 0x1p-22f;

/// @brief When boxes a and b, which move linearly, overlap in all 8 directions. Never
/// misses a time of overlap: the window is rounded outward.
///
/// Along half-axis j, a's bound plus b's opposite bound (halves swapped) is the overlap
/// depth s(t), linear in t; the boxes overlap while all 16 are >= 0. Where s0 = s(0) and
/// s1 = s(1) have opposite signs, the part least / (least - most) of the step is lost, at
/// the beginning (s0 < 0) or the end. It is 0 where `most` or the difference is infinite:
/// what overflows never separates.
template <bool kShifted>
inline TimeWindow overlapWindow(const MovingKdop& a, const MovingKdop& b,
                                const KdopShift* shift) {
  float before = 0.f, after = 0.f;
  for (int j = 0; j < 16; ++j) {
    float a0 = a.t0.half[j], a1 = a.t1.half[j];
    if (kShifted) {
      a0 = shifted(a0, shift->t0.half[j]);
      a1 = shifted(a1, shift->t1.half[j]);
    }
    const float s0 = a0 + b.t0.half[j ^ 8], s1 = a1 + b.t1.half[j ^ 8];
    assert(s0 == s0 && s1 == s1);  // no NaN: no half-axis is below kLeastHalf
    if (s0 < 0 && s1 < 0) return {1.f, 0.f};
    if (s0 >= 0 && s1 >= 0) continue;
    const float least = std::min(s0, s1), most = std::max(s0, s1);
    const float loss = least / (least - most) * kLossDown;
    (s0 < 0 ? before : after) = std::max(s0 < 0 ? before : after, loss);
  }
  const float hi = kWindowEnd - after;
  // A time of overlap is neither before the beginning nor after the end of the step.
  assert(0.f <= before && before <= 1.f && 0.f <= hi);
  return {before, std::min(hi, 1.f)};
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
