// SPDX-License-Identifier: BSD-3-Clause
//
// Stands before FCL's header of the same name, includes it, and adds overloads that
// refuse what FCL would answer with a printed warning and the largest number there is.
#ifndef FCL_NARROWPHASE_DISTANCE_OVERLAY_H
#define FCL_NARROWPHASE_DISTANCE_OVERLAY_H

#include "fcl/ccd_version.h"
#include "fcl/narrowphase/detail/stock_distance.h"

namespace fcl {

/// @defgroup deformable_distance Distance
///
/// FCL's distance. When one of the objects is a DeformableBVHModel (its current frame
/// counts) and FCL has no distance function for the pair's types, for example two KDOP
/// models, it throws fcl::Exception instead of answering; other objects reach FCL
/// unchanged. Two AABB, RSS, kIOS or OBBRSS models of the same type have one; RSS, kIOS
/// or OBBRSS with a shape (but a TriangleP); any model with an octree.
/// @{

/// @brief The distance of two objects.
double distance(const CollisionObject<double>* o1, const CollisionObject<double>* o2,
                const DistanceRequest<double>& request, DistanceResult<double>& result);
/// @overload
float distance(const CollisionObject<float>* o1, const CollisionObject<float>* o2,
               const DistanceRequest<float>& request, DistanceResult<float>& result);

/// @brief The distance of two geometries in their poses.
double distance(const CollisionGeometry<double>* o1, const Transform3<double>& tf1,
                const CollisionGeometry<double>* o2, const Transform3<double>& tf2,
                const DistanceRequest<double>& request, DistanceResult<double>& result);
/// @overload
float distance(const CollisionGeometry<float>* o1, const Transform3<float>& tf1,
               const CollisionGeometry<float>* o2, const Transform3<float>& tf2,
               const DistanceRequest<float>& request, DistanceResult<float>& result);

/// @}

}  // namespace fcl

#include "fcl/narrowphase/detail/deformable_distance.h"

#endif
