// SPDX-License-Identifier: BSD-3-Clause
//
// FCL's queries in float. libfcl has them in double alone, and FCL's functions of all
// pairs of geometries take a compiler a minute. These two ask FCL's functions of two
// models on the same bounding volume; test/consumer/every_overload.cpp compiles all.
#ifndef FCL_TEST_SUPPORT_FCL_IN_FLOAT_H
#define FCL_TEST_SUPPORT_FCL_IN_FLOAT_H

#include <cstddef>

#include "fcl/narrowphase/continuous_collision.h"

namespace fcl {

template <>
std::size_t collide<float>(const CollisionGeometry<float>* o1,
                           const Transform3<float>& tf1,
                           const CollisionGeometry<float>* o2,
                           const Transform3<float>& tf2,
                           const CollisionRequest<float>& request,
                           CollisionResult<float>& result);

/// With FCL's naive solver, which calls the one above.
template <>
float continuousCollide<float>(const CollisionGeometry<float>* o1,
                               const MotionBase<float>* motion1,
                               const CollisionGeometry<float>* o2,
                               const MotionBase<float>* motion2,
                               const ContinuousCollisionRequest<float>& request,
                               ContinuousCollisionResult<float>& result);

}  // namespace fcl

#endif
