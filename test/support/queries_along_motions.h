// SPDX-License-Identifier: BSD-3-Clause
//
// The queries that bring stock FCL's float templates into a program, which takes a
// compiler a minute: a file of their own has them compiled once, with little
// optimisation.
#ifndef FCL_TEST_SUPPORT_QUERIES_ALONG_MOTIONS_H
#define FCL_TEST_SUPPORT_QUERIES_ALONG_MOTIONS_H

#include "fcl/narrowphase/continuous_collision.h"

namespace fcl {
namespace test {

/// @brief continuousCollide() of geometries that follow motions.
double collideAlong(const CollisionGeometry<double>* o1,
                    const MotionBase<double>* motion1,
                    const CollisionGeometry<double>* o2,
                    const MotionBase<double>* motion2,
                    const ContinuousCollisionRequest<double>& request,
                    ContinuousCollisionResult<double>& result);
float collideAlong(const CollisionGeometry<float>* o1, const MotionBase<float>* motion1,
                   const CollisionGeometry<float>* o2, const MotionBase<float>* motion2,
                   const ContinuousCollisionRequest<float>& request,
                   ContinuousCollisionResult<float>& result);

/// @brief collide() of objects that follow motions.
double collideAlong(const ContinuousCollisionObject<double>* o1,
                    const ContinuousCollisionObject<double>* o2,
                    const ContinuousCollisionRequest<double>& request,
                    ContinuousCollisionResult<double>& result);
float collideAlong(const ContinuousCollisionObject<float>* o1,
                   const ContinuousCollisionObject<float>* o2,
                   const ContinuousCollisionRequest<float>& request,
                   ContinuousCollisionResult<float>& result);

}  // namespace test
}  // namespace fcl

#endif
