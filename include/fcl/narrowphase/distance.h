// SPDX-License-Identifier: BSD-3-Clause
//
// Stands before FCL's header of the same name, includes it, and adds overloads that
// refuse what FCL would answer with a printed warning and the largest number there is.
#ifndef FCL_NARROWPHASE_DISTANCE_OVERLAY_H
#define FCL_NARROWPHASE_DISTANCE_OVERLAY_H

#include "fcl/narrowphase/detail/stock_distance.h"

namespace fcl {

/// @brief FCL's distance. When one of the objects is a DeformableBVHModel (its current
/// frame counts) and FCL has no distance function for the pair's types, for example two
/// KDOP models, it throws fcl::Exception instead of answering; other objects reach FCL
/// unchanged. Two AABB, RSS, kIOS or OBBRSS models of the same type have one, and RSS,
/// kIOS or OBBRSS with a shape.
/// @{
#define FCL_CCD_DECLARE_DISTANCE(S)                                                    \
  FCL_EXPORT S distance(const CollisionObject<S>* o1, const CollisionObject<S>* o2,    \
                        const DistanceRequest<S>& request, DistanceResult<S>& result); \
  FCL_EXPORT S distance(const CollisionGeometry<S>* o1, const Transform3<S>& tf1,      \
                        const CollisionGeometry<S>* o2, const Transform3<S>& tf2,      \
                        const DistanceRequest<S>& request, DistanceResult<S>& result);
FCL_CCD_DECLARE_DISTANCE(double)
FCL_CCD_DECLARE_DISTANCE(float)
#undef FCL_CCD_DECLARE_DISTANCE
/// @}

}  // namespace fcl

#endif
