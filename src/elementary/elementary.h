// SPDX-License-Identifier: BSD-3-Clause
//
// The elementary test of one VF or EE pair, in the stages of runStages(). After Tang,
// Manocha, Tong 2010 (sections 3.3, 3.4), with these differences: the filter's signs
// carry a bound on their rounding, it looks only at the part of the step in which the
// pair's boxes meet, and the cubic is not solved by Interval-Newton but by bisection into
// intervals each of which is proved free of contact or proved to hold one.
#ifndef FCL_CCD_ELEMENTARY_ELEMENTARY_H
#define FCL_CCD_ELEMENTARY_ELEMENTARY_H

#include "elementary/feature_points.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief Root solve over the window. Properties:
/// (1) kNo only with a proof that the features do not touch in the window (or only after
///     t_stop);
/// (2) kYes only with a proof that they touch, and the first time in the window lies in
///     [toc_lo, toc_hi], toc_hi - toc_lo <= toc_err;
/// (3) otherwise kUnsure: toc_lo is not later than the first time of contact, if any;
/// (4) the same inputs give the same bits on every machine.
ElementaryResult solveCoplanarity(ContinuousContactKind kind, const FeaturePoints& x,
                                  double window_lo, double window_hi, double toc_err,
                                  double t_stop = 1);

/// @brief A time in the window before which the features certainly do not touch: until
/// then a plane separates them, with the direction between their nearest points at the
/// beginning of the window as its normal. It is window_lo if they touch there. It is
/// sharp up to rounding for points that all meet at one place.
double apartUntil(ContinuousContactKind kind, const FeaturePoints& x, double window_lo,
                  double window_hi);

/// @brief The decision of a pair that the filter leaves: the root solve, then integers if
/// rounding leaves the answer open.
/// @param t_stop, t_max  as for decideExactly()
ElementaryResult decide(ContinuousContactKind kind, const FeaturePoints& x,
                        double window_lo, double window_hi, double toc_err,
                        double t_stop = 1, double t_max = 1);

/// @brief The stages that decide pairs of features, in their order. Each stage decides
/// the pairs for which it has a proof, and leaves the others to the next one.
/// @tparam Pairs  the pairs of one kind in a block (touching_stages.h), or a single pair
/// (elementary.cpp)
template <typename Pairs>
void runStages(Pairs&& pairs) {
  // Boxes: the window in which the moving boxes of the two features overlap. Without a
  // window there is no contact.
  pairs.cullByBoxes();
  // Coplanarity filter: the signs of the coefficients of the coplanarity cubic over the
  // window. If all are the same, there is no root and no contact.
  pairs.filterCoplanarity();
  // Certified solve of eight pairs at a time: pairs with one root at which the inside
  // conditions are clear.
  pairs.solvePlainCases();
  // Certified solve of the others. A window with two roots is divided into two plain
  // cases. What is still open goes through decide(), one pair after the other: bisection
  // in doubles, then in double-double, then integers.
  pairs.solveRest();
}

/// @brief All stages. 0 <= window_lo <= window_hi <= 1; toc_err > 0.
ElementaryResult elementaryTest(ContinuousContactKind kind, const FeaturePoints& x,
                                double window_lo, double window_hi, double toc_err,
                                double t_stop = 1);

inline ElementaryResult elementaryTest(ContinuousContactKind kind,
                                       const VertexPath (&x)[4], double window_lo,
                                       double window_hi, double toc_err,
                                       double t_stop = 1) {
  return elementaryTest(kind, FeaturePoints{{&x[0], &x[1], &x[2], &x[3]}}, window_lo,
                        window_hi, toc_err, t_stop);
}

/// @brief Point and unit normal of a contact at time t. ContinuousContact::normal defines
/// the sign; feature 1 is the vertex or edge a.
void contactGeometry(ContinuousContactKind kind, const FeaturePoints& x, double t,
                     double (&position)[3], double (&normal)[3]);

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
