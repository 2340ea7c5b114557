// SPDX-License-Identifier: BSD-3-Clause
//
// FCL's own continuous query in float, between two transforms. libfcl has none, and
// stock's header does not compile there: FCL's getMotionBase<float>() makes motions that
// are abstract.
#include "api/fcl_in_float.h"

#include <memory>

#include "api/model_instances.h"
#include "api/query_arguments.h"
#include "base/default_floating_point.h"
#include "fcl/common/exception.h"

namespace fcl {

template std::size_t collide<float>(const CollisionGeometry<float>*,
                                    const Transform3<float>&,
                                    const CollisionGeometry<float>*,
                                    const Transform3<float>&,
                                    const CollisionRequest<float>&,
                                    CollisionResult<float>&);
template float continuousCollide<float>(const CollisionGeometry<float>*,
                                        const MotionBase<float>*,
                                        const CollisionGeometry<float>*,
                                        const MotionBase<float>*,
                                        const ContinuousCollisionRequest<float>&,
                                        ContinuousCollisionResult<float>&);

namespace detail {
namespace {

/// FCL's motion, or null if FCL has none in float.
std::shared_ptr<MotionBase<float>> motionOf(const MovingGeometry<float>& o,
                                            CCDMotionType type) {
  const Transform3<float> beg = toTransform(o.pose[0]), end = toTransform(o.pose[1]);
  if (type == CCDM_TRANS) return std::make_shared<TranslationMotion<float>>(beg, end);
  if (type == CCDM_SPLINE) return std::make_shared<SplineMotion<float>>(beg, end);
  return nullptr;
}

[[noreturn]] void refuseMotion(const MovingGeometry<float>& o1,
                               const MovingGeometry<float>& o2) {
  const deformable::DefaultFloatingPoint mode;
  throw Exception(whyFclAnswers(PlacedGeometry<float>(o1), PlacedGeometry<float>(o2)) +
                  ", so FCL answers this pair. FCL has no InterpMotion (CCDM_LINEAR) and "
                  "no ScrewMotion (CCDM_SCREW) in float. Use double, or CCDM_TRANS or a "
                  "SplineMotion");
}

}  // namespace

float askFclInFloat(const MovingGeometry<float>& o1, const MovingGeometry<float>& o2,
                    const ContinuousCollisionRequest<float>& request,
                    FclOutcome& outcome) {
  const auto motion1 = motionOf(o1, request.ccd_motion_type),
             motion2 = motionOf(o2, request.ccd_motion_type);
  if (!motion1 || !motion2) refuseMotion(o1, o2);
  ContinuousCollisionResult<float> result;
  result.is_collide = outcome.is_collide;
  result.time_of_contact = outcome.time_of_contact;
  const float answer = askFcl(o1, motion1.get(), o2, motion2.get(), request, result);
  outcome.is_collide = result.is_collide;
  outcome.time_of_contact = result.time_of_contact;
  if (result.is_collide) {
    outcome.contact_pose[0] = toNumbers(result.contact_tf1);
    outcome.contact_pose[1] = toNumbers(result.contact_tf2);
  }
  return answer;
}

}  // namespace detail
}  // namespace fcl
