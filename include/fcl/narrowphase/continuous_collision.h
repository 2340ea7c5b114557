// SPDX-License-Identifier: BSD-3-Clause
//
// This header stands before FCL's header of the same name on the include path. It
// includes FCL's header and adds non-template overloads of its functions. Overload
// resolution prefers them, so that programs, and FCL's own templates, that call
// continuousCollide(...) reach them. continuousCollide<double>(...) still calls FCL's
// implementation.
#ifndef FCL_NARROWPHASE_CONTINUOUS_COLLISION_OVERLAY_H
#define FCL_NARROWPHASE_CONTINUOUS_COLLISION_OVERLAY_H

#include <type_traits>

#include "fcl/ccd_version.h"
#include "fcl/narrowphase/continuous_contact.h"
#include "fcl/narrowphase/detail/stock_headers.h"

namespace fcl {

/// @defgroup continuous_queries Continuous collision queries
///
/// Which pairs are answered here, whatever request.ccd_solver_type says: triangle meshes
/// of any BV type, rigid or deforming (a DeformableBVHModel, or a BVHModel in FCL's
/// updated state), FCL's ten shapes, and octrees, against each other. A
/// DeformableBVHModel whose frames are equal is a rigid mesh. A mesh is a surface. Shapes
/// are solid, except TriangleP and Plane, which are surfaces (a Plane has no end). In an
/// octree the cells that FCL calls occupied are solid: leaves that reach its threshold
/// (OcTree::isNodeOccupied()), below nodes that reach it too. Other cells are no
/// obstacles, and neither is an object beside an octree whose
/// CollisionGeometry::isOccupied() is false. The query reads octomap's nodes in place,
/// and only those near the other object. A CompoundGeometry of rigid meshes, shapes and
/// octrees is answered against all of these: as its parts are.
///
/// Which pairs FCL answers: point clouds, geometries of the program, and a rigid mesh, a
/// shape or an octree that follows a motion class of the program that is no
/// BoundedMotion. FCL takes a mesh as it is in its current frame and ignores the
/// deformation. It samples the motion and may miss a contact. There are no contacts. A
/// compound, which FCL does not know, is refused there. The way out: derive the motion
/// class from BoundedMotion too. doc/choosing.md has the limits.
///
/// Rotations: the matrix of a shape, an octree or a mesh that turns is taken as it is if
/// no entry of |R R' - I| is above 2^-10 (typed with four digits). Up to 2^-6 (.71 for
/// .7071) the nearest rotation is taken in its place, and contact_tf1 and contact_tf2
/// have it. Beyond, and if it mirrors, the query throws. A mesh whose matrix does not
/// change may be scaled, mirrored or sheared (doc/errors.md).
///
/// t runs from 0 (the beginning of the step) to 1 (its end). A path is defined by the
/// given doubles, evaluated without rounding. A contact of two meshes is a VF or EE pair
/// of closed features without a common vertex that touch at some t in [0, 1].
/// - Straight paths: meshes whose rotation is constant (up to a few roundings). Also
///   meshes that deform between two transforms with CCDM_TRANS or CCDM_SPLINE, or by a
///   motion class of the program that is no BoundedMotion (its poses at t = 0 and t = 1
///   are used). A vertex goes from tf_beg * (previous frame) to tf_end * (current frame).
///   If two meshes go straight the answer is exact.
/// - Turning: a rigid mesh, a shape or an octree whose end transforms have different
///   rotations. With CCDM_LINEAR and CCDM_TRANS it turns at constant speed about the
///   origin of its frame, which goes straight. (With CCDM_TRANS FCL ignores the rotation
///   without a message.) With CCDM_SCREW it turns about the axis of a screw. CCDM_SPLINE
///   is not defined between two transforms, and throws if such an object turns.
/// - A mesh that deforms in a frame that turns: with CCDM_LINEAR, CCDM_SCREW, or a motion
///   object that turns. The path is motion(t) * ((1 - t) previous + t current).
/// - FCL's motion objects: TranslationMotion; InterpMotion between the transforms that it
///   was made from, about its reference point; ScrewMotion between its transforms;
///   SplineMotion by its control points.
/// - Motion classes of the program that are a BoundedMotion.
///
/// If a mesh turns or follows a spline, or with a shape or an octree, contact means to
/// come within a tolerance tau of touching. tau is some hundred units in the last place
/// of the coordinates, relative to the middle between both objects (doc/numerics.md). No
/// contact is missed and no time is late. Surfaces within tau at t = 0 give the time 0. A
/// pair that slides for more than 10,000 steps without a proof is reported from then on:
/// early, never late.
///
/// request.ccd_solver_type and num_max_iterations have no effect on pairs that are
/// answered here.
///
/// request.toc_err is the largest width of the time bracket of a contact, in fractions of
/// the step. 0: as narrow as doubles allow.
///
/// Result: time_of_contact is the lower end of the first contact's bracket. At the poses
/// contact_tf1 and contact_tf2 collide() finds contacts, unless objects hardly overlap:
/// for two meshes at its upper end; with a shape or an octree at min(1, time_of_contact +
/// toc_err), or where they overlap most up to then; at t = 0 if they overlap well there.
/// Without collision they are those at t = 1 (doc/differences.md, poses of contact).
///
/// Models are not changed. The same call gives the same answer.
///
/// Thread-safety: concurrent calls on the same models, shapes and octrees are safe, also
/// where FCL answers (FCL gets a copy of a model that it would write to). Concurrent
/// calls on the same motion objects are safe where this library answers. Do not share a
/// motion object between concurrent calls if FCL answers, or if it is of a class of the
/// program: reading its pose changes it.
///
/// @throws fcl::Exception  The text names the object (o1, o2, or o of a self-collision)
/// or the field of the request.
/// - For all pairs: an object or its motion is null. Of meshes, shapes and octrees: a
///   transform is not finite.
/// - For pairs that are answered here, meshes: the mesh is not built, is in the middle of
///   an update, has more than 2^29 triangles or vertices, has a coordinate that is not
///   finite or a triangle index out of range. A coordinate of a rigid mesh is checked
///   where boxes overlap. So a bad coordinate that cannot change the answer may stay
///   unnoticed; of all contacts without a limit, for any number of threads alike.
/// - Shapes and octrees: a size of the shape is negative or not finite; the resolution of
///   the octree is not positive or not finite.
/// - Motions: a matrix is further from a rotation than 2^-6; the reference point of an
///   InterpMotion is not finite, or so large that its rounding exceeds toc_err;
///   coordinates are out of range (doc/errors.md).
/// - The request: toc_err is negative or NaN, num_max_contacts is 0, num_threads is
///   negative, t_max is not in [0, 1]; min_distance is negative or not finite.
/// - FCL checks nothing in what it answers.
/// @return the time of contact, never later than the true one; 0 when the surfaces cross
/// at t = 0; 1 without collision
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
/// request.ccd_motion_type chooses the path of a mesh that turns. In float FCL has no
/// query between transforms: a pair that FCL answers throws fcl::Exception. Give it
/// TranslationMotion or SplineMotion objects.
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

/// @brief The first contact of a mesh with itself. It needs no pose.
double continuousSelfCollide(const CollisionGeometry<double>* o,
                             const ContinuousCollisionRequest<double>& request,
                             ContinuousCollisionResult<double>& result);
/// @overload
float continuousSelfCollide(const CollisionGeometry<float>* o,
                            const ContinuousCollisionRequest<float>& request,
                            ContinuousCollisionResult<float>& result);

/// @name With contacts
/// Only pairs that are answered here have contacts. For a pair that FCL answers
/// these throw fcl::Exception. The text names the object, its kind and the way out.
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

/// @brief The contacts of a mesh with itself. It needs no pose: positions and normals
/// are in the coordinates of the mesh.
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

/// Matches a request and a result if one of the two is for contacts and the other is not.
template <typename S, typename Request, typename Result>
using IfMixed = typename std::enable_if<
    std::is_base_of<ContinuousCollisionRequest<S>, Request>::value &&
    std::is_base_of<ContinuousCollisionResult<S>, Result>::value &&
    std::is_base_of<ContinuousContactRequest<S>, Request>::value !=
        std::is_base_of<ContinuousContactResult<S>, Result>::value>::type;

/// `Transform3<S>` where another argument determines S, so that arguments of other types
/// convert to it.
template <typename S>
using ConvertedTransform3 = typename std::common_type<Transform3<S>>::type;

}  // namespace detail

// FCL's request and result are not polymorphic. A request for contacts with a plain
// result, or the reverse, would lose the contacts without a message. So it does not
// compile.
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

#elif !defined(FCL_CONTINUOUS_COLLISION_H)
// Two folders on the include path have this header: pass on to the next one.
#include_next <fcl/narrowphase/continuous_collision.h>
#endif
