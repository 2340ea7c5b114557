// SPDX-License-Identifier: BSD-3-Clause
//
// The elementary test of one VF or EE pair: axis test -> coplanarity filter -> certified
// root solve -> integers for what rounding leaves open. After Tang, Manocha, Tong 2010
// (sections 3.3, 3.4), with these differences: the filter's signs carry a bound on their
// rounding, it looks only at the part of the step in which the pair's boxes meet, and the
// cubic is not solved by Interval-Newton but by bisection into intervals each of which is
// proved free of contact or proved to hold one.
#ifndef FCL_NARROWPHASE_DETAIL_DEFORMABLE_ELEMENTARY_TEST_H
#define FCL_NARROWPHASE_DETAIL_DEFORMABLE_ELEMENTARY_TEST_H

#include <cfloat>
#include <cmath>

#include "fcl/narrowphase/detail/deformable/vertex_frames.h"

namespace fcl {
namespace detail {
namespace deformable {

enum class FeatureKind { kVertexFace, kEdgeEdge };

/// @brief The four moving points of a pair: v, f0, f1, f2 or ea0, ea1, eb0, eb1.
struct FeaturePoints {
  const VertexPath* point[4];
  const VertexPath& operator[](int i) const { return *point[i]; }
};

enum class Answer { kNo, kYes, kUnsure };

/// @brief The stage that gave the answer.
enum class DecidedBy { kBox, kFilter, kSolver, kExact };

struct ElementaryResult {
  Answer answer;
  /// Bracket of the first time of contact; for kUnsure, of that time if there is one.
  /// Without meaning for kNo.
  double toc_lo;
  double toc_hi;
  DecidedBy decided_by;
};

/// The same quantity at t = 0 and at t = 1; compilers use vector instructions for it.
typedef double FramePair __attribute__((vector_size(16)));

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

/// Windows are widened by this much, far more than their rounding (3 * 2^-53): a contact
/// at the very start of a window would leave the solver no room to see the sign before
/// it.
constexpr double kWindowMargin = 0x1p-18;

/// @brief Narrows [lo, hi] to the times at which two features' ranges, interpolated
/// between the frames, overlap along x, y and z (they contain the features, whose paths
/// are straight). Never cuts a time of contact: a difference of doubles has the right
/// sign.
/// @return false if nothing is left: the features never touch in [lo, hi].
inline bool narrowWindow(const AxisRanges& a, const AxisRanges& b, double& lo,
                         double& hi) {
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
    if (!(std::abs(change) <= DBL_MAX)) continue;  // the quotient would mean nothing
    if (s[0] < 0) {
      const double enter = s[0] / change - kWindowMargin;
      if (enter > lo) lo = enter;
    } else if (s[1] < 0) {
      const double leave = s[0] / change + kWindowMargin;
      if (leave < hi) hi = leave;
    }
  }
  return lo <= hi;
}

/// @brief narrowWindow() for a pair given by its points.
bool narrowWindow(FeatureKind kind, const FeaturePoints& x, double& lo, double& hi);

/// @brief Whether four points become coplanar, as far as doubles can tell.
enum class Coplanarity {
  kNever,
  kPossible,
  kUnclear  ///< the signs say never, but may be mere rounding
};

/// @brief The coplanarity filter over [window_lo, window_hi] in doubles. kNever proves
/// that the four points are never coplanar in the window, so that the features never
/// touch in it. (1) Never kNever for a pair that touches. (2) NaN, infinity and products
/// that could underflow or overflow give kPossible.
Coplanarity coplanarityInDoubles(FeatureKind kind, const FeaturePoints& x,
                                 double window_lo, double window_hi);

/// @brief The same question in twice the digits, for pairs that are kUnclear: false is a
/// proof as kNever is.
bool mayBecomeCoplanarAccurately(FeatureKind kind, const FeaturePoints& x,
                                 double window_lo, double window_hi);

/// @brief The whole filter: in doubles, and again where they leave it unclear.
bool mayBecomeCoplanar(FeatureKind kind, const FeaturePoints& x, double window_lo,
                       double window_hi);

/// @brief Root solve over the window. Properties:
/// (1) kNo only with a proof that the features do not touch in the window (or only after
///     t_stop);
/// (2) kYes only with a proof that they touch, and the first time in the window lies in
///     [toc_lo, toc_hi], toc_hi - toc_lo <= toc_err;
/// (3) otherwise kUnsure: toc_lo is not later than the first time of contact, if any;
/// (4) the same inputs give the same bits on every machine.
ElementaryResult solveCoplanarity(FeatureKind kind, const FeaturePoints& x,
                                  double window_lo, double window_hi, double toc_err,
                                  double t_stop = 1);

/// @brief The definition over the whole step, with integers: right for all finite inputs.
/// kYes or kNo; the first time of contact lies in [toc_lo, toc_hi], toc_hi - toc_lo <=
/// toc_err or a few units in the last place, equal when the time is found exactly.
ElementaryResult decideExactly(FeatureKind kind, const FeaturePoints& x, double toc_err);

/// @brief All stages. 0 <= window_lo <= window_hi <= 1; toc_err > 0.
ElementaryResult elementaryTest(FeatureKind kind, const FeaturePoints& x,
                                double window_lo, double window_hi, double toc_err,
                                double t_stop = 1);

inline ElementaryResult elementaryTest(FeatureKind kind, const VertexPath (&x)[4],
                                       double window_lo, double window_hi, double toc_err,
                                       double t_stop = 1) {
  return elementaryTest(kind, FeaturePoints{{&x[0], &x[1], &x[2], &x[3]}}, window_lo,
                        window_hi, toc_err, t_stop);
}

/// @brief Point and unit normal of a contact at time t (see ContinuousContact::normal for
/// the sign, with feature 1 the vertex or edge a).
void contactGeometry(FeatureKind kind, const FeaturePoints& x, double t,
                     double (&position)[3], double (&normal)[3]);

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
