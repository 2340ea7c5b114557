// SPDX-License-Identifier: BSD-3-Clause
//
// Stands before FCL's header of the same name on the include path, includes it, and adds
// non-template overloads of its functions. Overload resolution prefers them, so that
// programs, and FCL's own templates, that call continuousCollide(...) reach them; FCL's
// body stays callable as continuousCollide<double>(...).
#ifndef FCL_NARROWPHASE_CONTINUOUS_COLLISION_OVERLAY_H
#define FCL_NARROWPHASE_CONTINUOUS_COLLISION_OVERLAY_H

#include "fcl/narrowphase/detail/stock_continuous_collision.h"

#include "fcl/narrowphase/continuous_contact.h"

namespace fcl {

/// @defgroup continuous_queries Continuous collision queries
///
/// Two triangle meshes are answered here, exactly in the sense below, when each of them
/// deforms (a DeformableBVHModel, or a BVHModel of any BV type in FCL's updated state) or
/// moves in translation; everything else (shapes, octrees, rigid meshes that rotate, user
/// defined motions of rigid meshes) reaches FCL's own function unchanged.
///
/// Paths: a vertex moves on the straight line from tf_beg * (previous frame) to tf_end *
/// (current frame), each evaluated in double; a contact is a VF or EE pair of closed
/// features that touch at some t in [0, 1]. The choice depends on the geometry and its
/// motion, never on request.ccd_solver_type. Models are not changed; two calls give the
/// same answer; concurrent calls on the same models are safe.
///
/// @throws fcl::Exception that names the object, when it or its motion is null, when a
/// mesh is not built or is in the middle of an update, has more than 2^29 triangles or
/// vertices, holds a coordinate that is not finite or a triangle index out of range, when
/// a transform is not finite, a geometry that has to be a mesh is none, or the request is
/// not usable (toc_err not positive, num_max_contacts 0, num_threads negative). A
/// coordinate of a rigid mesh is looked at where boxes meet: what is wrong with triangles
/// that cannot change the answer (too late for the first contact, or, with kAny, behind
/// what has the answer) may go unnoticed, for any number of threads alike.
/// @return the time of contact, never later than the true one; 0 when the surfaces cross
/// at t = 0; 1 without collision.
/// @{
#define FCL_CCD_DECLARE_QUERIES(S)                                                 \
  FCL_EXPORT S continuousCollide(                                                  \
      const CollisionGeometry<S>* o1, const MotionBase<S>* motion1,                \
      const CollisionGeometry<S>* o2, const MotionBase<S>* motion2,                \
      const ContinuousCollisionRequest<S>& request,                                \
      ContinuousCollisionResult<S>& result);                                       \
  FCL_EXPORT S continuousCollide(                                                  \
      const CollisionGeometry<S>* o1, const Transform3<S>& tf1_beg,                \
      const Transform3<S>& tf1_end, const CollisionGeometry<S>* o2,                \
      const Transform3<S>& tf2_beg, const Transform3<S>& tf2_end,                  \
      const ContinuousCollisionRequest<S>& request,                                \
      ContinuousCollisionResult<S>& result);                                       \
  FCL_EXPORT S continuousCollide(                                                  \
      const CollisionObject<S>* o1, const Transform3<S>& tf1_end,                  \
      const CollisionObject<S>* o2, const Transform3<S>& tf2_end,                  \
      const ContinuousCollisionRequest<S>& request,                                \
      ContinuousCollisionResult<S>& result);                                       \
  FCL_EXPORT S collide(const ContinuousCollisionObject<S>* o1,                     \
                       const ContinuousCollisionObject<S>* o2,                     \
                       const ContinuousCollisionRequest<S>& request,               \
                       ContinuousCollisionResult<S>& result);                      \
  FCL_EXPORT S continuousSelfCollide(const CollisionGeometry<S>* o,                \
                                     const ContinuousCollisionRequest<S>& request, \
                                     ContinuousCollisionResult<S>& result);

#define FCL_CCD_DECLARE_CONTACT_QUERIES(S, Request, Result, Ending)                \
  FCL_EXPORT S continuousCollide(                                                  \
      const CollisionGeometry<S>* o1, const MotionBase<S>* motion1,                \
      const CollisionGeometry<S>* o2, const MotionBase<S>* motion2,                \
      const Request<S>& request, Result<S>& result) Ending;                        \
  FCL_EXPORT S continuousCollide(                                                  \
      const CollisionGeometry<S>* o1, const Transform3<S>& tf1_beg,                \
      const Transform3<S>& tf1_end, const CollisionGeometry<S>* o2,                \
      const Transform3<S>& tf2_beg, const Transform3<S>& tf2_end,                  \
      const Request<S>& request, Result<S>& result) Ending;                        \
  FCL_EXPORT S continuousCollide(                                                  \
      const CollisionObject<S>* o1, const Transform3<S>& tf1_end,                  \
      const CollisionObject<S>* o2, const Transform3<S>& tf2_end,                  \
      const Request<S>& request, Result<S>& result) Ending;                        \
  FCL_EXPORT S collide(const ContinuousCollisionObject<S>* o1,                     \
                       const ContinuousCollisionObject<S>* o2,                     \
                       const Request<S>& request, Result<S>& result) Ending;       \
  FCL_EXPORT S continuousSelfCollide(const CollisionGeometry<S>* o,                \
                                     const Request<S>& request, Result<S>& result) \
      Ending;

FCL_CCD_DECLARE_QUERIES(double)
FCL_CCD_DECLARE_QUERIES(float)

// With contacts. Only meshes that are answered here have contacts to give; for other
// objects these throw fcl::Exception.
FCL_CCD_DECLARE_CONTACT_QUERIES(double, ContinuousContactRequest,
                                ContinuousContactResult, )
FCL_CCD_DECLARE_CONTACT_QUERIES(float, ContinuousContactRequest,
                                ContinuousContactResult, )

// FCL's request and result are not polymorphic: one of each kind would silently lose what
// the derived one asks for, so it does not compile.
FCL_CCD_DECLARE_CONTACT_QUERIES(double, ContinuousContactRequest,
                                ContinuousCollisionResult, = delete)
FCL_CCD_DECLARE_CONTACT_QUERIES(double, ContinuousCollisionRequest,
                                ContinuousContactResult, = delete)
FCL_CCD_DECLARE_CONTACT_QUERIES(float, ContinuousContactRequest,
                                ContinuousCollisionResult, = delete)
FCL_CCD_DECLARE_CONTACT_QUERIES(float, ContinuousCollisionRequest,
                                ContinuousContactResult, = delete)

#undef FCL_CCD_DECLARE_QUERIES
#undef FCL_CCD_DECLARE_CONTACT_QUERIES
/// @}

}  // namespace fcl

#endif
