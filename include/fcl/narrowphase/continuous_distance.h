// SPDX-License-Identifier: BSD-3-Clause
//
// How near two objects come to each other during the step, and when.
#ifndef FCL_NARROWPHASE_CONTINUOUS_DISTANCE_H
#define FCL_NARROWPHASE_CONTINUOUS_DISTANCE_H

#include <cstdint>
#include <functional>
#include <limits>

#include "fcl/narrowphase/continuous_collision.h"
#include "fcl/narrowphase/detail/query_numbers.h"

namespace fcl {

/// @brief What is asked about the least distance of two objects.
template <typename S>
struct ContinuousDistanceRequest {
  /// @brief The bracket of the distance is not wider than the larger one of abs_err, in
  /// the unit of the coordinates, and of rel_err times distance_hi. Not negative, finite.
  /// It is never narrower than rounding allows, some thousand units in the last place of
  /// the coordinates: with 0 and 0 it is that.
  S abs_err{0};
  S rel_err{S(1e-3)};

  /// @brief Only the part of the step until this time counts, in [0, 1].
  S t_max{1};

  /// @brief Larger distances are of no interest: the query ends when it is proved that
  /// the objects stay further apart than this, and is_cut_off says so. Above 0; infinite:
  /// the distance is wanted, however large.
  S max_distance{std::numeric_limits<S>::infinity()};

  /// @brief The path between two transforms, as in FCL's request: CCDM_SCREW turns about
  /// the axis of a screw; with CCDM_TRANS and CCDM_LINEAR the origin goes straight.
  CCDMotionType ccd_motion_type{CCDM_TRANS};

  /// @brief If the objects touch: the largest width of the bracket of the time of
  /// contact.
  S toc_err{S(1e-4)};

  /// @brief Which objects and triangles count, as in ContinuousContactRequest.
  ContinuousFilter filter1;
  ContinuousFilter filter2;
  std::function<bool(std::intptr_t b1, std::intptr_t b2)> accepts_triangles;

  /// @brief The number of threads of the trees that the query makes, and of the query for
  /// a contact, as in ContinuousContactRequest. The search for the distance takes one.
  int num_threads{1};
};

using ContinuousDistanceRequestf = ContinuousDistanceRequest<float>;
using ContinuousDistanceRequestd = ContinuousDistanceRequest<double>;

/// @brief The least distance of two objects during the step.
template <typename S>
// clang-tidy 14 names a variable of the copy that the compiler writes for an array.
// NOLINTNEXTLINE(bugprone-reserved-identifier)
struct ContinuousDistanceResult {
  /// @brief During the step the objects are never nearer than distance_lo. At `time` they
  /// are not further apart than distance_hi. Both are 0 if they touch. Both are infinite
  /// if no pair counts: all are filtered out, or an octree has no occupied cell. (If
  /// groups or a function reject all triangles and max_distance is finite, that may be
  /// the same as if the query was cut off.)
  S distance_lo{0};
  S distance_hi{0};

  /// @brief When they are distance_hi apart; the first time of contact if they touch.
  S time{0};

  /// @brief The nearest points of o1 and o2 at this time, in the world frame. If the
  /// objects touch, both are the position of the first contact.
  Vector3<S> nearest_points[2]{Vector3<S>::Zero(), Vector3<S>::Zero()};

  /// @brief The triangles that have these points, numbered as in ContinuousContact. -1
  /// for a shape; for an octree the number of the cell.
  std::intptr_t b1{-1};
  std::intptr_t b2{-1};

  /// @brief The numbers of the parts of compounds that have these points, as in
  /// ContinuousContact; b1 and b2 are then of these parts.
  int part1{-1};
  int part2{-1};

  /// @brief Whether the objects touch during the step, as continuousCollide() decides it.
  bool is_collide{false};

