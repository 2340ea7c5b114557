// SPDX-License-Identifier: BSD-3-Clause
#include "fcl/narrowphase/continuous_collision.h"
#include "fcl/narrowphase/distance.h"
#include "stock_fcl.h"

namespace fcl {
namespace detail {

double stockContinuousCollide(const CollisionGeometry<double>* o1,
                              const MotionBase<double>* motion1,
                              const CollisionGeometry<double>* o2,
                              const MotionBase<double>* motion2,
                              const ContinuousCollisionRequest<double>& request,
                              ContinuousCollisionResult<double>& result) {
  return continuousCollide<double>(o1, motion1, o2, motion2, request, result);
}

MotionBasePtr<double> stockMotion(const Transform3<double>& tf_beg,
                                  const Transform3<double>& tf_end, CCDMotionType type) {
  return getMotionBase<double>(tf_beg, tf_end, type);
}

bool hasStockDistance(NODE_TYPE type1, NODE_TYPE type2, double) {
  static const DistanceFunctionMatrix<GJKSolver_libccd<double>> functions;
  return functions.distance_matrix[type1][type2] != nullptr;
}

double stockDistance(const CollisionGeometry<double>* o1, const Transform3<double>& tf1,
                     const CollisionGeometry<double>* o2, const Transform3<double>& tf2,
                     const DistanceRequest<double>& request,
                     DistanceResult<double>& result) {
  return distance<double>(o1, tf1, o2, tf2, request, result);
}

}  // namespace detail
}  // namespace fcl
