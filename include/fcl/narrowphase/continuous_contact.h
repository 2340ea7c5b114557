// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_NARROWPHASE_CONTINUOUS_CONTACT_H
#define FCL_NARROWPHASE_CONTINUOUS_CONTACT_H

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "fcl/ccd_version.h"
#include "fcl/common/exception.h"
#include "fcl/geometry/collision_geometry.h"
#include "fcl/narrowphase/continuous_collision_request.h"
#include "fcl/narrowphase/continuous_collision_result.h"
#include "fcl/narrowphase/stage_counts.h"

namespace fcl {

/// @brief One contact of two meshes, or of a mesh, a shape or an octree with another one,
/// during t in [0, 1]. Features of meshes are closed: a triangle contains its border, an
/// edge its ends.
template <typename S>
struct ContinuousContact {
  ContinuousContactKind kind{ContinuousContactKind::kVertexFace};

  /// @brief The two geometries. In a self-collision both are the same.
  const CollisionGeometry<S>* o1{nullptr};
  const CollisionGeometry<S>* o2{nullptr};

  /// @brief Numbers of the triangles of o1 and of o2 that have the features, as in
  /// fcl::Contact. Free edges and free points of a DeformableBVHModel are numbered after
  /// its triangles: DeformableBVHModel::primitive() tells which it is. -1 for a shape.
  /// For an octree the number of the cell: octreeCell() (octree_cell.h) gives its center,
  /// size and key.
  std::intptr_t b1{-1};
  std::intptr_t b2{-1};

  /// @brief The numbers of the parts of two compounds (CompoundGeometry) that are in
  /// contact. o1, o2, b1 and b2 are then of these parts. -1 where the object is no
  /// compound.
  int part1{-1};
  int part2{-1};

  /// @brief Vertex ids. VF: v, f0, f1, f2. EE: ea0, ea1, eb0, eb1. Crossing: e0, e1, f0,
  /// f1, f2. VE: v, e0, e1. VV: v of o1, v of o2; in a self-collision the lower id first.
  /// With a shape or a cell: the ids of the vertex, edge or face of the mesh that is
  /// nearest to it at toc_lo. Unused entries are -1.
  std::array<int, 5> vertices{{-1, -1, -1, -1, -1}};

  /// @brief True: the vertex (VF) or the edge (crossing) belongs to o1, the face to o2;
  /// the vertex (VE) to o1, the edge to o2. False: the reverse. EE: edge a always belongs
  /// to o1. With a shape or an octree: whether the mesh is o1.
  bool first_on_o1{true};

  /// @brief Whether the contact is only proved up to the query's tolerance. Contacts of
  /// two meshes on straight paths are exact, and this is false. If a mesh turns, or with
  /// a shape or an octree, true says: the features are within the tolerance of each other
  /// at toc_lo, and it is not proved that the surfaces cross in the bracket. With
  /// min_distance, true says: no time was found in the bracket at which the features
  /// provably are within that distance.
  bool within_tolerance{false};

  /// @brief Bracket of the time of contact, in fractions of the step. The first time at
  /// which the features touch lies in [toc_lo, toc_hi]. Its width is at most the
  /// request's toc_err, or a few units in the last place if toc_err is smaller. It is [0,
  /// 0] if the features touch at t = 0. On straight paths, with ContinuousQuery::kFirst
  /// and kAny, it is also no wider than an eighth of toc_hi. So toc_lo is 0 only for
  /// features that touch at t = 0. (Times below 2^-1022, where doubles lose digits, may
  /// have the bracket [0, 2^-1022 / 8].) With kAll this holds for the time_of_contact of
  /// the result; the brackets in the list may begin before it.
  ///
  /// If a mesh turns, or with a shape or an octree: the features do not touch before
  /// toc_lo, and are within the query's tolerance of each other then
  /// (continuous_collision.h). At toc_hi the two triangles provably cross. If no such
  /// time is found within toc_err and until t_max (they may only graze), toc_hi equals
  /// toc_lo.
  double toc_lo{0};
  double toc_hi{0};

  /// @brief The point where the two touch at toc_lo, in the world frame and the unit of
  /// the coordinates. With min_distance: the middle between their nearest points. With a
  /// shape or an octree that overlaps the other object at t = 0: a point of both. Of two
  /// planes or halfspaces: on the plane of o1, at the foot of the perpendicular from the
  /// origin of the world; if they are not parallel they need not meet there. Set only
  /// with enable_contact.
  Vector3<S> pos{Vector3<S>::Zero()};

