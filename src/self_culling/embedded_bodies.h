// SPDX-License-Identifier: BSD-3-Clause
//
// Closed parts of a mesh that are proved to stay star-shaped during the step, as balls,
// boxes and most bodies without deep folds. They do not meet themselves. A query of the
// mesh with itself leaves them out.
#ifndef FCL_CCD_SELF_CULLING_EMBEDDED_BODIES_H
#define FCL_CCD_SELF_CULLING_EMBEDDED_BODIES_H

#include <cstdint>

#include "kernels/kernels.h"
#include "self_culling/embedded_regions.h"
#include "tree/moving_kdop_tree.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief Least number of triangles of a body, unless it is the whole mesh: that of a
/// component which has a tree of its own.
constexpr std::uint32_t kLeastBody = 64;

/// @brief Finds the nodes whose triangles are a closed surface that stays star-shaped:
/// there is a moving point that sees all of them from the same side at every time, and a
/// ray from it that hits only one of them at t = 0. So each direction meets the surface
/// once at every time (doc/pipeline.md has the proof). All that EmbeddedRegions says of a
/// region is true of such a body; only a direction it has none.
///
/// With a distance: features of the body that have no common vertex also stay further
/// apart than this. Proof. Let x and y be points of two such features, as seen from the
/// point. If the directions of x and y differ by an angle below 90 degrees, their
/// distance is at least |x| times its sine, else it is at least |x|. Seen from the point,
/// the two features are convex parts of the sphere that do not meet. If they are nearer
/// than 90 degrees, a corner v of one of them is nearest to a place q of the other. The
/// triangles around v surround it, and q is not inside of this star. So the way from v to
/// q leaves it through an edge opposite to v, and its sine is at least that of the angle
/// between v and the plane through this edge and the point. |x| is at least the distance
/// of the point from the plane of a triangle.
/// @param kernels  the answer is the same for all
/// @param num_threads  as in parallelFor(); the answer does not depend on it
/// @param distance  0: only embedded
/// @pre the tree has been refit
EmbeddedRegions findEmbeddedBodies(const MovingKdopTree& tree, const Kernels& kernels,
                                   int num_threads, double distance = 0);

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
