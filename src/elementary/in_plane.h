// SPDX-License-Identifier: BSD-3-Clause
//
// The elementary test of a pair that stays in a plane of constant x, y or z (flat sheets
// that slide over each other). Every volume is zero. Features that are apart at t = 0
// meet first at a point where a vertex of one meets an edge of the other.
#ifndef FCL_CCD_ELEMENTARY_IN_PLANE_H
#define FCL_CCD_ELEMENTARY_IN_PLANE_H

#include "elementary/feature_points.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief The axis along which all four points have the same coordinate, in each frame;
/// -1 if there is none. The plane itself may move.
int axisOfCommonPlane(const FeaturePoints& x);

/// @brief solveCoplanarity() for a pair that is in a plane perpendicular to `axis` and
/// does not touch at t = 0. It has the same properties.
ElementaryResult solveInPlane(ContinuousContactKind kind, const FeaturePoints& x,
                              int axis, double window_lo, double window_hi,
                              double toc_err);

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