  /// @brief Whether the query ended since the objects stay further apart than
  /// max_distance. Then distance_lo is max_distance. distance_hi is a distance that was
  /// met, or infinite if none was computed; its time and points belong to it.
  bool is_cut_off{false};
};

using ContinuousDistanceResultf = ContinuousDistanceResult<float>;
using ContinuousDistanceResultd = ContinuousDistanceResult<double>;

namespace detail {

/// @brief The request for the first contact that the request of a distance implies.
template <typename S>
ContinuousContactRequest<S> contactRequestOf(
    const ContinuousDistanceRequest<S>& request) {
  ContinuousContactRequest<S> out;
  out.query = ContinuousQuery::kFirst;
  out.num_max_contacts = 1;
  out.toc_err = request.toc_err;
  out.t_max = request.t_max;
  out.ccd_motion_type = request.ccd_motion_type;
  out.filter1 = request.filter1;
  out.filter2 = request.filter2;
  out.accepts_triangles = request.accepts_triangles;
  out.num_threads = request.num_threads;
  return out;
}

/// @throws fcl::Exception  a field has no valid value
template <typename S>
FCL_EXPORT void requireValid(const ContinuousDistanceRequest<S>& request);

template <typename S>
FCL_EXPORT void answerDistance(const MovingGeometry<S>& o1, const MovingGeometry<S>& o2,
                               const ContinuousDistanceRequest<S>& request,
                               ContinuousDistanceResult<S>& result);

template <typename S>
S distanceOfMotions(const CollisionGeometry<S>* o1, const MotionBase<S>* motion1,
                    const CollisionGeometry<S>* o2, const MotionBase<S>* motion2,
                    const ContinuousDistanceRequest<S>& request,
                    ContinuousDistanceResult<S>& result) {
  detail::requireNotNull(o1, "o1");
  detail::requireNotNull(o2, "o2");
  detail::requireNotNull(motion1, "motion1");
  detail::requireNotNull(motion2, "motion2");
  detail::answerDistance(detail::movingGeometry(o1, motion1, o2),
                         detail::movingGeometry(o2, motion2, o1), request, result);
  return result.distance_lo;
}

template <typename S>
S distanceOfTransforms(const CollisionGeometry<S>* o1, const Transform3<S>& tf1_beg,
                       const Transform3<S>& tf1_end, const CollisionGeometry<S>* o2,
                       const Transform3<S>& tf2_beg, const Transform3<S>& tf2_end,
                       const ContinuousDistanceRequest<S>& request,
                       ContinuousDistanceResult<S>& result) {
  detail::requireNotNull(o1, "o1");
  detail::requireNotNull(o2, "o2");
  const PathKind path = detail::pathOf(request.ccd_motion_type);
  detail::answerDistance(detail::movingGeometry(o1, tf1_beg, tf1_end, path),
                         detail::movingGeometry(o2, tf2_beg, tf2_end, path), request,
                         result);
  return result.distance_lo;
}

template <typename S>
S distanceOfObjects(const CollisionObject<S>* o1, const Transform3<S>& tf1_end,
                    const CollisionObject<S>* o2, const Transform3<S>& tf2_end,
                    const ContinuousDistanceRequest<S>& request,
                    ContinuousDistanceResult<S>& result) {
  detail::requireNotNull(o1, "o1");
  detail::requireNotNull(o2, "o2");
  return detail::distanceOfTransforms<S>(
      o1->collisionGeometry().get(), detail::toTransform(detail::transformOf(*o1)),
      tf1_end, o2->collisionGeometry().get(),
      detail::toTransform(detail::transformOf(*o2)), tf2_end, request, result);
}

}  // namespace detail

/// @defgroup continuous_distance Least distance during the step
///
/// The least distance of two objects during the step, proved from both sides: they are
/// never nearer than distance_lo, and at `time` not further apart than distance_hi. Where
/// continuousCollide() says that objects do not touch, this says how near they come.
///
/// Objects, paths and thread-safety are as in @ref continuous_queries . Meshes may rest,
/// move, turn or deform, and have free edges and points. A mesh is a surface: the
/// distance of a body inside of a closed mesh is that from its surface. Shapes and cells
/// of octrees are solid. Two free points, or a free point and a free edge, have a
/// distance too; that they meet is no contact.
///
/// Rounding is that of a query for curved paths, also where all paths are straight: some
/// thousand units in the last place of the coordinates. If the distance is no more, the
/// query asks continuousCollide() whether the objects touch. So is_collide is its answer;
/// on straight paths it is exact. If they do not touch, distance_lo may be 0 all the
/// same.
///
/// A bracket is wider than the tolerance if a pair takes more than 10,000 steps, as
/// surfaces may that slide along each other at a tiny distance; if matrices are rotations
/// up to 2^-10 only; or in float, if an object goes further than the tolerance between
/// two times that are floats. distance_lo and distance_hi are right all the same.
///
/// @throws fcl::Exception  as continuousCollide(), where FCL would answer the pair, and:
/// both objects are planes or halfspaces; abs_err, rel_err or max_distance is negative or
/// NaN, or abs_err or rel_err is not finite; max_distance is 0; coordinates are beyond
/// 2^160, also those of two shapes (of a rigid mesh 2^150, of one that deforms 2^127).
/// @return distance_lo
/// @{

/// @brief The least distance of two geometries that follow motions.
inline double continuousDistance(const CollisionGeometry<double>* o1,
                                 const MotionBase<double>* motion1,
                                 const CollisionGeometry<double>* o2,
                                 const MotionBase<double>* motion2,
                                 const ContinuousDistanceRequest<double>& request,
                                 ContinuousDistanceResult<double>& result) {
  return detail::distanceOfMotions(o1, motion1, o2, motion2, request, result);
}
/// @overload
/// It is a template, so that only a program that calls it compiles FCL's motions in
/// float.
template <typename = void>
float continuousDistance(const CollisionGeometry<float>* o1,
                         const MotionBase<float>* motion1,
                         const CollisionGeometry<float>* o2,
                         const MotionBase<float>* motion2,
                         const ContinuousDistanceRequest<float>& request,
                         ContinuousDistanceResult<float>& result) {
  return detail::distanceOfMotions(o1, motion1, o2, motion2, request, result);
}

/// @brief The least distance of two geometries that go from one transform to another.
inline double continuousDistance(const CollisionGeometry<double>* o1,
                                 const Transform3<double>& tf1_beg,
                                 const Transform3<double>& tf1_end,
                                 const CollisionGeometry<double>* o2,
                                 const Transform3<double>& tf2_beg,
                                 const Transform3<double>& tf2_end,
                                 const ContinuousDistanceRequest<double>& request,
                                 ContinuousDistanceResult<double>& result) {
  return detail::distanceOfTransforms(o1, tf1_beg, tf1_end, o2, tf2_beg, tf2_end, request,
                                      result);
}
/// @overload
inline float continuousDistance(const CollisionGeometry<float>* o1,
                                const Transform3<float>& tf1_beg,
                                const Transform3<float>& tf1_end,
                                const CollisionGeometry<float>* o2,
                                const Transform3<float>& tf2_beg,
                                const Transform3<float>& tf2_end,
                                const ContinuousDistanceRequest<float>& request,
                                ContinuousDistanceResult<float>& result) {
  return detail::distanceOfTransforms(o1, tf1_beg, tf1_end, o2, tf2_beg, tf2_end, request,
                                      result);
}

/// @brief The least distance of two objects that go from their transform to another.
inline double continuousDistance(const CollisionObject<double>* o1,
                                 const Transform3<double>& tf1_end,
                                 const CollisionObject<double>* o2,
                                 const Transform3<double>& tf2_end,
                                 const ContinuousDistanceRequest<double>& request,
                                 ContinuousDistanceResult<double>& result) {
  return detail::distanceOfObjects(o1, tf1_end, o2, tf2_end, request, result);
}
/// @overload
inline float continuousDistance(const CollisionObject<float>* o1,
                                const Transform3<float>& tf1_end,
                                const CollisionObject<float>* o2,
                                const Transform3<float>& tf2_end,
                                const ContinuousDistanceRequest<float>& request,
                                ContinuousDistanceResult<float>& result) {
  return detail::distanceOfObjects(o1, tf1_end, o2, tf2_end, request, result);
}
/// @}

}  // namespace fcl

#endif