  /// @brief Unit normal at toc_lo in the world frame: of the face (VF, crossing), or
  /// common to both edges (EE). Set only with enable_contact. Sign:
  /// - VF and EE: it points from o1 to o2, so that the touching point of o2 moves against
  ///   the normal relative to that of o1. In a self-collision "o1" is the vertex (VF) or
  ///   edge a (EE).
  /// - If the relative velocity along the normal is zero: to the side of o2's feature at
  ///   t = 0.
  /// - If that is zero too: along the winding of the face (VF with the vertex on o1),
  ///   against it (VF with the vertex on o2), or edge a x edge b (EE).
  /// - Crossing: along the winding of the face.
  /// It is the zero vector if the face has no area or the edges are parallel at toc_lo.
  ///
  /// With min_distance it points from the nearest point of o1 to that of o2, in a
  /// self-collision from the first feature to the second. It is the zero vector if they
  /// touch.
  ///
  /// With a shape or an octree it is a direction that separates the two objects just
  /// before they touch. If they overlap at t = 0: the direction of the least translation
  /// that parts them (penetration_depth). It is the zero vector for two planes or
  /// halfspaces that no translation parts, or of which one turns, or follows a spline or
  /// a BoundedMotion.
  Vector3<S> normal{Vector3<S>::Zero()};

  /// @brief With a shape or an octree that overlaps the other object at t = 0: how far o2
  /// has to move along the normal until the two parts of the contact only touch, in the
  /// unit of the coordinates. Of a mesh a part is a triangle, of an octree a cell. A move
  /// in another direction is not shorter by more than 1e-10 of the size of the parts, or
  /// 1e-4 if one of them is an ellipsoid, a cone or a cylinder; where hundreds of
  /// directions are nearly as good as each other, the search stops before it proves this.
  /// 0 for all other contacts. Set only with enable_contact.
  S penetration_depth{0};

  /// @brief The number of entries of `vertices` that are used.
  int numVertices() const {
    switch (kind) {
      case ContinuousContactKind::kCrossing:
        return 5;
      case ContinuousContactKind::kVertexEdge:
      case ContinuousContactKind::kFaceShape:
        return 3;
      case ContinuousContactKind::kVertexVertex:
      case ContinuousContactKind::kEdgeShape:
        return 2;
      case ContinuousContactKind::kVertexShape:
        return 1;
      case ContinuousContactKind::kShapes:
        return 0;
      default:
        return 4;
    }
  }
};

using ContinuousContactf = ContinuousContact<float>;
using ContinuousContactd = ContinuousContact<double>;

/// @brief Which objects and triangles can be in contact. Two triangles can if the group
/// of each one has a bit in common with the mask of the other one.
struct ContinuousFilter {
  /// @brief The groups of the object, one bit for each group.
  std::uint32_t group{1};

  /// @brief The groups that the object can be in contact with, one bit for each group.
  std::uint32_t mask{~std::uint32_t{0}};

  /// @brief The groups and masks of the triangles. They replace those of the object.
  /// Empty, or one entry for each triangle of the mesh, then for each free edge, then for
  /// each free point.
  std::vector<std::uint32_t> triangle_groups;
  std::vector<std::uint32_t> triangle_masks;
};

/// @brief Which groups of objects can be in contact, as a table of pairs of groups. All
/// can at first. It makes the filters of objects: after a change make them anew.
class ContinuousGroups {
 public:
  ContinuousGroups() { masks_.fill(~std::uint32_t{0}); }

  /// @brief Sets whether objects of two groups, or of one, can be in contact.
  /// @throws fcl::Exception  a number is not from 0 to 31
  void set(int group1, int group2, bool can_meet) {
    const std::uint32_t bit1 = bitOf(group1), bit2 = bitOf(group2);
    setBits(group1, bit2, can_meet);
    setBits(group2, bit1, can_meet);
  }
  /// @brief Whether they can. @throws fcl::Exception  as set()
  bool canMeet(int group1, int group2) const {
    bitOf(group1);
    return (masks_[static_cast<std::size_t>(group1)] & bitOf(group2)) != 0;
  }
  /// @brief The filter of an object of a group. @throws fcl::Exception  as set()
  ContinuousFilter filterOf(int group) const {
    ContinuousFilter filter;
    filter.group = bitOf(group);
    filter.mask = masks_[static_cast<std::size_t>(group)];
    return filter;
  }

 private:
  enum { kNumGroups = 32 };

  static std::uint32_t bitOf(int group) {
    if (group < 0 || group >= kNumGroups)
      throw Exception("there is no group " + std::to_string(group) +
                      ". Groups are numbered from 0 to 31");
    return std::uint32_t{1} << group;
  }
  void setBits(int group, std::uint32_t bits, bool can_meet) {
    std::uint32_t& mask = masks_[static_cast<std::size_t>(group)];
    mask = can_meet ? mask | bits : mask & ~bits;
  }

