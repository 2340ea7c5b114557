// SPDX-License-Identifier: BSD-3-Clause
//
// The fans of a mesh that are proved not to fold over themselves during the step. In most
// steps these are nearly all fans. A query of the mesh with itself leaves them out.
#ifndef FCL_CCD_SELF_CULLING_EMBEDDED_FANS_H
#define FCL_CCD_SELF_CULLING_EMBEDDED_FANS_H

#include <cstdint>
#include <vector>

#include "kernels/kernels.h"
#include "tree/moving_kdop_tree.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief For each vertex of the tree, whether its fan is proved to be embedded
/// (Kernels::areFansEmbedded).
/// @param left_out  for each vertex, whether its fan is not needed; such a fan is not
/// proved
/// @param kernels  the answer is the same for all
/// @param num_threads  as in parallelFor(); the answer does not depend on it
/// @param distance  above 0: only fans whose features also stay further apart than this
/// @pre the tree has been refit
std::vector<std::uint8_t> findEmbeddedFans(const MovingKdopTree& tree,
                                           const std::vector<std::uint8_t>& left_out,
                                           const Kernels& kernels, int num_threads,
                                           double distance = 0);

/// @brief For each node of the tree, a vertex whose embedded fan contains all triangles
/// below the node, or MovingKdopNode::kNoPlace if there is none. Empty: no node has one.
/// Only fans of many spokes are considered: the boxes of all their triangles overlap, and
/// a query would meet each pair of thousands of triangles.
/// @param embedded  the result of findEmbeddedFans()
std::vector<std::uint32_t> findNodesInFans(const MovingKdopTree& tree,
                                           const std::vector<std::uint8_t>& embedded);

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
