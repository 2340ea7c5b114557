// SPDX-License-Identifier: BSD-3-Clause
#include "queries_along_motions.h"

namespace fcl {
namespace test {

double collideAlong(const CollisionGeometry<double>* o1,
                    const MotionBase<double>* motion1,
                    const CollisionGeometry<double>* o2,
                    const MotionBase<double>* motion2,
                    const ContinuousCollisionRequest<double>& request,
                    ContinuousCollisionResult<double>& result) {
  return continuousCollide(o1, motion1, o2, motion2, request, result);
}

float collideAlong(const CollisionGeometry<float>* o1, const MotionBase<float>* motion1,
                   const CollisionGeometry<float>* o2, const MotionBase<float>* motion2,
                   const ContinuousCollisionRequest<float>& request,
                   ContinuousCollisionResult<float>& result) {
  return continuousCollide(o1, motion1, o2, motion2, request, result);
}

double collideAlong(const ContinuousCollisionObject<double>* o1,
                    const ContinuousCollisionObject<double>* o2,
                    const ContinuousCollisionRequest<double>& request,
                    ContinuousCollisionResult<double>& result) {
  return collide(o1, o2, request, result);
}

float collideAlong(const ContinuousCollisionObject<float>* o1,
                   const ContinuousCollisionObject<float>* o2,
                   const ContinuousCollisionRequest<float>& request,
                   ContinuousCollisionResult<float>& result) {
  return collide(o1, o2, request, result);
}

}  // namespace test
}  // namespace fcl
