// SPDX-License-Identifier: BSD-3-Clause
//
// The first half of a continuous query: the pairs of features that may touch, for callers
// with their own solver.
#ifndef FCL_NARROWPHASE_CONTINUOUS_CANDIDATES_H
#define FCL_NARROWPHASE_CONTINUOUS_CANDIDATES_H

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>

#include "fcl/geometry/collision_geometry.h"
#include "fcl/narrowphase/continuous_collision.h"
#include "fcl/narrowphase/continuous_contact.h"
#include "fcl/narrowphase/detail/query_numbers.h"

namespace fcl {

/// @brief A VF or EE pair without a common vertex that may touch during t in [0, 1]. It
/// is not tested yet. Kind, triangles and vertex ids are as in a ContinuousContact.
struct ContinuousCandidate {
  /// @brief kVertexFace or kEdgeEdge. With min_distance also kVertexEdge, of a free point
  /// and a free edge, and kVertexVertex, of two free points.
  ContinuousContactKind kind{ContinuousContactKind::kVertexFace};

  /// @brief True: the vertex (VF) belongs to o1, the face to o2. False: the reverse. EE:
  /// edge a always belongs to o1.
  bool first_on_o1{true};

  /// @brief Vertex ids. VF: v, f0, f1, f2. EE: ea0, ea1, eb0, eb1. VE: v, e0, e1. VV: v
  /// of o1, v of o2. Unused entries are -1.
  std::array<int, 4> vertices{{-1, -1, -1, -1}};

  /// @brief Numbers of the triangles of o1 and of o2 that have the features.
  std::intptr_t b1{-1};
  std::intptr_t b2{-1};

