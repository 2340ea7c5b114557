// SPDX-License-Identifier: BSD-3-Clause
//
// The stage before roots of polynomials, for four points that nearly meet. In doubles
// that are restricted to a part of the step, their differences are rounding only. Here
// the positions of the points at both ends of a part are integers, and only their
// differences are rounded. However short the part and however close the points, these
// differences have all digits of a double, so that the pair can be solved like any other
// one.
#ifndef FCL_CCD_ELEMENTARY_MAGNIFIED_SOLVE_H
#define FCL_CCD_ELEMENTARY_MAGNIFIED_SOLVE_H

#include "elementary/exact_pair.h"
#include "elementary/feature_points.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief Root solve in [0, t_max] for a pair that does not touch at t = 0. Properties:
/// (1) kNo only with a proof that the features do not touch in [0, t_max] (or only after
///     t_stop);
/// (2) kYes only with a proof that they touch, and the first time lies in [toc_lo,
///     toc_hi], toc_hi - toc_lo <= toc_err or a few units in the last place;
/// (3) otherwise kUnsure, after a short time: for a graze, for features that stay
///     coplanar, or for coordinates with more digits than fit.
ElementaryResult solveMagnified(ExactQuery& query, double toc_err, double t_stop,
                                double t_max);

/// @brief Whether solveMagnified() may decide a pair that solveCoplanarity() did not.
/// This is so if the pair is much smaller at one time of the step than at another, or if
/// it is out of the range in which doubles have bounds. Other pairs are decided sooner by
/// roots of polynomials.
bool isWorthMagnifying(ContinuousContactKind kind, const FeaturePoints& x);

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
