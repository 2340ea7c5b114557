// SPDX-License-Identifier: BSD-3-Clause
//
// The first stage of the elementary test.
#ifndef FCL_CCD_ELEMENTARY_AXIS_WINDOW_H
#define FCL_CCD_ELEMENTARY_AXIS_WINDOW_H

#include <cassert>
#include <cfloat>
#include <cmath>

#include "elementary/feature_points.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief Coordinate ranges of a feature along x, y, z in both frames.
struct AxisRanges {
  FramePair lo[3];
  FramePair hi[3];

  AxisRanges() = default;
  explicit AxisRanges(const VertexPath& p) {
    for (int k = 0; k < 3; ++k) lo[k] = hi[k] = FramePair{p.t0[k], p.t1[k]};
  }
  AxisRanges(const AxisRanges& p, const AxisRanges& q) {
    for (int k = 0; k < 3; ++k) {
      lo[k] = p.lo[k] < q.lo[k] ? p.lo[k] : q.lo[k];
      hi[k] = p.hi[k] > q.hi[k] ? p.hi[k] : q.hi[k];
    }
  }
};

/// Windows are widened by this much, which is far more than their rounding (3 * 2^-53).
/// Without it a contact at the very start of a window would leave the solver no room to
/// see the sign before the contact.
constexpr double kWindowMargin = 0x1p-18;

/// @brief Narrows [lo, hi] to the times at which the ranges of two features overlap along
/// x, y and z. The ranges are interpolated between the frames; they contain the features,
/// since paths are straight. Never cuts off a time of contact: a difference of doubles
/// has the right sign.
/// @return false if nothing is left: the features never touch in [lo, hi].
inline bool narrowWindow(const AxisRanges& a, const AxisRanges& b, double& lo,
                         double& hi) {
  assert(0 <= lo && lo <= hi && hi <= 1);
  FramePair depth[6];
  bool apart = false, cut = false;
  for (int k = 0; k < 3; ++k) {
    depth[k] = a.hi[k] - b.lo[k];
    depth[k + 3] = b.hi[k] - a.lo[k];
  }
  for (const FramePair& s : depth) {
    apart |= (s[0] < 0) & (s[1] < 0);
    cut |= (s[0] < 0) | (s[1] < 0);
  }
  if (apart) return false;
  if (!cut) return true;
  for (const FramePair& s : depth) {
    const double change = s[0] - s[1];
    if (!(std::abs(change) <= DBL_MAX)) continue;  // overflow: no quotient
    if (s[0] < 0) {
      const double enter = s[0] / change - kWindowMargin;
      assert(-kWindowMargin <= enter && enter <= 1);
      if (enter > lo) lo = enter;
    } else if (s[1] < 0) {
      const double leave = s[0] / change + kWindowMargin;
      assert(0 < leave && leave <= 1 + kWindowMargin);
      if (leave < hi) hi = leave;
    }
  }
  return lo <= hi;
}

/// @brief narrowWindow() for a pair given by its points.
inline bool narrowWindow(ContinuousContactKind kind, const FeaturePoints& x, double& lo,
                         double& hi) {
  const AxisRanges p0{x[0]}, p1{x[1]}, p2{x[2]}, p3{x[3]}, p23{p2, p3};
  return kind == ContinuousContactKind::kVertexFace
             ? narrowWindow(p0, AxisRanges(p1, p23), lo, hi)
             : narrowWindow(AxisRanges(p0, p1), p23, lo, hi);
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