  /// @brief The features do not touch before window_lo or after window_hi, in fractions
  /// of the step; 0 <= window_lo <= window_hi <= 1.
  double window_lo{0};
  double window_hi{1};
};

/// @brief A function of the caller that takes `count` >= 1 candidates. They are valid
/// during the call only. It returns true to continue and false to end the query. It runs
/// in the thread and the floating-point mode of the query's caller, and may run queries.
/// An exception from it reaches the caller.
using ContinuousCandidateSink =
    std::function<bool(const ContinuousCandidate* candidates, std::size_t count)>;

/// @defgroup continuous_candidates Candidates of continuous collision queries
///
/// They hand out, in blocks, every feature pair that culling leaves: pairs whose moving
/// boxes overlap, without some that a plane keeps apart during the whole step. On
/// straight paths continuousSelfCollide() and continuousCollide() with
/// ContinuousQuery::kAll give the same pairs to their coplanarity filter.
///
/// (1) Every pair that touches is among them. (A pair that crosses at t = 0 and never
/// touches may be missing.) (2) No pair is handed out twice. Faces with the same three
/// vertices are one face. (3) The order depends on the trees and is the same in every
/// call. (4) On straight paths vertexFace() and edgeEdge() on all pairs give the contacts
/// of the query if they get the same vertex paths. A posed coordinate is ((r0 x + r1 y) +
/// r2 z) + t, computed in doubles.
///
/// Memory: one block; all candidates if a mesh turns. A rigid BVHModel that is not a
/// DeformableBVHModel has no table of feature owners, which (2) needs. On straight paths
/// the table is made in each call, in time and memory linear in the triangles.
///
/// Paths, models and thread-safety are those of the @ref continuous_queries. Between two
/// transforms a rigid mesh turns about its origin, as with CCDM_LINEAR. The query runs in
/// the caller's thread.
/// After Tang, Manocha, Tong 2010, section 4 and, for (2), Curtis, Tamstorf, Manocha
/// 2008.
///
/// With min_distance = d > 0 the candidates are the pairs whose distance may fall to d
/// during the step, and (1) becomes: every pair that comes within d is among them. If
/// both frames are equal (updateFrames(x, x)), these are the pairs that may be within d.
/// The distance of features that share a vertex is 0: they are no candidates.
///
/// @param sink  takes the candidates, see ContinuousCandidateSink
/// @param min_distance  d, not negative, finite, in the unit of the coordinates
/// @return true when all candidates were handed out, false when the sink ended the query
/// @throws fcl::Exception when an argument or the sink is null, min_distance is negative
/// or not finite, a geometry is not a triangle mesh, a motion class is neither FCL's nor
/// a BoundedMotion, a mesh is not built or is in the middle of an update, a coordinate or
/// a transform is not finite, or a triangle index is out of range.
/// The exception of a vertex that is not finite may come after candidates were handed
/// out.
/// @{

/// @brief The candidates of a mesh with itself.
bool continuousSelfCandidates(const CollisionGeometry<double>* o,
                              const ContinuousCandidateSink& sink,
                              double min_distance = 0);
/// @overload
bool continuousSelfCandidates(const CollisionGeometry<float>* o,
                              const ContinuousCandidateSink& sink,
                              double min_distance = 0);

/// @brief The candidates of two meshes that go from one transform to another.
bool continuousCandidates(const CollisionGeometry<double>* o1,
                          const Transform3<double>& tf1_beg,
                          const Transform3<double>& tf1_end,
                          const CollisionGeometry<double>* o2,
                          const Transform3<double>& tf2_beg,
                          const Transform3<double>& tf2_end,
                          const ContinuousCandidateSink& sink, double min_distance = 0);
/// @overload
bool continuousCandidates(const CollisionGeometry<float>* o1,
                          const Transform3<float>& tf1_beg,
                          const Transform3<float>& tf1_end,
                          const CollisionGeometry<float>* o2,
                          const Transform3<float>& tf2_beg,
                          const Transform3<float>& tf2_end,
                          const ContinuousCandidateSink& sink, double min_distance = 0);

/// @brief The candidates of two meshes that follow FCL's motions or a BoundedMotion.
bool continuousCandidates(const CollisionGeometry<double>* o1,
                          const MotionBase<double>* motion1,
                          const CollisionGeometry<double>* o2,
                          const MotionBase<double>* motion2,
                          const ContinuousCandidateSink& sink, double min_distance = 0);
/// @overload
/// It is a template, so that only a program that calls it compiles FCL's motions in
/// float.
template <typename = void>
bool continuousCandidates(const CollisionGeometry<float>* o1,
                          const MotionBase<float>* motion1,
                          const CollisionGeometry<float>* o2,
                          const MotionBase<float>* motion2,
                          const ContinuousCandidateSink& sink, double min_distance = 0);
/// @}

inline bool continuousSelfCandidates(const CollisionGeometry<double>* o,
                                     const ContinuousCandidateSink& sink,
                                     double min_distance) {
  return detail::answerSelfCandidates(o, sink, min_distance);
}

inline bool continuousSelfCandidates(const CollisionGeometry<float>* o,
                                     const ContinuousCandidateSink& sink,
                                     double min_distance) {
  return detail::answerSelfCandidates(o, sink, min_distance);
}

inline bool continuousCandidates(
    const CollisionGeometry<double>* o1, const Transform3<double>& tf1_beg,
    const Transform3<double>& tf1_end, const CollisionGeometry<double>* o2,
    const Transform3<double>& tf2_beg, const Transform3<double>& tf2_end,
    const ContinuousCandidateSink& sink, double min_distance) {
  return detail::answerCandidates(detail::movingGeometry(o1, tf1_beg, tf1_end),
                                  detail::movingGeometry(o2, tf2_beg, tf2_end), sink,
                                  min_distance);
}

inline bool continuousCandidates(
    const CollisionGeometry<float>* o1, const Transform3<float>& tf1_beg,
    const Transform3<float>& tf1_end, const CollisionGeometry<float>* o2,
    const Transform3<float>& tf2_beg, const Transform3<float>& tf2_end,
    const ContinuousCandidateSink& sink, double min_distance) {
  return detail::answerCandidates(detail::movingGeometry(o1, tf1_beg, tf1_end),
                                  detail::movingGeometry(o2, tf2_beg, tf2_end), sink,
                                  min_distance);
}

namespace detail {

template <typename S>
bool motionCandidates(const CollisionGeometry<S>* o1, const MotionBase<S>* motion1,
                      const CollisionGeometry<S>* o2, const MotionBase<S>* motion2,
                      const ContinuousCandidateSink& sink, double min_distance) {
  detail::requireNotNull(o1, "o1");
  detail::requireNotNull(o2, "o2");
  detail::requireNotNull(motion1, "motion1");
  detail::requireNotNull(motion2, "motion2");
  return detail::answerCandidates(detail::movingGeometry(o1, motion1, o2),
                                  detail::movingGeometry(o2, motion2, o1), sink,
                                  min_distance);
}

}  // namespace detail

inline bool continuousCandidates(const CollisionGeometry<double>* o1,
                                 const MotionBase<double>* motion1,
                                 const CollisionGeometry<double>* o2,
                                 const MotionBase<double>* motion2,
                                 const ContinuousCandidateSink& sink,
                                 double min_distance) {
  return detail::motionCandidates(o1, motion1, o2, motion2, sink, min_distance);
}

template <typename>
bool continuousCandidates(const CollisionGeometry<float>* o1,
                          const MotionBase<float>* motion1,
                          const CollisionGeometry<float>* o2,
                          const MotionBase<float>* motion2,
                          const ContinuousCandidateSink& sink, double min_distance) {
  return detail::motionCandidates(o1, motion1, o2, motion2, sink, min_distance);
}

}  // namespace fcl

#endif
