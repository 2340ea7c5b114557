// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_NARROWPHASE_DETAIL_CONTINUOUS_QUERY_BODIES_H
#define FCL_NARROWPHASE_DETAIL_CONTINUOUS_QUERY_BODIES_H

// The bodies of the queries. They convert FCL's types into numbers, ask the library, and
// convert its answer back. Where the library does not answer, they call FCL's own
// queries, which are compiled with the program, as with stock FCL.
//
// Calls name their namespace. Without it the compiler also looks in the namespaces of the
// arguments: a function of the same name in Eigen's would make the call ambiguous.

#include <cassert>
#include <memory>
#include <mutex>
#include <string>

#include "fcl/common/exception.h"
#include "fcl/math/motion/interp_motion.h"
#include "fcl/math/motion/screw_motion.h"
#include "fcl/math/motion/spline_motion.h"
#include "fcl/math/motion/translation_motion.h"
#include "fcl/narrowphase/continuous_contact.h"
#include "fcl/narrowphase/detail/query_numbers.h"
#include "fcl/narrowphase/detail/stock_headers.h"

namespace fcl {
namespace detail {

inline void requireNotNull(const void* argument, const char* name) {
  if (!argument) throw Exception(std::string(name) + " is null");
}

template <typename S>
ContinuousContacts<S>* contactsOf(ContinuousCollisionResult<S>&) {
  return nullptr;
}

template <typename S>
ContinuousContacts<S>* contactsOf(ContinuousContactResult<S>& result) {
  return &result;
}

/// The pose of an object where it touches.
template <typename S>
PoseNumbers<S> contactPose(const MovingGeometry<S>& o, S t) {
  // Other paths begin within rounding of the first pose only.
  const bool begins_there = o.path == PathKind::kStraight || o.path == PathKind::kTurn ||
                            o.path == PathKind::kScrew;
  const bool is_first_pose =
      t == 0 && begins_there && detail::isRotationAsGiven(o.pose[0].rotation);
  return is_first_pose ? o.pose[0] : detail::poseAt(o, t);
}

/// The pose at t = 1.
template <typename S>
PoseNumbers<S> endPose(const MovingGeometry<S>& o) {
  return detail::isRotationAsGiven(o.pose[1].rotation) ? o.pose[1] : detail::lastPose(o);
}

/// Fills the fields of FCL's own result.
template <typename S>
void fillResult(const QueryOutcome<S>& outcome, const MovingGeometry<S>& o1,
                const MovingGeometry<S>& o2, ContinuousCollisionResult<S>& result) {
  assert(!(outcome.toc_lo > outcome.toc_hi) && !(outcome.toc_hi > outcome.pose_time));
  result.is_collide = outcome.is_collide;
  result.time_of_contact = outcome.toc_lo;
  if (!outcome.is_collide) {
    detail::setTransform(detail::endPose(o1), result.contact_tf1);
    detail::setTransform(detail::endPose(o2), result.contact_tf2);
    return;
  }
  detail::setTransform(detail::contactPose(o1, outcome.pose_time), result.contact_tf1);
  detail::setTransform(detail::contactPose(o2, outcome.pose_time), result.contact_tf2);
}

/// The path between two transforms that a request asks for.
inline PathKind pathOf(CCDMotionType type) {
  if (type == CCDM_TRANS) return PathKind::kStraight;
  if (type == CCDM_LINEAR) return PathKind::kTurn;
  return type == CCDM_SCREW ? PathKind::kScrew : PathKind::kUndefined;
}

/// FCL's own motion classes in float are compiled with the program, as this is.
template <typename Motion, typename S>
bool readMotionAs(const MotionBase<S>& motion, PoseNumbers<S> (&pose)[2]) {
  // A derived class may move differently: only this class itself is read.
  static const Motion example(Transform3<S>::Identity(), Transform3<S>::Identity());
  if (!detail::haveSameClass<MotionBase<S>>(motion, example)) return false;
  // integrate() changes the motion.
  const Motion copy(static_cast<const Motion&>(motion));
  for (int end = 0; end < 2; ++end) {
    Transform3<S> tf;
    copy.integrate(S(end));
    copy.getCurrentTransform(tf);
    pose[end] = detail::toNumbers(tf);
  }
  return true;
}

/// Reads the control points of a spline, which are protected.
template <typename S>
class SplineControl : public SplineMotion<S> {
 public:
  static void read(const SplineMotion<S>& motion, double (&control)[2][4][3]) {
    const Vector3<S>(&translation)[4] = motion.*(&SplineControl::Td);
    const Vector3<S>(&rotation)[4] = motion.*(&SplineControl::Rd);
    for (int i = 0; i < 4; ++i)
      for (int k = 0; k < 3; ++k) {
        control[0][i][k] = static_cast<double>(translation[i][k]);
        control[1][i][k] = static_cast<double>(rotation[i][k]);
      }
  }
};

/// In float, where FCL's other two motion classes are abstract.
template <typename S>
bool readMotion(const MotionBase<S>& motion, MovingGeometry<S>& moving) {
  moving.path = PathKind::kStraight;
  if (detail::readMotionAs<TranslationMotion<S>>(motion, moving.pose)) return true;
  if (!detail::readMotionAs<SplineMotion<S>>(motion, moving.pose)) return false;
  moving.path = PathKind::kSpline;
  SplineControl<S>::read(static_cast<const SplineMotion<S>&>(motion), moving.control);
  return true;
}

inline bool readMotion(const MotionBase<double>& motion, MovingGeometry<double>& moving) {
  return detail::readFclMotion(motion, moving);
}

/// The ends of a motion class of the program that is a BoundedMotion.
template <typename S>
void readBoundedMotion(const BoundedMotion& motion, MovingGeometry<S>& moving) {
  moving.path = PathKind::kBounded;
  moving.motion = &motion;
  for (int end = 0; end < 2; ++end) {
    const BoundedMotion::Placement at = motion.placementAt(end);
    PoseNumbers<S>& pose = moving.pose[end];
    for (int i = 0; i < 9; ++i) pose.rotation[i] = static_cast<S>(at.rotation[i]);
    for (int k = 0; k < 3; ++k) pose.translation[k] = static_cast<S>(at.translation[k]);
  }
}

/// A geometry that follows a motion. Another motion class of the program cannot be
/// copied. Its poses are read only for a mesh that deforms, if the other object is a
/// mesh, a shape or an octree; the motion is at its beginning afterwards. FCL answers all
/// other geometries that follow it.
template <typename S>
MovingGeometry<S> movingGeometry(const CollisionGeometry<S>* o,
                                 const MotionBase<S>* motion,
                                 const CollisionGeometry<S>* other) {
  MovingGeometry<S> moving{o, {}, PathKind::kUnknown, {}, {}, nullptr, {}, {}};
  if (detail::readMotion(*motion, moving)) return moving;
  if (const BoundedMotion* bounded = detail::asBoundedMotion(*motion)) {
    detail::readBoundedMotion(*bounded, moving);
    return moving;
  }
  Transform3<S> tf = Transform3<S>::Identity();
  moving.pose[0] = moving.pose[1] = detail::toNumbers(tf);
  moving.path = PathKind::kUnknown;
  const OBJECT_TYPE type = other->getObjectType();
  if ((type == OT_BVH || type == OT_GEOM || type == OT_OCTREE) &&
      detail::isDeformingMesh(*o)) {
    // Queries of several pairs at the same time may share the motion.
    static std::mutex mutex;
    const std::lock_guard<std::mutex> lock(mutex);
    for (int end = 1; end >= 0; --end) {
      motion->integrate(S(end));
      motion->getCurrentTransform(tf);
      moving.pose[end] = detail::toNumbers(tf);
    }
  }
  return moving;
}

/// In float, objects are compiled with the program.
template <typename S>
PoseNumbers<S> transformOf(const CollisionObject<S>& o) {
  return detail::toNumbers(o.getTransform());
}

/// The motion that FCL makes of two transforms. FCL's own getMotionBase() does not set
/// the reference point of an interpolation. Here it is the origin.
template <typename S>
std::shared_ptr<MotionBase<S>> makeFclMotion(const Transform3<S>& beg,
                                             const Transform3<S>& end,
                                             CCDMotionType type) {
  switch (type) {
    case CCDM_TRANS:
      return fcl::make_aligned_shared<TranslationMotion<S>>(beg, end);
    case CCDM_LINEAR:
      return fcl::make_aligned_shared<InterpMotion<S>>(beg.linear(), beg.translation(),
                                                       end.linear(), end.translation(),
                                                       Vector3<S>::Zero());
    case CCDM_SCREW:
      return fcl::make_aligned_shared<ScrewMotion<S>>(beg, end);
    case CCDM_SPLINE:
      return fcl::make_aligned_shared<SplineMotion<S>>(beg, end);
  }
  throw Exception(
      "request.ccd_motion_type is not a value of CCDMotionType. Use CCDM_TRANS, "
      "CCDM_LINEAR, CCDM_SCREW or CCDM_SPLINE");
}

/// Whether FCL would write to data that a model shares with its copies. FCL cannot turn
/// some volumes: AABBs, KDOPs, RSSs of two meshes, and in conservative advancement all.
/// It copies such a model and builds the tree of the copy in each pose, with the fitter
/// and the splitter that all copies share. The polynomial solver moves the models
/// themselves.
template <typename S>
bool isWrittenTo(NODE_TYPE type, OBJECT_TYPE other,
                 const ContinuousCollisionRequest<S>& request) {
  return request.ccd_solver_type == CCDC_CONSERVATIVE_ADVANCEMENT ||
         request.ccd_solver_type == CCDC_POLYNOMIAL_SOLVER || type == BV_AABB ||
         type == BV_KDOP16 || type == BV_KDOP18 || type == BV_KDOP24 ||
         (type == BV_RSS && other == OT_BVH);
}

/// The geometry, or a copy if FCL would write to it. Copying takes a small part of the
/// time of FCL's query.
template <typename S>
std::shared_ptr<const CollisionGeometry<S>> geometryForFcl(
    const CollisionGeometry<S>* o, const CollisionGeometry<S>* other,
    const ContinuousCollisionRequest<S>& request) {
  if (o->getObjectType() == OT_BVH &&
      detail::isWrittenTo(o->getNodeType(), other->getObjectType(), request))
    return detail::copyModel(*o);
  return {std::shared_ptr<const CollisionGeometry<S>>(), o};
}

/// FCL's answer about geometries that follow motions.
template <typename S>
S askFcl(const MovingGeometry<S>& o1, const MotionBase<S>* motion1,
         const MovingGeometry<S>& o2, const MotionBase<S>* motion2,
         const ContinuousCollisionRequest<S>& request,
         ContinuousCollisionResult<S>& result) {
  return fcl::continuousCollide<S>(
      detail::geometryForFcl(o1.geometry, o2.geometry, request).get(), motion1,
      detail::geometryForFcl(o2.geometry, o1.geometry, request).get(), motion2, request,
      result);
}

/// FCL's answer about geometries that go from one transform to another.
template <typename S>
S askFcl(const MovingGeometry<S>& o1, const MovingGeometry<S>& o2,
         const ContinuousCollisionRequest<S>& request,
         ContinuousCollisionResult<S>& result) {
  const auto motionOf = [&request](const MovingGeometry<S>& o) {
    return detail::makeFclMotion<S>(detail::toTransform(o.pose[0]),
                                    detail::toTransform(o.pose[1]),
                                    request.ccd_motion_type);
  };
  return detail::askFcl(o1, motionOf(o1).get(), o2, motionOf(o2).get(), request, result);
}

/// In float FCL's query between transforms does not compile.
template <>
inline float askFcl(const MovingGeometry<float>& o1, const MovingGeometry<float>& o2,
                    const ContinuousCollisionRequest<float>&,
                    ContinuousCollisionResult<float>&) {
  detail::refuseTransforms(o1, o2);
}

/// FCL reports no contacts.
template <typename S>
S askFcl(const MovingGeometry<S>& o1, const MotionBase<S>*, const MovingGeometry<S>& o2,
         const MotionBase<S>*, const ContinuousContactRequest<S>&,
         ContinuousContactResult<S>& result) {
  detail::refuseContacts(o1, o2);
  return result.time_of_contact;
}
template <typename S>
S askFcl(const MovingGeometry<S>& o1, const MovingGeometry<S>& o2,
         const ContinuousContactRequest<S>&, ContinuousContactResult<S>& result) {
  detail::refuseContacts(o1, o2);
  return result.time_of_contact;
}

/// @return false when FCL has to answer the pair; nothing has changed then.
template <typename S, typename Request, typename Result>
bool collideHere(const MovingGeometry<S>& o1, const MovingGeometry<S>& o2,
                 const Request& request, Result& result) {
  QueryOutcome<S> outcome;
  if (!detail::answerPair(o1, o2, request, outcome, detail::contactsOf(result)))
    return false;
  detail::fillResult(outcome, o1, o2, result);
  return true;
}

template <typename S, typename Request, typename Result>
S collideMotions(const CollisionGeometry<S>* o1, const MotionBase<S>* motion1,
                 const CollisionGeometry<S>* o2, const MotionBase<S>* motion2,
                 const Request& request, Result& result) {
  detail::requireNotNull(o1, "o1");
  detail::requireNotNull(o2, "o2");
  detail::requireNotNull(motion1, "motion1");
  detail::requireNotNull(motion2, "motion2");
  const MovingGeometry<S> moving1 = detail::movingGeometry(o1, motion1, o2),
                          moving2 = detail::movingGeometry(o2, motion2, o1);
  if (detail::collideHere(moving1, moving2, request, result))
    return result.time_of_contact;
  return detail::askFcl(moving1, motion1, moving2, motion2, request, result);
}

template <typename S, typename Request, typename Result>
S collideTransforms(const CollisionGeometry<S>* o1, const Transform3<S>& tf1_beg,
                    const Transform3<S>& tf1_end, const CollisionGeometry<S>* o2,
                    const Transform3<S>& tf2_beg, const Transform3<S>& tf2_end,
                    const Request& request, Result& result) {
  detail::requireNotNull(o1, "o1");
  detail::requireNotNull(o2, "o2");
  const PathKind path = detail::pathOf(request.ccd_motion_type);
  const MovingGeometry<S> moving1 = detail::movingGeometry(o1, tf1_beg, tf1_end, path),
                          moving2 = detail::movingGeometry(o2, tf2_beg, tf2_end, path);
  if (detail::collideHere(moving1, moving2, request, result))
    return result.time_of_contact;
  return detail::askFcl(moving1, moving2, request, result);
}

template <typename S, typename Request, typename Result>
S collideObjects(const CollisionObject<S>* o1, const Transform3<S>& tf1_end,
                 const CollisionObject<S>* o2, const Transform3<S>& tf2_end,
                 const Request& request, Result& result) {
  detail::requireNotNull(o1, "o1");
  detail::requireNotNull(o2, "o2");
  return detail::collideTransforms<S>(
      o1->collisionGeometry().get(), detail::toTransform(detail::transformOf(*o1)),
      tf1_end, o2->collisionGeometry().get(),
      detail::toTransform(detail::transformOf(*o2)), tf2_end, request, result);
}

template <typename S, typename Request, typename Result>
S collideMovingObjects(const ContinuousCollisionObject<S>* o1,
                       const ContinuousCollisionObject<S>* o2, const Request& request,
                       Result& result) {
  detail::requireNotNull(o1, "o1");
  detail::requireNotNull(o2, "o2");
  return detail::collideMotions<S>(o1->collisionGeometry().get(), o1->getMotion(),
                                   o2->collisionGeometry().get(), o2->getMotion(),
                                   request, result);
}

template <typename S, typename Request, typename Result>
S collideSelf(const CollisionGeometry<S>* o, const Request& request, Result& result) {
  const Transform3<S> still = Transform3<S>::Identity();
  const MovingGeometry<S> moving = detail::movingGeometry(o, still, still);
  QueryOutcome<S> outcome;
  detail::answerSelf(o, request, outcome, detail::contactsOf(result));
  detail::fillResult(outcome, moving, moving, result);
  return result.time_of_contact;
}

}  // namespace detail

/// The bodies of the queries. A friend that is defined in a class template is compiled
/// only where it is called. So a program without queries in float compiles nothing of FCL
/// in float.
template <typename S>
class ContinuousQueryBodies {
  friend S continuousCollide(const CollisionGeometry<S>* o1, const MotionBase<S>* motion1,
                             const CollisionGeometry<S>* o2, const MotionBase<S>* motion2,
                             const ContinuousCollisionRequest<S>& request,
                             ContinuousCollisionResult<S>& result) {
    return detail::collideMotions(o1, motion1, o2, motion2, request, result);
  }
  friend S continuousCollide(const CollisionGeometry<S>* o1, const Transform3<S>& tf1_beg,
                             const Transform3<S>& tf1_end, const CollisionGeometry<S>* o2,
                             const Transform3<S>& tf2_beg, const Transform3<S>& tf2_end,
                             const ContinuousCollisionRequest<S>& request,
                             ContinuousCollisionResult<S>& result) {
    return detail::collideTransforms(o1, tf1_beg, tf1_end, o2, tf2_beg, tf2_end, request,
                                     result);
  }
  friend S continuousCollide(const CollisionObject<S>* o1, const Transform3<S>& tf1_end,
                             const CollisionObject<S>* o2, const Transform3<S>& tf2_end,
                             const ContinuousCollisionRequest<S>& request,
                             ContinuousCollisionResult<S>& result) {
    return detail::collideObjects(o1, tf1_end, o2, tf2_end, request, result);
  }
  friend S collide(const ContinuousCollisionObject<S>* o1,
                   const ContinuousCollisionObject<S>* o2,
                   const ContinuousCollisionRequest<S>& request,
                   ContinuousCollisionResult<S>& result) {
    return detail::collideMovingObjects(o1, o2, request, result);
  }
  friend S continuousSelfCollide(const CollisionGeometry<S>* o,
                                 const ContinuousCollisionRequest<S>& request,
                                 ContinuousCollisionResult<S>& result) {
    return detail::collideSelf(o, request, result);
  }
  friend S continuousCollide(const CollisionGeometry<S>* o1, const MotionBase<S>* motion1,
                             const CollisionGeometry<S>* o2, const MotionBase<S>* motion2,
                             const ContinuousContactRequest<S>& request,
                             ContinuousContactResult<S>& result) {
    return detail::collideMotions(o1, motion1, o2, motion2, request, result);
  }
  friend S continuousCollide(const CollisionGeometry<S>* o1, const Transform3<S>& tf1_beg,
                             const Transform3<S>& tf1_end, const CollisionGeometry<S>* o2,
                             const Transform3<S>& tf2_beg, const Transform3<S>& tf2_end,
                             const ContinuousContactRequest<S>& request,
                             ContinuousContactResult<S>& result) {
    return detail::collideTransforms(o1, tf1_beg, tf1_end, o2, tf2_beg, tf2_end, request,
                                     result);
  }
  friend S continuousCollide(const CollisionObject<S>* o1, const Transform3<S>& tf1_end,
                             const CollisionObject<S>* o2, const Transform3<S>& tf2_end,
                             const ContinuousContactRequest<S>& request,
                             ContinuousContactResult<S>& result) {
    return detail::collideObjects(o1, tf1_end, o2, tf2_end, request, result);
  }
  friend S collide(const ContinuousCollisionObject<S>* o1,
                   const ContinuousCollisionObject<S>* o2,
                   const ContinuousContactRequest<S>& request,
                   ContinuousContactResult<S>& result) {
    return detail::collideMovingObjects(o1, o2, request, result);
  }
  friend S continuousSelfCollide(const CollisionGeometry<S>* o,
                                 const ContinuousContactRequest<S>& request,
                                 ContinuousContactResult<S>& result) {
    return detail::collideSelf(o, request, result);
  }
};

// Instantiates the classes, which declares the friends.
static_assert(sizeof(ContinuousQueryBodies<double>) == 1, "");
static_assert(sizeof(ContinuousQueryBodies<float>) == 1, "");

}  // namespace fcl

#endif
