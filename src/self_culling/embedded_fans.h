// SPDX-License-Identifier: BSD-3-Clause
//
// The fans of a mesh that provably do not fold over themselves during the step. In most
// steps these are nearly all, and a query of the mesh with itself leaves them out.
#ifndef FCL_CCD_SELF_CULLING_EMBEDDED_FANS_H
#define FCL_CCD_SELF_CULLING_EMBEDDED_FANS_H

#include <cstdint>
#include <vector>

#include "kernels/kernels.h"
#include "tree/moving_kdop_tree.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief For each vertex of the tree whether its fan is proved embedded
/// (Kernels::areFansEmbedded).
/// @param left_out  one of each vertex: set for those that nobody asks about, which are
/// not proved
/// @param kernels  the answer is the same for all
/// @param num_threads  as in parallelFor(); the answer does not depend on it
/// @pre the tree has been refit
std::vector<std::uint8_t> findEmbeddedFans(const MovingKdopTree& tree,
                                           const std::vector<std::uint8_t>& left_out,
                                           const Kernels& kernels, int num_threads);

/// @brief For each node of the tree a vertex in whose embedded fan all triangles below it
/// lie, MovingKdopNode::kNoPlace if there is none; empty: no node has one. Only fans of
/// many spokes are looked at: each two triangles of one overlap, and a query would meet
/// every two of thousands.
/// @param embedded  of findEmbeddedFans()
std::vector<std::uint32_t> findNodesInFans(const MovingKdopTree& tree,
                                           const std::vector<std::uint8_t>& embedded);

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
