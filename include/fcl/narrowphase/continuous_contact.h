// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_NARROWPHASE_CONTINUOUS_CONTACT_H
#define FCL_NARROWPHASE_CONTINUOUS_CONTACT_H

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "fcl/ccd_version.h"
#include "fcl/geometry/collision_geometry.h"
#include "fcl/narrowphase/continuous_collision_request.h"
#include "fcl/narrowphase/continuous_collision_result.h"
#include "fcl/narrowphase/stage_counts.h"

namespace fcl {

/// @brief One contact between two features during t in [0, 1]; features are closed (a
/// triangle contains its border).
template <typename S>
struct ContinuousContact {
  ContinuousContactKind kind{ContinuousContactKind::kVertexFace};

  /// @brief The geometries; the same one twice in a self-collision.
  const CollisionGeometry<S>* o1{nullptr};
  const CollisionGeometry<S>* o2{nullptr};

  /// @brief The triangle of o1 and of o2 that hold the features, as in fcl::Contact.
  std::intptr_t b1{-1};
  std::intptr_t b2{-1};

  /// @brief Vertex ids. VF: v, f0, f1, f2. EE: ea0, ea1, eb0, eb1. Crossing: e0, e1, f0,
  /// f1, f2. Ids that a kind does not use are -1.
  std::array<int, 5> vertices{{-1, -1, -1, -1, -1}};

  /// @brief Whether the vertex (VF) or the edge (crossing) belongs to o1 and the face to
  /// o2, or the other way round. EE: edge a always belongs to o1.
  bool first_on_o1{true};

  /// @brief The first time at which the features touch lies in [toc_lo, toc_hi]; no
  /// wider than the request's toc_err (or a few units in the last place), and [0, 0] for
  /// a contact that is there at t = 0. Where a mesh turns: the features come within the
  /// tolerance of the query (continuous_collision.h) at toc_lo, and do not touch before;
  /// at toc_hi the two triangles provably cross, or toc_hi is toc_lo where no such time
  /// is found within toc_err, as when they only graze.
  double toc_lo{0};
  double toc_hi{0};

  /// @brief Where they touch at toc_lo, in the world frame (only with enable_contact).
  Vector3<S> pos{Vector3<S>::Zero()};

  /// @brief Unit normal of the face (VF, crossing) or common normal of the edges (EE) at
  /// toc_lo, in the world frame (only with enable_contact). Sign: it points from o1 to
  /// o2, that is, o2's point moves against it relative to o1's; where the relative
  /// velocity along it is zero, it points to the side on which o2's feature is at t = 0,
  /// and where that is zero too, along the winding (VF) or edge a x edge b (EE). In a
  /// self-collision "o1" is the vertex (VF) or edge a (EE). A crossing's is along the
  /// winding. Zero vector where the face has no area or the edges are parallel at that
  /// time.
  Vector3<S> normal{Vector3<S>::Zero()};

  /// @brief Number of entries of `vertices` in use.
  int numVertices() const { return kind == ContinuousContactKind::kCrossing ? 5 : 4; }
};

using ContinuousContactf = ContinuousContact<float>;
using ContinuousContactd = ContinuousContact<double>;

/// @brief A continuous request that asks for contacts. Of the fields of FCL's request
/// toc_err acts, the width of a contact's time bracket.
template <typename S>
struct ContinuousContactRequest : ContinuousCollisionRequest<S> {
  using ContinuousCollisionRequest<S>::ContinuousCollisionRequest;

  ContinuousQuery query{ContinuousQuery::kAll};

  /// @brief The earliest so many contacts are kept; ContinuousContactResult::contacts_cut
  /// tells whether there were more. Must be at least 1.
  std::size_t num_max_contacts{std::numeric_limits<std::size_t>::max()};

  /// @brief Whether position and normal of each contact are computed.
  bool enable_contact{true};

  /// @brief Threads that the query may use: 1, the caller's own and no task (the default,
  /// as in FCL, whose callers run their own queries side by side); n, at most n; 0, as
  /// many as the oneTBB task arena around has; not negative. Meshes of which one turns
  /// are tested by one thread. The answer does not depend on it; how much was pruned
  /// before a first contact was found, which StageCounts tell, does.
  int num_threads{1};
};

using ContinuousContactRequestf = ContinuousContactRequest<float>;
using ContinuousContactRequestd = ContinuousContactRequest<double>;

/// @brief What a query for contacts adds to FCL's result.
template <typename S>
struct ContinuousContacts {
  /// @brief The VF and EE contacts, sorted by (toc_lo, kind, vertex ids). With
  /// ContinuousQuery::kFirst those that may be the first: whose bracket begins no later
  /// than the earliest one ends (of a rigid mesh's, which may be met several times with
  /// different brackets, than the shortest of those); with kAny at most one.
  std::vector<ContinuousContact<S>> contacts;

  /// @brief Whether contacts were dropped because of num_max_contacts.
  bool contacts_cut{false};

  /// @brief Whether an edge already passes through a triangle at t = 0, decided exactly.
  /// Such surfaces may have no VF or EE contact at all. With ContinuousQuery::kAny not
  /// decided once a contact is found.
  bool initially_crossing{false};

  /// @brief The edge and face that cross at t = 0, if initially_crossing.
  ContinuousContact<S> crossing;

  StageCounts counts;
  StageTimes times;
};

/// @brief FCL's continuous result (is_collide, time_of_contact, contact_tf1, contact_tf2)
/// with every contact. time_of_contact is never later than the true first time: toc_lo of
/// the earliest contact (rounded down when S is float), 0 when the surfaces cross at
/// t = 0, and 1 without collision. contact_tf1 and contact_tf2 are the poses at toc_hi of
/// that contact; see @ref continuous_queries.
template <typename S>
struct ContinuousContactResult : ContinuousCollisionResult<S>, ContinuousContacts<S> {};

using ContinuousContactResultf = ContinuousContactResult<float>;
using ContinuousContactResultd = ContinuousContactResult<double>;

}  // namespace fcl

#endif
