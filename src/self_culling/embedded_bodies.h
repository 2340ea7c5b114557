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
/// region is true of such a body; only `directions` has no meaning for it.
/// @param kernels  the answer is the same for all
/// @param num_threads  as in parallelFor(); the answer does not depend on it
/// @pre the tree has been refit
EmbeddedRegions findEmbeddedBodies(const MovingKdopTree& tree, const Kernels& kernels,
                                   int num_threads);

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
