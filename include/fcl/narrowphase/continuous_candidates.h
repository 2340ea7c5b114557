// SPDX-License-Identifier: BSD-3-Clause
//
// The first half of a continuous query: the pairs of features that may touch, for callers
// who bring their own solver.
#ifndef FCL_NARROWPHASE_CONTINUOUS_CANDIDATES_H
#define FCL_NARROWPHASE_CONTINUOUS_CANDIDATES_H

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>

#include "fcl/geometry/collision_geometry.h"
#include "fcl/narrowphase/continuous_contact.h"
#include "fcl/narrowphase/detail/pose_numbers.h"
#include "fcl/narrowphase/detail/query_numbers.h"

namespace fcl {

/// @brief A VF or EE pair without a common vertex that may touch during t in [0, 1]; no
/// contact is decided yet. Kind, triangles and vertex ids are those that a
/// ContinuousContact of the pair has.
struct ContinuousCandidate {
  /// @brief kVertexFace or kEdgeEdge.
  ContinuousContactKind kind{ContinuousContactKind::kVertexFace};

  /// @brief Whether the vertex (VF) belongs to o1 and the face to o2, or the other way
  /// round. EE: edge a always belongs to o1.
  bool first_on_o1{true};

  /// @brief Vertex ids. VF: v, f0, f1, f2. EE: ea0, ea1, eb0, eb1.
  std::array<int, 4> vertices{{-1, -1, -1, -1}};

  /// @brief The triangle of o1 and of o2 that hold the features.
  std::intptr_t b1{-1};
  std::intptr_t b2{-1};

  /// @brief The features do not touch before window_lo nor after window_hi; 0 <=
  /// window_lo <= window_hi <= 1.
  double window_lo{0};
  double window_hi{1};
};

/// @brief Takes `count` >= 1 candidates, which are valid during the call only; returns
/// false to end the query. Runs in the thread and the floating-point mode of the query's
/// caller, and may run queries of its own. What it throws reaches the caller.
using ContinuousCandidateSink =
    std::function<bool(const ContinuousCandidate* candidates, std::size_t count)>;

/// @defgroup continuous_candidates Candidates of continuous collision queries
///
/// Hand out, in blocks, every feature pair that continuousSelfCollide() or
/// continuousCollide() with ContinuousQuery::kAll would give to its coplanarity filter:
/// the pairs that the moving boxes of nodes, triangles and features leave.
///
/// (1) Every pair that touches is among them (a pair that crosses at t = 0 and never
/// touches need not be). (2) No pair comes twice; faces with the same three vertices are
/// one face. (3) The order depends on the trees, and is the same in every call. (4)
/// vertexFace() and edgeEdge() on all of them give the contacts of the query, if they are
/// given its vertex paths: the transform of the vertex, each coordinate ((r0 x + r1 y) +
/// r2 z) + t in doubles.
///
/// Nothing is stored but one block. A rigid BVHModel that is no DeformableBVHModel keeps
/// no table of which triangle owns which feature, which (2) needs: it is made for each
/// call, in time and memory linear in the triangles.
///
/// Paths, models, and thread-safety are those of the @ref continuous_queries.
/// After Tang, Manocha, Tong 2010, section 4 and, for (2), Curtis, Tamstorf, Manocha
/// 2008.
///
/// @param sink  see ContinuousCandidateSink
/// @return true when all candidates were handed out, false when the sink ended the query.
/// @throws fcl::Exception as the queries for contacts do: an argument that is null (the
/// sink too), a geometry that is no triangle mesh, a rigid mesh that turns, a mesh that
/// is not built or is in the middle of an update, a coordinate that is not finite, a
/// triangle index out of range. A vertex that is not finite may be noticed after
/// candidates were handed out.
/// @{

/// @brief The candidates of a mesh with itself.
bool continuousSelfCandidates(const CollisionGeometry<double>* o,
                              const ContinuousCandidateSink& sink);
/// @overload
bool continuousSelfCandidates(const CollisionGeometry<float>* o,
                              const ContinuousCandidateSink& sink);

/// @brief The candidates of two meshes that go from one transform to another.
bool continuousCandidates(const CollisionGeometry<double>* o1,
                          const Transform3<double>& tf1_beg,
                          const Transform3<double>& tf1_end,
                          const CollisionGeometry<double>* o2,
                          const Transform3<double>& tf2_beg,
                          const Transform3<double>& tf2_end,
                          const ContinuousCandidateSink& sink);
/// @overload
bool continuousCandidates(const CollisionGeometry<float>* o1,
                          const Transform3<float>& tf1_beg,
                          const Transform3<float>& tf1_end,
                          const CollisionGeometry<float>* o2,
                          const Transform3<float>& tf2_beg,
                          const Transform3<float>& tf2_end,
                          const ContinuousCandidateSink& sink);
/// @}

inline bool continuousSelfCandidates(const CollisionGeometry<double>* o,
                                     const ContinuousCandidateSink& sink) {
  return detail::answerSelfCandidates(o, sink);
}

inline bool continuousSelfCandidates(const CollisionGeometry<float>* o,
                                     const ContinuousCandidateSink& sink) {
  return detail::answerSelfCandidates(o, sink);
}

inline bool continuousCandidates(const CollisionGeometry<double>* o1,
                                 const Transform3<double>& tf1_beg,
                                 const Transform3<double>& tf1_end,
                                 const CollisionGeometry<double>* o2,
                                 const Transform3<double>& tf2_beg,
                                 const Transform3<double>& tf2_end,
                                 const ContinuousCandidateSink& sink) {
  return detail::answerCandidates(detail::movingGeometry(o1, tf1_beg, tf1_end),
                                  detail::movingGeometry(o2, tf2_beg, tf2_end), sink);
}

inline bool continuousCandidates(const CollisionGeometry<float>* o1,
                                 const Transform3<float>& tf1_beg,
                                 const Transform3<float>& tf1_end,
                                 const CollisionGeometry<float>* o2,
                                 const Transform3<float>& tf2_beg,
                                 const Transform3<float>& tf2_end,
                                 const ContinuousCandidateSink& sink) {
  return detail::answerCandidates(detail::movingGeometry(o1, tf1_beg, tf1_end),
                                  detail::movingGeometry(o2, tf2_beg, tf2_end), sink);
}

}  // namespace fcl

#endif
