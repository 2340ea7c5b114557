// SPDX-License-Identifier: BSD-3-Clause
//
// FCL's own functions, for what is not answered here. libfcl has them compiled for double
// only; the float ones are a source file of their own (stock_fcl_float.cpp), compiled
// with little optimisation, since they pull in all of FCL's function tables.
#ifndef FCL_CCD_SRC_STOCK_FCL_H
#define FCL_CCD_SRC_STOCK_FCL_H

#include "fcl/geometry/collision_geometry.h"
#include "fcl/math/motion/motion_base.h"
#include "fcl/narrowphase/collision_object.h"
#include "fcl/narrowphase/continuous_collision_request.h"
#include "fcl/narrowphase/continuous_collision_result.h"
#include "fcl/narrowphase/distance_request.h"
#include "fcl/narrowphase/distance_result.h"

namespace fcl {
namespace detail {

#define FCL_CCD_DECLARE_STOCK(S)                                                         \
  S stockContinuousCollide(const CollisionGeometry<S>* o1, const MotionBase<S>* motion1, \
                           const CollisionGeometry<S>* o2, const MotionBase<S>* motion2, \
                           const ContinuousCollisionRequest<S>& request,                 \
                           ContinuousCollisionResult<S>& result);                        \
  /** @brief The motion that FCL makes of two transforms. */                             \
  MotionBasePtr<S> stockMotion(const Transform3<S>& tf_beg, const Transform3<S>& tf_end, \
                               CCDMotionType type);                                      \
  bool hasStockDistance(NODE_TYPE type1, NODE_TYPE type2, S);                            \
  S stockDistance(const CollisionGeometry<S>* o1, const Transform3<S>& tf1,              \
                  const CollisionGeometry<S>* o2, const Transform3<S>& tf2,              \
                  const DistanceRequest<S>& request, DistanceResult<S>& result);
FCL_CCD_DECLARE_STOCK(double)
FCL_CCD_DECLARE_STOCK(float)
#undef FCL_CCD_DECLARE_STOCK

}  // namespace detail
}  // namespace fcl

#endif
