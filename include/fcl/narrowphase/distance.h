// SPDX-License-Identifier: BSD-3-Clause
//
// This header stands before FCL's header of the same name and includes it. It adds
// overloads that throw where FCL would print a warning and return the largest number.
#ifndef FCL_NARROWPHASE_DISTANCE_OVERLAY_H
#define FCL_NARROWPHASE_DISTANCE_OVERLAY_H

#include <string>

#include "fcl/ccd_version.h"
#include "fcl/common/exception.h"
#include "fcl/narrowphase/detail/query_numbers.h"
#include "fcl/narrowphase/detail/stock_headers.h"

namespace fcl {

/// @defgroup deformable_distance Distance
///
/// FCL's distance of two objects at rest. A DeformableBVHModel is taken in its current
/// frame. FCL has distance functions for these pairs: two models of AABBs, RSSs, kIOSs or
/// OBBRSSs of the same type; a model of RSSs, kIOSs or OBBRSSs and a shape (not a
/// TriangleP); any model and an octree.
///
/// @throws fcl::Exception when one of the objects is a DeformableBVHModel and FCL has no
/// distance function for the pair, for example for two KDOP models. Other objects reach
/// FCL unchanged.
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

namespace detail {

/// @brief Whether FCL 0.7 has a distance function for a mesh of this type and another
/// geometry, in this order or (for a shape) the other.
inline bool hasDistanceFunction(NODE_TYPE mesh, NODE_TYPE other) {
  switch (other) {
    case GEOM_BOX:
    case GEOM_SPHERE:
    case GEOM_ELLIPSOID:
    case GEOM_CAPSULE:
    case GEOM_CONE:
    case GEOM_CYLINDER:
    case GEOM_CONVEX:
    case GEOM_PLANE:
    case GEOM_HALFSPACE:
      return mesh == BV_RSS || mesh == BV_kIOS || mesh == BV_OBBRSS;
    case GEOM_OCTREE:
      return FCL_HAVE_OCTOMAP != 0;
    case BV_AABB:
    case BV_RSS:
    case BV_kIOS:
    case BV_OBBRSS:
      return mesh == other;
    default:
      return false;
  }
}

template <typename S>
void requireDistanceFunction(const CollisionGeometry<S>& o1,
                             const CollisionGeometry<S>& o2) {
  const bool is_first_the_mesh = o1.getObjectType() == OT_BVH,
             is_second_a_mesh = o2.getObjectType() == OT_BVH;
  if (!(is_first_the_mesh && detail::isDeformableModel(o1)) &&
      !(is_second_a_mesh && detail::isDeformableModel(o2)))
    return;
  const NODE_TYPE mesh = (is_first_the_mesh ? o1 : o2).getNodeType(),
                  other = (is_first_the_mesh ? o2 : o1).getNodeType();
  if (!detail::hasDistanceFunction(mesh, other))
    throw Exception(std::string("distance: o1 is ") + detail::kindOf(o1.getNodeType()) +
                    " and o2 is " + detail::kindOf(o2.getNodeType()) +
                    ". FCL has no distance function for these two. Use two models of the "
                    "same BV: AABB, RSS, kIOS or OBBRSS");
}

}  // namespace detail

/// The bodies of the overloads. They are compiled only where they are called, see
/// ContinuousQueryBodies.
template <typename S>
class DistanceBodies {
  friend S distance(const CollisionObject<S>* o1, const CollisionObject<S>* o2,
                    const DistanceRequest<S>& request, DistanceResult<S>& result) {
    detail::requireDistanceFunction(*o1->collisionGeometry(), *o2->collisionGeometry());
    return fcl::distance<S>(o1, o2, request, result);
  }
  friend S distance(const CollisionGeometry<S>* o1, const Transform3<S>& tf1,
                    const CollisionGeometry<S>* o2, const Transform3<S>& tf2,
                    const DistanceRequest<S>& request, DistanceResult<S>& result) {
    detail::requireDistanceFunction(*o1, *o2);
    return fcl::distance<S>(o1, tf1, o2, tf2, request, result);
  }
};

// Instantiates the classes, which declares the friends.
static_assert(sizeof(DistanceBodies<double>) == 1, "");
static_assert(sizeof(DistanceBodies<float>) == 1, "");

}  // namespace fcl

#elif !defined(FCL_DISTANCE_H)
// Two folders on the include path have this header: pass on to the next one.
#include_next <fcl/narrowphase/distance.h>
#endif
