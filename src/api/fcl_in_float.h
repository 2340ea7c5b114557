// SPDX-License-Identifier: BSD-3-Clause
//
// FCL's function tables in float, which libfcl has in double alone, take a compiler more
// than a minute. They are reached through these two and compiled once, in
// fcl_in_float.cpp.
#ifndef FCL_CCD_API_FCL_IN_FLOAT_H
#define FCL_CCD_API_FCL_IN_FLOAT_H

#include <cstddef>

#include "fcl/narrowphase/continuous_collision.h"

namespace fcl {

extern template std::size_t collide<float>(const CollisionGeometry<float>*,
                                           const Transform3<float>&,
                                           const CollisionGeometry<float>*,
                                           const Transform3<float>&,
                                           const CollisionRequest<float>&,
                                           CollisionResult<float>&);
extern template float continuousCollide<float>(const CollisionGeometry<float>*,
                                               const MotionBase<float>*,
                                               const CollisionGeometry<float>*,
                                               const MotionBase<float>*,
                                               const ContinuousCollisionRequest<float>&,
                                               ContinuousCollisionResult<float>&);

}  // namespace fcl

#endif
