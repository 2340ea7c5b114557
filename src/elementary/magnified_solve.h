// SPDX-License-Identifier: BSD-3-Clause
//
// The step before integers alone, for four points that nearly meet: to doubles that are
// restricted to a part of the step their differences are mere rounding. Here the places
// of the points at both ends of a part are integers, and only their differences are
// rounded: however short the part and however close the points, these differences have
// all digits of a double, and so the pair looks like any other one.
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
/// (3) otherwise kUnsure, soon: a graze, features that stay coplanar, or coordinates with
///     more digits than fit.
/// The weights of a contact that are zero at a root are decided with integers, by query.
ElementaryResult solveMagnified(ExactQuery& query, double toc_err, double t_stop,
                                double t_max);

/// @brief Whether solveMagnified() may find out what solveCoplanarity() did not: at some
/// time of the step the pair is much smaller than at another, or it is out of the range
/// in which doubles have bounds. Of other pairs integers alone find out sooner.
bool isWorthMagnifying(ContinuousContactKind kind, const FeaturePoints& x);

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
