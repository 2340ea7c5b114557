// SPDX-License-Identifier: BSD-3-Clause
#include "fcl_in_float.h"

#include <stdexcept>

#include "fcl/narrowphase/detail/collision_func_matrix.h"
#include "model/model_instances.h"

namespace fcl {
namespace {

using Function = std::size_t (*)(const CollisionGeometry<float>*,
                                 const Transform3<float>&,
                                 const CollisionGeometry<float>*,
                                 const Transform3<float>&, const CollisionRequest<float>&,
                                 CollisionResult<float>&);

/// The entry of FCL's table for two models on a bounding volume.
Function functionOf(NODE_TYPE volume) {
  switch (volume) {
    case BV_AABB:
      return &detail::BVHCollide<AABB<float>>;
    case BV_OBB:
      return &detail::BVHCollide<OBB<float>>;
    case BV_RSS:
      return &detail::BVHCollide<RSS<float>>;
    case BV_kIOS:
      return &detail::BVHCollide<kIOS<float>>;
    case BV_OBBRSS:
      return &detail::BVHCollide<OBBRSS<float>>;
    case BV_KDOP16:
      return &detail::BVHCollide<KDOP<float, 16>>;
    case BV_KDOP18:
      return &detail::BVHCollide<KDOP<float, 18>>;
    case BV_KDOP24:
      return &detail::BVHCollide<KDOP<float, 24>>;
    default:
      throw std::logic_error("collide<float>() of tests takes models only");
  }
}

}  // namespace

template <>
std::size_t collide<float>(const CollisionGeometry<float>* o1,
                           const Transform3<float>& tf1,
                           const CollisionGeometry<float>* o2,
                           const Transform3<float>& tf2,
                           const CollisionRequest<float>& request,
                           CollisionResult<float>& result) {
  const NODE_TYPE volume = o1->getNodeType();
  if (o2->getNodeType() != volume)
    throw std::logic_error("collide<float>() of tests takes models on one volume");
  return functionOf(volume)(o1, tf1, o2, tf2, request, result);
}

template <>
float continuousCollide<float>(const CollisionGeometry<float>* o1,
                               const MotionBase<float>* motion1,
                               const CollisionGeometry<float>* o2,
                               const MotionBase<float>* motion2,
                               const ContinuousCollisionRequest<float>& request,
                               ContinuousCollisionResult<float>& result) {
  if (request.ccd_solver_type != CCDC_NAIVE)
    throw std::logic_error("continuousCollide<float>() of tests is FCL's naive one");
  return continuousCollideNaive(o1, motion1, o2, motion2, request, result);
}

}  // namespace fcl