  /// Of each group: the groups that it can be in contact with.
  std::array<std::uint32_t, kNumGroups> masks_;
};

/// @brief A continuous request that asks for contacts. Two fields of FCL's request act:
/// toc_err, the largest width of a contact's time bracket, and ccd_motion_type, the path
/// between two transforms.
///
/// Filters: a vertex or an edge belongs to several triangles. A pair of features is
/// tested if filter1, filter2 and accepts_triangles accept any two triangles that hold
/// the features. The contact names two such triangles.
template <typename S>
struct ContinuousContactRequest : ContinuousCollisionRequest<S> {
  using ContinuousCollisionRequest<S>::ContinuousCollisionRequest;

  ContinuousQuery query{ContinuousQuery::kAll};

  /// @brief The result keeps at most this number of contacts, the earliest ones.
  /// ContinuousContactResult::contacts_cut says whether there were more. At least 1.
  std::size_t num_max_contacts{std::numeric_limits<std::size_t>::max()};

  /// @brief Whether position and normal of each contact are computed.
  bool enable_contact{true};

  /// @brief Only contacts whose time is at most t_max are reported, in [0, 1]. The
  /// decision is exact; if a mesh turns, or with a shape or an octree, it is within the
  /// tolerance of the query: toc_lo is at most t_max. The query does no work for later
  /// contacts. If the first contact is later, there is no collision and time_of_contact
  /// is 1.
  S t_max{1};

  /// @brief The distance d at which features are in contact, in the unit of the
  /// coordinates; not negative, finite. 0: features that touch, exactly. Above 0: @ref
  /// continuous_distance_tests has the bounds. If the nearest points of a pair of
  /// features lie on an edge or at a vertex at the time of contact, the contact is that
  /// of these parts (VE or VV). It is listed once, at the earliest of such times.
  /// Features that share a vertex are no contact. A discrete collide() finds nothing at
  /// the poses of a contact. If a mesh turns, a contact comes within d and the tolerance
  /// of such a query.
  ///
  /// With a shape or an octree it acts on every path: d is the distance from the surface
  /// of the solid. Each triangle of the mesh, or the other shape, is a contact at the
  /// first time at which it is not further away than d, up to the tolerance of the query.
  /// Kinds of contacts, and one for each triangle, are as for d = 0.
  S min_distance{0};

  /// @brief Whether pairs that are nearer than min_distance at t = 0 are in contact only
  /// when they come nearer than they are at t = 0. If false, they are contacts at t = 0.
  /// In both cases pairs that touch at t = 0 are contacts, and a crossing is reported.
  /// Beside a shape or a cell of an octree a pair must come nearer by 1e-4 of its
  /// distance. The query throws if min_distance is 0.
  bool ignore_initially_closer{false};

  /// @brief Only contacts count that approach faster than this speed, in units of length
  /// per step; not negative, finite. 0: all contacts count. For bodies that rest or slide
  /// on others: with it the edges inside of a flat floor stop nobody. Only for meshes on
  /// straight paths; the query throws for others.
  ///
  /// A contact is left out only with a proof that the gap shrinks no faster; what is not
  /// decided stays. A pair whose first contact is left out is followed further: its
  /// contact is then the first time of the step from which on it approaches faster.
  /// Crossings at t = 0 are reported as ever.
  ///
  /// min_distance = 0: the speed is that of the vertex relative to the point of the face
  /// that it touches, along the normal of the face, or of two edges along their common
  /// normal. A vertex that sinks more slowly than this passes through a face, and a sheet
  /// that does so as a whole is not seen in the next step: it wants a min_distance. The
  /// sign of the speed does not matter to features that touch at t = 0, which have no
  /// side. A pair counts as touching as long as the vertex is above or below the face (or
  /// the edges are), and has not gone back to its side. Features that stay in a plane of
  /// constant x, y or z do not approach. If the time of contact is not the first touch,
  /// toc_hi equals toc_lo.
  ///
  /// A vertex or an edge inside of a flat part of a mesh has the normal of that part,
  /// from whichever side the other feature comes: what the lower border of a side face
  /// meets does not stop a body that stands on the floor. The part is flat if the
  /// triangles there go around the vertex, or lie on both sides of the edge, and keep
  /// within 2^-20 of this speed of one plane. Other parallel edges, and faces without
  /// area, have no normal: they stay contacts.
  ///
  /// min_distance > 0: the speed at which the distance of the pair shrinks, between the
  /// nearest points. A pair that comes within min_distance at a lower speed is left out
  /// as long as it stays further apart than it was then, minus this speed times the time
  /// since then (and minus 2e-9 of the distance). So no pair comes nearer than
  /// min_distance - min_approach_speed without a contact. A pair that would touch within
  /// the step at this speed is allowed a lower one, so that no pair passes through.
  S min_approach_speed{0};

