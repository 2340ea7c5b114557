// SPDX-License-Identifier: BSD-3-Clause
#include "fcl/narrowphase/distance.h"

#include "fcl/common/exception.h"
#include "fcl/narrowphase/detail/deformable/deformable_mesh.h"
#include "stock_fcl.h"

namespace fcl {
namespace {

/// FCL looks a mesh and a shape up under the mesh's type first, whatever their order.
template <typename S>
void requireDistanceFunction(const CollisionGeometry<S>& o1,
                             const CollisionGeometry<S>& o2) {
  const auto isOurs = [](const CollisionGeometry<S>& o) {
    return dynamic_cast<const detail::DeformableMesh*>(&o) != nullptr;
  };
  if (!isOurs(o1) && !isOurs(o2)) return;
  const bool swapped = o1.getObjectType() == OT_GEOM && o2.getObjectType() == OT_BVH;
  const CollisionGeometry<S>&first = swapped ? o2 : o1, &second = swapped ? o1 : o2;
  if (!detail::hasStockDistance(first.getNodeType(), second.getNodeType(), S()))
    throw Exception(
        "distance: FCL has no distance function for the node types of the two objects; "
        "models on AABB, RSS, kIOS or OBBRSS of the same type have one");
}

}  // namespace

#define FCL_CCD_DEFINE_DISTANCE(S)                                                       \
  S distance(const CollisionObject<S>* o1, const CollisionObject<S>* o2,                 \
             const DistanceRequest<S>& request, DistanceResult<S>& result) {             \
    return distance(o1->collisionGeometry().get(), o1->getTransform(),                   \
                    o2->collisionGeometry().get(), o2->getTransform(), request, result); \
  }                                                                                      \
  S distance(const CollisionGeometry<S>* o1, const Transform3<S>& tf1,                   \
             const CollisionGeometry<S>* o2, const Transform3<S>& tf2,                   \
             const DistanceRequest<S>& request, DistanceResult<S>& result) {             \
    requireDistanceFunction(*o1, *o2);                                                   \
    return detail::stockDistance(o1, tf1, o2, tf2, request, result);                     \
  }
FCL_CCD_DEFINE_DISTANCE(double)
FCL_CCD_DEFINE_DISTANCE(float)
#undef FCL_CCD_DEFINE_DISTANCE

}  // namespace fcl
