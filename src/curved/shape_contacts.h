// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_CURVED_SHAPE_CONTACTS_H
#define FCL_CCD_CURVED_SHAPE_CONTACTS_H

#include <cstdint>
#include <vector>

#include "bodies/moving_body.h"
#include "fcl/narrowphase/stage_counts.h"
#include "query/query_options.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief The first contact of a triangle of a mesh with a shape or a cell of an octree,
/// or of two of these.
struct ShapeContact {
  ContinuousContactKind kind;
  /// Whether the mesh is body a.
  bool mesh_is_first;
  /// Vertex ids of the mesh's feature. The kind says how many there are; the others are
  /// -1.
  std::int32_t vertices[3];
  /// Triangles of a and b; -1 for a shape; of a cell its number (OctreeCellNumber).
  std::int64_t triangles[2];
  double toc_lo, toc_hi;
  bool within_tolerance;
  /// In the world. The normal is a unit vector from a to b, or zero if there is none.
  Vec position, normal;
};

struct ShapeAnswer {
  /// Sorted by (toc_lo, triangles).
  std::vector<ShapeContact> contacts;
  bool cut{false};
  /// When discrete queries find the first contact, if they do within toc_err: a time in
  /// [toc_hi, toc_lo + toc_err]. With a distance it is toc_hi. 1: there is no contact.
  double pose_time{1};
  StageCounts counts;
};

/// @brief The contacts of two bodies, of which one is a shape or an octree at least: one
/// for each pair of triangles, shapes and cells. As in queryCurved(), no contact is
/// missed, and no time is late. Shapes and cells are solid: what is inside of one at t =
/// 0 touches it then.
/// @param options  with only_time only the time of a contact is given
/// @pre the floating-point mode is the default one
/// @throws NonFiniteVertex; fcl::Exception when a vertex id of a triangle is out of range
ShapeAnswer queryShapeContacts(const MovingBody& a, const MovingBody& b,
                               const QueryOptions& options);

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