  /// @brief Whether ContinuousContacts::crossings lists all crossings at t = 0. Cannot be
  /// combined with ContinuousQuery::kAny.
  bool enable_crossings{false};

  /// @brief The filters of o1 and of o2. In a self-collision filter1 is used for both.
  ContinuousFilter filter1;
  ContinuousFilter filter2;

  /// @brief Is called with a triangle of o1 and a triangle of o2 that the filters accept
  /// (-1 for a shape or an octree); false rejects the two. Empty: none are rejected. It
  /// must always give the same answer for the same triangles; in a self-collision also
  /// for (x, y) and (y, x), since it is asked about either. Several threads of a query
  /// call it at the same time.
  std::function<bool(std::intptr_t b1, std::intptr_t b2)> accepts_triangles;

  /// @brief The number of threads of the query. 1 (the default): the caller's thread,
  /// without tasks, so that callers can run queries side by side as with FCL. n: at most
  /// n threads. 0: as many as the oneTBB task arena around the call has. Not negative.
  /// The first or any contact of a mesh that turns, or of a shape, takes one thread, and
  /// so does a query with an octree; only the trees that it makes use more. The answer
  /// does not depend on this number. The StageCounts of a query for the first contact, or
  /// with num_max_contacts, may depend on it; those of others only in crossing_tests and
  /// plane_culled.
  int num_threads{1};
};

using ContinuousContactRequestf = ContinuousContactRequest<float>;
using ContinuousContactRequestd = ContinuousContactRequest<double>;

/// @brief The fields that a query for contacts adds to FCL's result.
template <typename S>
struct ContinuousContacts {
  /// @brief The contacts, sorted by (toc_lo, kind, side, vertex ids); with a shape or an
  /// octree by (toc_lo, b1, b2); of a compound by (toc_lo, part1, part2) first. With
  /// ContinuousQuery::kFirst: the contacts that may be the first, whose bracket begins no
  /// later than the earliest bracket ends. (A contact of a rigid mesh may be found
  /// several times with different brackets; the shortest one decides.) With kAny: at most
  /// one.
  std::vector<ContinuousContact<S>> contacts;

  /// @brief Whether num_max_contacts dropped contacts.
  bool contacts_cut{false};

  /// @brief Only in a self-collision: whether no two triangles of the mesh have a common
  /// vertex (triangle soup), as in STL files and exports with split vertices. Triangles
  /// that lie side by side touch then, and are reported as contacts. weldVertices()
  /// (geometry/bvh/weld_vertices.h) tells which vertices coincide. False for a mesh of
  /// one triangle.
  bool is_triangle_soup{false};

  /// @brief Whether an edge passes through a triangle at t = 0. The decision is exact.
  /// Such surfaces may have no VF or EE contact at all. With ContinuousQuery::kAny it is
  /// not decided if a contact is found first. With a shape or an octree it is false: an
  /// overlap at t = 0 is among the contacts.
  bool initially_crossing{false};

  /// @brief An edge and a face that cross at t = 0, if initially_crossing.
  ContinuousContact<S> crossing;

  /// @brief All pairs of an edge and a face that cross at t = 0, each once, sorted by
  /// side and ascending vertex ids. Only with enable_crossings.
  std::vector<ContinuousContact<S>> crossings;

  /// @brief What each stage of the query saw and removed. If a mesh turns, or with a
  /// shape or an octree: only node_pairs, triangle_pairs and contacts. A shape or a cell
  /// counts as a triangle.
  StageCounts counts;

  /// @brief The wall time of the parts of the query, in seconds.
  StageTimes times;
};

/// @brief FCL's continuous result (is_collide, time_of_contact, contact_tf1, contact_tf2)
/// together with the contacts. time_of_contact is never later than the true first time:
/// it is the beginning of the first contact's bracket, on straight paths made no wider
/// than an eighth of its end (rounded down if S is float), 0 if the surfaces cross at t =
/// 0, 1 without collision. With ContinuousQuery::kAny it is that of the contact that was
/// found, which need not be the first. For the times of contact_tf1 and contact_tf2 see
/// @ref continuous_queries.
template <typename S>
struct ContinuousContactResult : ContinuousCollisionResult<S>, ContinuousContacts<S> {};

using ContinuousContactResultf = ContinuousContactResult<float>;
using ContinuousContactResultd = ContinuousContactResult<double>;

namespace detail {

/// @throws fcl::Exception  a field has no valid value
template <typename S>
FCL_EXPORT void requireValid(const ContinuousContactRequest<S>& request);

}  // namespace detail
}  // namespace fcl

#endif
