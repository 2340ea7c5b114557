// SPDX-License-Identifier: BSD-3-Clause
//
// The parts of embedded regions whose features also stay further apart than a distance. A
// query at a distance leaves out their pairs, as a query for touching leaves out regions.
#ifndef FCL_CCD_SELF_CULLING_REGIONS_APART_H
#define FCL_CCD_SELF_CULLING_REGIONS_APART_H

#include <cstdint>
#include <vector>

#include "kernels/kernels.h"
#include "self_culling/embedded_regions.h"
#include "tree/moving_kdop_tree.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief What of regions stays apart.
struct RegionsApart {
  /// For each node of the tree, the node of the region in which its triangles are apart,
  /// or MovingKdopNode::kNoPlace. Features of the triangles below two nodes of the same
  /// region, or below one, that have no common vertex stay further apart than the
  /// distance during the whole step. Only the root of a body has its region: a traversal
  /// that leaves out this node with itself meets no other pair below it.
  std::vector<std::uint32_t> nodes;
  /// For each vertex, whether it is inside of a region and the same is true of the
  /// features of its fan.
  std::vector<std::uint8_t> fans;
};

/// @brief Finds the parts that stay apart. All of a body does, see findEmbeddedBodies().
///
/// Proof. A region covers the plane, seen along its direction, at most once at every
/// time. The distance of two features is at least that of their projections. These do not
/// meet, so a vertex v of one of them is nearest to a point q of the other.
/// - The way to q begins in a triangle of the region that has v. A feature without v has
///   no point there but on the edge opposite to v. So the way leaves the triangle through
///   this edge, or ends there. It is as long as the height of the triangle over v.
/// - Else v is on the border, since the triangles around other vertices surround them.
///   The way begins outside of the region, and comes to q through an edge of the border.
///   The ray from v to it is outside of the region, so it is an edge without v. The way
///   is as long as the distance of v from this edge. The edges of the border that have v
///   are no further from it. One of them has no common vertex with it, or it closes a
///   loop of three edges with them.
///
/// Nodes are apart if, for all vertices of their triangles, the heights over them of the
/// region's triangles are above the distance, and so are the distances of their edges of
/// the border from those without a common vertex; and if none is in a loop of three
/// edges.
///
/// A height in the plane is the area seen, n . d / |d|, over the length of the edge seen,
/// which is no longer than the edge. n . d is at least the least of its Bernstein
/// coefficients during the step, and an edge is never longer than at its ends.
///
/// Of two features of the fan of an inner vertex, this vertex or an outer one is nearest
/// to a point of the other: Kernels::areFansEmbedded() has the proof. It needs all
/// heights of the fan's triangles.
/// @param regions  the results of findEmbeddedBodies() at this distance and of
/// addEmbeddedRegions()
/// @param kernels  the answer is the same for all
/// @pre the tree has been refit
RegionsApart findRegionsApart(const MovingKdopTree& tree, const EmbeddedRegions& regions,
                              const Kernels& kernels, double distance);

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
