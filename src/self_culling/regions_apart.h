// SPDX-License-Identifier: BSD-3-Clause
//
// The parts of embedded regions whose features also stay further apart than a distance. A
// query at a distance leaves out their pairs, as a query for touching leaves out regions.
#ifndef FCL_CCD_SELF_CULLING_REGIONS_APART_H
#define FCL_CCD_SELF_CULLING_REGIONS_APART_H

#include <cstdint>
#include <vector>

#include "self_culling/embedded_regions.h"
#include "tree/moving_kdop_tree.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief For each node of the tree, the node of the region in which its triangles are
/// apart, or MovingKdopNode::kNoPlace. Features of the triangles below two nodes of the
/// same region, or below one, that have no common vertex stay further apart than the
/// distance during the whole step.
///
/// Proof. A region covers the plane, seen along its direction, at most once at every
/// time. The distance of two features is at least that of their projections. These do not
/// meet, so a vertex v of one of them is nearest to a point q of the other. v is inside
/// of the region. So its triangles surround it, and q is not inside of this star: a
/// feature without v has no point there. The way to q leaves the star through an edge
/// opposite to v, and is as long as the least height of these triangles over v. A height
/// in the plane is the area seen, n . d / |d|, over the length of the edge seen, which is
/// no longer than the edge. n . d is at least the least of its Bernstein coefficients
/// during the step, and an edge is never longer than at its ends.
/// @param regions  the result of findEmbeddedRegions()
/// @pre the tree has been refit
std::vector<std::uint32_t> findNodesApart(const MovingKdopTree& tree,
                                          const EmbeddedRegions& regions,
                                          double distance);

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
