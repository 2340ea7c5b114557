// SPDX-License-Identifier: BSD-3-Clause
#include <memory>

#include "fcl/common/exception.h"
#include "fcl/math/bv/utility.h"
#include "fcl/narrowphase/continuous_collision.h"
#include "fcl/narrowphase/distance.h"
#include "stock_fcl.h"

namespace fcl {
namespace detail {

float stockContinuousCollide(const CollisionGeometry<float>* o1,
                             const MotionBase<float>* motion1,
                             const CollisionGeometry<float>* o2,
                             const MotionBase<float>* motion2,
                             const ContinuousCollisionRequest<float>& request,
                             ContinuousCollisionResult<float>& result) {
  return continuousCollide<float>(o1, motion1, o2, motion2, request, result);
}

// FCL's own getMotionBase<float> does not compile: two of its motions are abstract.
MotionBasePtr<float> stockMotion(const Transform3<float>& tf_beg,
                                 const Transform3<float>& tf_end, CCDMotionType type) {
  if (type == CCDM_TRANS)
    return std::make_shared<TranslationMotion<float>>(tf_beg, tf_end);
  if (type == CCDM_SPLINE) return std::make_shared<SplineMotion<float>>(tf_beg, tf_end);
  throw Exception("FCL has no interpolated and no screw motion in float");
}

bool hasStockDistance(NODE_TYPE type1, NODE_TYPE type2, float) {
  static const DistanceFunctionMatrix<GJKSolver_libccd<float>> functions;
  return functions.distance_matrix[type1][type2] != nullptr;
}

float stockDistance(const CollisionGeometry<float>* o1, const Transform3<float>& tf1,
                    const CollisionGeometry<float>* o2, const Transform3<float>& tf2,
                    const DistanceRequest<float>& request,
                    DistanceResult<float>& result) {
  return distance<float>(o1, tf1, o2, tf2, request, result);
}

}  // namespace detail
}  // namespace fcl
