// SPDX-License-Identifier: BSD-3-Clause
//
// Stands before FCL's header of the same name on the include path, includes it, and adds
// non-template overloads of its functions. Overload resolution prefers them, so that
// programs, and FCL's own templates, that call continuousCollide(...) reach them; FCL's
// body stays callable as continuousCollide<double>(...).
#ifndef FCL_NARROWPHASE_CONTINUOUS_COLLISION_OVERLAY_H
#define FCL_NARROWPHASE_CONTINUOUS_COLLISION_OVERLAY_H

#include <type_traits>

#include "fcl/narrowphase/detail/stock_continuous_collision.h"

#include "fcl/narrowphase/continuous_contact.h"

namespace fcl {
namespace detail {

/// A request and a result of which one is for contacts and the other is not.
template <typename S, typename Request, typename Result>
using IfMixed = typename std::enable_if<
    std::is_base_of<ContinuousCollisionRequest<S>, Request>::value &&
    std::is_base_of<ContinuousCollisionResult<S>, Result>::value &&
    std::is_base_of<ContinuousContactRequest<S>, Request>::value !=
        std::is_base_of<ContinuousContactResult<S>, Result>::value>::type;

}  // namespace detail

/// @defgroup continuous_queries Continuous collision queries
///
/// Two triangle meshes are answered here, exactly in the sense below, when each of them
/// deforms (a DeformableBVHModel, or a BVHModel of any BV type in FCL's updated state) or
/// moves in translation; everything else (shapes, octrees, rigid meshes that rotate, user
/// defined motions of rigid meshes) reaches FCL's own function unchanged. A
/// DeformableBVHModel whose frames are equal is a rigid mesh.
///
/// FCL takes a mesh as it is in the current frame and knows nothing of the previous one:
/// a mesh that deforms stands still where the other object is a shape or a rigid mesh
/// that rotates. For such a mesh there is a way: a DeformableBVHModel that is given its
/// vertices in both poses, updateFrames(), with the identity for a pose. Their paths are
/// the chords of the arcs then, of which an angle of a radians leaves out less than r a^2
/// / 8 at a distance of r from the axis.
///
/// Paths: a vertex moves on the straight line from tf_beg * (previous frame) to tf_end *
/// (current frame), each evaluated in double; a contact is a VF or EE pair of closed
/// features that touch at some t in [0, 1] (an edge of a vertex with itself is none: its
/// triangle has that vertex). The choice depends on the geometry and its motion, never on
/// request.ccd_solver_type or ccd_motion_type. Models are not changed; two calls give the
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
#define FCL_CCD_DECLARE_QUERIES(S, Request, Result)                   \
  FCL_EXPORT S continuousCollide(                                     \
      const CollisionGeometry<S>* o1, const MotionBase<S>* motion1,   \
      const CollisionGeometry<S>* o2, const MotionBase<S>* motion2,   \
      const Request<S>& request, Result<S>& result);                  \
  FCL_EXPORT S continuousCollide(                                     \
      const CollisionGeometry<S>* o1, const Transform3<S>& tf1_beg,   \
      const Transform3<S>& tf1_end, const CollisionGeometry<S>* o2,   \
      const Transform3<S>& tf2_beg, const Transform3<S>& tf2_end,     \
      const Request<S>& request, Result<S>& result);                  \
  FCL_EXPORT S continuousCollide(                                     \
      const CollisionObject<S>* o1, const Transform3<S>& tf1_end,     \
      const CollisionObject<S>* o2, const Transform3<S>& tf2_end,     \
      const Request<S>& request, Result<S>& result);                  \
  FCL_EXPORT S collide(const ContinuousCollisionObject<S>* o1,        \
                       const ContinuousCollisionObject<S>* o2,        \
                       const Request<S>& request, Result<S>& result); \
  FCL_EXPORT S continuousSelfCollide(const CollisionGeometry<S>* o,   \
                                     const Request<S>& request, Result<S>& result);

FCL_CCD_DECLARE_QUERIES(double, ContinuousCollisionRequest, ContinuousCollisionResult)
FCL_CCD_DECLARE_QUERIES(float, ContinuousCollisionRequest, ContinuousCollisionResult)

// With contacts. Only meshes that are answered here have contacts to give; for other
// objects these throw fcl::Exception.
FCL_CCD_DECLARE_QUERIES(double, ContinuousContactRequest, ContinuousContactResult)
FCL_CCD_DECLARE_QUERIES(float, ContinuousContactRequest, ContinuousContactResult)

// FCL's request and result are not polymorphic: one with contacts and one without would
// silently lose what is asked for, so they do not compile.
#define FCL_CCD_DELETE_QUERIES(S)                                                   \
  template <typename Request, typename Result,                                      \
            typename = detail::IfMixed<S, Request, Result>>                         \
  S continuousCollide(const CollisionGeometry<S>* o1, const MotionBase<S>* motion1, \
                      const CollisionGeometry<S>* o2, const MotionBase<S>* motion2, \
                      const Request& request, Result& result) = delete;             \
  template <typename Request, typename Result,                                      \
            typename = detail::IfMixed<S, Request, Result>>                         \
  S continuousCollide(const CollisionGeometry<S>* o1, const Transform3<S>& tf1_beg, \
                      const Transform3<S>& tf1_end, const CollisionGeometry<S>* o2, \
                      const Transform3<S>& tf2_beg, const Transform3<S>& tf2_end,   \
                      const Request& request, Result& result) = delete;             \
  template <typename Request, typename Result,                                      \
            typename = detail::IfMixed<S, Request, Result>>                         \
  S continuousCollide(const CollisionObject<S>* o1, const Transform3<S>& tf1_end,   \
                      const CollisionObject<S>* o2, const Transform3<S>& tf2_end,   \
                      const Request& request, Result& result) = delete;             \
  template <typename Request, typename Result,                                      \
            typename = detail::IfMixed<S, Request, Result>>                         \
  S collide(const ContinuousCollisionObject<S>* o1,                                 \
            const ContinuousCollisionObject<S>* o2, const Request& request,         \
            Result& result) = delete;                                               \
  template <typename Request, typename Result,                                      \
            typename = detail::IfMixed<S, Request, Result>>                         \
  S continuousSelfCollide(const CollisionGeometry<S>* o, const Request& request,    \
                          Result& result) = delete;
FCL_CCD_DELETE_QUERIES(double)
FCL_CCD_DELETE_QUERIES(float)

#undef FCL_CCD_DECLARE_QUERIES
#undef FCL_CCD_DELETE_QUERIES
/// @}

}  // namespace fcl

#endif
