// SPDX-License-Identifier: BSD-3-Clause
//
// Stands before FCL's header of the same name on the include path, includes it, and adds
// non-template overloads of its functions. Overload resolution prefers them, so that
// programs, and FCL's own templates, that call continuousCollide(...) reach them; FCL's
// body stays callable as continuousCollide<double>(...).
#ifndef FCL_NARROWPHASE_CONTINUOUS_COLLISION_OVERLAY_H
#define FCL_NARROWPHASE_CONTINUOUS_COLLISION_OVERLAY_H

#include <type_traits>

#include "fcl/ccd_version.h"
#include "fcl/narrowphase/continuous_contact.h"
#include "fcl/narrowphase/detail/stock_continuous_collision.h"

namespace fcl {

/// @defgroup continuous_queries Continuous collision queries
///
/// Two triangle meshes are answered here, of any BV type, rigid or deforming (a
/// DeformableBVHModel, or a BVHModel in FCL's updated state), whatever they do. A rigid
/// mesh that follows a class of motion of the program's own, and what it is tested
/// against, reach FCL's own function, as do shapes, octrees and point clouds. A
/// DeformableBVHModel whose frames are equal is a rigid mesh. FCL takes a mesh as it is
/// in the current frame and knows nothing of the previous one: a mesh that deforms stands
/// still where FCL answers.
///
/// Paths are the real-number evaluation of what was given, in double. A contact is a VF
/// or EE pair of closed features that touch at some t in [0, 1] (an edge of a vertex with
/// itself is none: its triangle has that vertex).
/// - Straight: of meshes whose rotation is constant (up to a few roundings), and of a
/// mesh
///   that deforms between two transforms. A vertex goes from tf_beg * (previous frame) to
///   tf_end * (current frame). When both meshes go straight the answer is exact.
/// - Turning: a rigid mesh whose end transforms have different rotations. It turns at
///   constant speed about the origin of its frame, which goes straight (CCDM_LINEAR, and
///   CCDM_TRANS, with which FCL drops the rotation in silence), or about the axis of a
///   screw (CCDM_SCREW). A mesh that deforms does so in the frame that turns, only if
///   CCDM_LINEAR or CCDM_SCREW, or a motion object, asks for a turn: motion(t) * ((1 - t)
///   previous + t current). CCDM_SPLINE means nothing between two transforms and throws
///   where a rigid mesh turns.
/// - Motion objects of FCL's: TranslationMotion; InterpMotion between the transforms that
///   it was made from, about its reference point; ScrewMotion between its transforms;
///   SplineMotion by its control points.
///
/// When a mesh turns or bends, contact means to come within a tolerance tau, some hundred
/// units in the last place of the coordinates, relative to the middle between both meshes
/// (doc/numerics.md): no contact is missed, no time is late, and what is reported comes
/// within tau of touching. Surfaces within tau at t = 0 give the time 0. A pair that
/// slides for more than 10,000 steps without a proof is reported from then on.
///
/// Neither request.ccd_solver_type nor num_max_iterations plays a part.
///
/// Result: time_of_contact is the lower end of the first contact's time bracket, never
/// later than the contact; contact_tf1 and contact_tf2 are the poses at the bracket's
/// upper end, never earlier than it, where the objects have met as a rule, so that
/// collide() there finds contacts. Where the bracket is as narrow as rounding (a
/// request.toc_err of that size, or a time found exactly), or the objects touch without
/// passing into each other, these poses may only touch. Of a mesh that turns they are
/// those of the motion.
///
/// request.toc_err is the width of the bracket; 0 means as narrow as doubles allow.
///
/// Models are not changed; two calls give the same answer. Concurrent calls on the same
/// models are safe, those that FCL answers included (FCL is given a copy of a model that
/// it would write to), and so are those on the same motions where this library answers.
/// Motion objects that FCL answers about, and those of a class of the program's own, must
/// not be shared by concurrent calls: asking where they are moves them.
///
/// @throws fcl::Exception that names the object, when it or its motion is null, when a
/// mesh is not built or is in the middle of an update, has more than 2^29 triangles or
/// vertices, holds a coordinate that is not finite or a triangle index out of range, when
/// a transform is not finite, a geometry that has to be a mesh is none, or the request is
/// not usable (toc_err negative or NaN, num_max_contacts 0, num_threads negative); when
/// the reference point of an InterpMotion is not finite, or adds more rounding than
/// toc_err; when a path that turns has coordinates beyond 2^200. FCL
/// checks nothing of what it answers. A
/// coordinate of a rigid mesh is looked at where boxes meet: what is wrong with triangles
/// that cannot change the answer (too late for the first contact, or, with kAny, behind
/// what has the answer) may go unnoticed, for any number of threads alike.
/// @return the time of contact, never later than the true one; 0 when the surfaces cross
/// at t = 0; 1 without collision.
/// @{

/// @brief The first contact of two geometries that follow motions.
double continuousCollide(const CollisionGeometry<double>* o1,
                         const MotionBase<double>* motion1,
                         const CollisionGeometry<double>* o2,
                         const MotionBase<double>* motion2,
                         const ContinuousCollisionRequest<double>& request,
                         ContinuousCollisionResult<double>& result);
/// @overload
float continuousCollide(const CollisionGeometry<float>* o1,
                        const MotionBase<float>* motion1,
                        const CollisionGeometry<float>* o2,
                        const MotionBase<float>* motion2,
                        const ContinuousCollisionRequest<float>& request,
                        ContinuousCollisionResult<float>& result);

/// @brief The first contact of two geometries that go from one transform to another.
/// request.ccd_motion_type says how what turns does so. Where FCL answers it has no
/// interpolated and no screw motion in float: those throw.
double continuousCollide(const CollisionGeometry<double>* o1,
                         const Transform3<double>& tf1_beg,
                         const Transform3<double>& tf1_end,
                         const CollisionGeometry<double>* o2,
                         const Transform3<double>& tf2_beg,
                         const Transform3<double>& tf2_end,
                         const ContinuousCollisionRequest<double>& request,
                         ContinuousCollisionResult<double>& result);
/// @overload
float continuousCollide(const CollisionGeometry<float>* o1,
                        const Transform3<float>& tf1_beg,
                        const Transform3<float>& tf1_end,
                        const CollisionGeometry<float>* o2,
                        const Transform3<float>& tf2_beg,
                        const Transform3<float>& tf2_end,
                        const ContinuousCollisionRequest<float>& request,
                        ContinuousCollisionResult<float>& result);

/// @brief The first contact of two objects that go from their transform to another.
double continuousCollide(const CollisionObject<double>* o1,
                         const Transform3<double>& tf1_end,
                         const CollisionObject<double>* o2,
                         const Transform3<double>& tf2_end,
                         const ContinuousCollisionRequest<double>& request,
                         ContinuousCollisionResult<double>& result);
/// @overload
float continuousCollide(const CollisionObject<float>* o1,
                        const Transform3<float>& tf1_end,
                        const CollisionObject<float>* o2,
                        const Transform3<float>& tf2_end,
                        const ContinuousCollisionRequest<float>& request,
                        ContinuousCollisionResult<float>& result);

/// @brief The first contact of two objects that follow motions.
double collide(const ContinuousCollisionObject<double>* o1,
               const ContinuousCollisionObject<double>* o2,
               const ContinuousCollisionRequest<double>& request,
               ContinuousCollisionResult<double>& result);
/// @overload
float collide(const ContinuousCollisionObject<float>* o1,
              const ContinuousCollisionObject<float>* o2,
              const ContinuousCollisionRequest<float>& request,
              ContinuousCollisionResult<float>& result);

/// @brief The first contact of a mesh with itself; its pose does not matter.
double continuousSelfCollide(const CollisionGeometry<double>* o,
                             const ContinuousCollisionRequest<double>& request,
                             ContinuousCollisionResult<double>& result);
/// @overload
float continuousSelfCollide(const CollisionGeometry<float>* o,
                            const ContinuousCollisionRequest<float>& request,
                            ContinuousCollisionResult<float>& result);

/// @name With contacts
/// Only meshes that are answered here have contacts to give; for other objects these
/// throw fcl::Exception.
/// @{

/// @brief The contacts of two geometries that follow motions.
double continuousCollide(const CollisionGeometry<double>* o1,
                         const MotionBase<double>* motion1,
                         const CollisionGeometry<double>* o2,
                         const MotionBase<double>* motion2,
                         const ContinuousContactRequest<double>& request,
                         ContinuousContactResult<double>& result);
/// @overload
float continuousCollide(const CollisionGeometry<float>* o1,
                        const MotionBase<float>* motion1,
                        const CollisionGeometry<float>* o2,
                        const MotionBase<float>* motion2,
                        const ContinuousContactRequest<float>& request,
                        ContinuousContactResult<float>& result);

/// @brief The contacts of two geometries that go from one transform to another.
double continuousCollide(const CollisionGeometry<double>* o1,
                         const Transform3<double>& tf1_beg,
                         const Transform3<double>& tf1_end,
                         const CollisionGeometry<double>* o2,
                         const Transform3<double>& tf2_beg,
                         const Transform3<double>& tf2_end,
                         const ContinuousContactRequest<double>& request,
                         ContinuousContactResult<double>& result);
/// @overload
float continuousCollide(const CollisionGeometry<float>* o1,
                        const Transform3<float>& tf1_beg,
                        const Transform3<float>& tf1_end,
                        const CollisionGeometry<float>* o2,
                        const Transform3<float>& tf2_beg,
                        const Transform3<float>& tf2_end,
                        const ContinuousContactRequest<float>& request,
                        ContinuousContactResult<float>& result);

/// @brief The contacts of two objects that go from their transform to another.
double continuousCollide(const CollisionObject<double>* o1,
                         const Transform3<double>& tf1_end,
                         const CollisionObject<double>* o2,
                         const Transform3<double>& tf2_end,
                         const ContinuousContactRequest<double>& request,
                         ContinuousContactResult<double>& result);
/// @overload
float continuousCollide(const CollisionObject<float>* o1,
                        const Transform3<float>& tf1_end,
                        const CollisionObject<float>* o2,
                        const Transform3<float>& tf2_end,
                        const ContinuousContactRequest<float>& request,
                        ContinuousContactResult<float>& result);

/// @brief The contacts of two objects that follow motions.
double collide(const ContinuousCollisionObject<double>* o1,
               const ContinuousCollisionObject<double>* o2,
               const ContinuousContactRequest<double>& request,
               ContinuousContactResult<double>& result);
/// @overload
float collide(const ContinuousCollisionObject<float>* o1,
              const ContinuousCollisionObject<float>* o2,
              const ContinuousContactRequest<float>& request,
              ContinuousContactResult<float>& result);

/// @brief The contacts of a mesh with itself; its pose does not matter.
double continuousSelfCollide(const CollisionGeometry<double>* o,
                             const ContinuousContactRequest<double>& request,
                             ContinuousContactResult<double>& result);
/// @overload
float continuousSelfCollide(const CollisionGeometry<float>* o,
                            const ContinuousContactRequest<float>& request,
                            ContinuousContactResult<float>& result);
/// @}

/// @}

namespace detail {

/// A request and a result of which one is for contacts and the other is not.
template <typename S, typename Request, typename Result>
using IfMixed = typename std::enable_if<
    std::is_base_of<ContinuousCollisionRequest<S>, Request>::value &&
    std::is_base_of<ContinuousCollisionResult<S>, Result>::value &&
    std::is_base_of<ContinuousContactRequest<S>, Request>::value !=
        std::is_base_of<ContinuousContactResult<S>, Result>::value>::type;

/// `Transform3<S>` where S is told by another argument, so that what converts to it does.
template <typename S>
using ConvertedTransform3 = typename std::common_type<Transform3<S>>::type;

}  // namespace detail

// FCL's request and result are not polymorphic: one with contacts and one without would
// silently lose what is asked for, so they do not compile.
template <typename S, typename Request, typename Result,
          typename = detail::IfMixed<S, Request, Result>>
S continuousCollide(const CollisionGeometry<S>* o1, const MotionBase<S>* motion1,
                    const CollisionGeometry<S>* o2, const MotionBase<S>* motion2,
                    const Request& request, Result& result) = delete;
template <typename S, typename Request, typename Result,
          typename = detail::IfMixed<S, Request, Result>>
S continuousCollide(const CollisionGeometry<S>* o1,
                    const detail::ConvertedTransform3<S>& tf1_beg,
                    const detail::ConvertedTransform3<S>& tf1_end,
                    const CollisionGeometry<S>* o2,
                    const detail::ConvertedTransform3<S>& tf2_beg,
                    const detail::ConvertedTransform3<S>& tf2_end, const Request& request,
                    Result& result) = delete;
template <typename S, typename Request, typename Result,
          typename = detail::IfMixed<S, Request, Result>>
S continuousCollide(const CollisionObject<S>* o1,
                    const detail::ConvertedTransform3<S>& tf1_end,
                    const CollisionObject<S>* o2,
                    const detail::ConvertedTransform3<S>& tf2_end, const Request& request,
                    Result& result) = delete;
template <typename S, typename Request, typename Result,
          typename = detail::IfMixed<S, Request, Result>>
S collide(const ContinuousCollisionObject<S>* o1, const ContinuousCollisionObject<S>* o2,
          const Request& request, Result& result) = delete;
template <typename S, typename Request, typename Result,
          typename = detail::IfMixed<S, Request, Result>>
S continuousSelfCollide(const CollisionGeometry<S>* o, const Request& request,
                        Result& result) = delete;

}  // namespace fcl

#include "fcl/narrowphase/detail/continuous_query_bodies.h"

#endif
