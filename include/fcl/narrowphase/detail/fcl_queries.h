// SPDX-License-Identifier: BSD-3-Clause
//
// Calls of FCL's own continuous queries, for pairs that this library does not answer. As
// with stock FCL, they are compiled with the program.
#ifndef FCL_NARROWPHASE_DETAIL_FCL_QUERIES_H
#define FCL_NARROWPHASE_DETAIL_FCL_QUERIES_H

#include <memory>
#include <type_traits>

#include "fcl/common/exception.h"
#include "fcl/math/motion/interp_motion.h"
#include "fcl/math/motion/screw_motion.h"
#include "fcl/math/motion/spline_motion.h"
#include "fcl/math/motion/translation_motion.h"
#include "fcl/narrowphase/continuous_contact.h"
#include "fcl/narrowphase/detail/query_numbers.h"
#include "fcl/narrowphase/detail/stock_continuous_collision.h"

namespace fcl {
namespace detail {

/// @brief The motion that FCL makes of two transforms. FCL's own getMotionBase() does not
/// set the reference point of an interpolation. Here it is the origin.
template <typename S>
std::shared_ptr<MotionBase<S>> makeFclMotion(const Transform3<S>& beg,
                                             const Transform3<S>& end,
                                             CCDMotionType type) {
  switch (type) {
    case CCDM_TRANS:
      return make_aligned_shared<TranslationMotion<S>>(beg, end);
    case CCDM_LINEAR:
      return make_aligned_shared<InterpMotion<S>>(beg.linear(), beg.translation(),
                                                  end.linear(), end.translation(),
                                                  Vector3<S>::Zero());
    case CCDM_SCREW:
      return make_aligned_shared<ScrewMotion<S>>(beg, end);
    case CCDM_SPLINE:
      return make_aligned_shared<SplineMotion<S>>(beg, end);
  }
  throw Exception(
      "request.ccd_motion_type is not a value of CCDMotionType. Use CCDM_TRANS, "
      "CCDM_LINEAR, CCDM_SCREW or CCDM_SPLINE");
}

/// @brief Whether FCL would write to data that a model shares with its copies. FCL cannot
/// turn some volumes: AABBs, KDOPs, RSSs of two meshes, and in conservative advancement
/// all. It copies such a model and builds the tree of the copy in each pose, with the
/// fitter and the splitter that all copies share. The polynomial solver moves the models
/// themselves.
template <typename S>
bool isWrittenTo(NODE_TYPE type, OBJECT_TYPE other,
                 const ContinuousCollisionRequest<S>& request) {
  return request.ccd_solver_type == CCDC_CONSERVATIVE_ADVANCEMENT ||
         request.ccd_solver_type == CCDC_POLYNOMIAL_SOLVER || type == BV_AABB ||
         type == BV_KDOP16 || type == BV_KDOP18 || type == BV_KDOP24 ||
         (type == BV_RSS && other == OT_BVH);
}

/// @brief The geometry, or a copy if FCL would write to it. Copying takes a small part of
/// the time of FCL's query.
template <typename S>
std::shared_ptr<const CollisionGeometry<S>> geometryForFcl(
    const CollisionGeometry<S>* o, const CollisionGeometry<S>* other,
    const ContinuousCollisionRequest<S>& request) {
  if (o->getObjectType() == OT_BVH &&
      isWrittenTo(o->getNodeType(), other->getObjectType(), request))
    return copyModel(*o);
  return {std::shared_ptr<const CollisionGeometry<S>>(), o};
}

/// @brief FCL's answer about geometries that follow motions.
template <typename S>
S askFcl(const MovingGeometry<S>& o1, const MotionBase<S>* motion1,
         const MovingGeometry<S>& o2, const MotionBase<S>* motion2,
         const ContinuousCollisionRequest<S>& request,
         ContinuousCollisionResult<S>& result) {
  return continuousCollide<S>(
      geometryForFcl(o1.geometry, o2.geometry, request).get(), motion1,
      geometryForFcl(o2.geometry, o1.geometry, request).get(), motion2, request, result);
}

/// @brief FCL's answer about geometries that go from one transform to another.
template <typename S,
          typename std::enable_if<!std::is_same<S, float>::value, int>::type = 0>
S askFcl(const MovingGeometry<S>& o1, const MovingGeometry<S>& o2,
         const ContinuousCollisionRequest<S>& request,
         ContinuousCollisionResult<S>& result) {
  const auto motionOf = [&request](const MovingGeometry<S>& o) {
    return makeFclMotion<S>(toTransform(o.pose[0]), toTransform(o.pose[1]),
                            request.ccd_motion_type);
  };
  return askFcl(o1, motionOf(o1).get(), o2, motionOf(o2).get(), request, result);
}

/// @brief The same in float, where stock FCL does not compile. The library does it. It is
/// a template, so that programs in double need not compile Eigen's transforms in float.
template <typename S,
          typename std::enable_if<std::is_same<S, float>::value, int>::type = 0>
S askFcl(const MovingGeometry<S>& o1, const MovingGeometry<S>& o2,
         const ContinuousCollisionRequest<S>& request,
         ContinuousCollisionResult<S>& result) {
  FclOutcome outcome{result.is_collide, result.time_of_contact, {}};
  const S answer = askFclInFloat(o1, o2, request, outcome);
  result.is_collide = outcome.is_collide;
  result.time_of_contact = outcome.time_of_contact;
  if (outcome.is_collide) {
    result.contact_tf1 = toTransform<S>(outcome.contact_pose[0]);
    result.contact_tf2 = toTransform<S>(outcome.contact_pose[1]);
  }
  return answer;
}

/// @brief FCL reports no contacts.
template <typename S>
S askFcl(const MovingGeometry<S>& o1, const MotionBase<S>*, const MovingGeometry<S>& o2,
         const MotionBase<S>*, const ContinuousContactRequest<S>&,
         ContinuousContactResult<S>& result) {
  refuseContacts(o1, o2);
  return result.time_of_contact;
}
template <typename S>
S askFcl(const MovingGeometry<S>& o1, const MovingGeometry<S>& o2,
         const ContinuousContactRequest<S>&, ContinuousContactResult<S>& result) {
  refuseContacts(o1, o2);
  return result.time_of_contact;
}

}  // namespace detail
}  // namespace fcl

#endif
