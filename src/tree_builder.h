// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_TREE_BUILDER_H
#define FCL_CCD_TREE_BUILDER_H

#include <cstdint>
#include <vector>

#include "fcl/narrowphase/detail/deformable/mesh_topology.h"
#include "fcl/narrowphase/detail/deformable/moving_kdop_tree.h"
#include "fcl/narrowphase/detail/deformable/vertex_frames.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief The children of a node, as in MovingKdopNode, with the user's triangles.
struct TreeChildren {
  std::int32_t child[MovingKdopNode::kWidth];
  std::int32_t count;
};

/// @brief Splits the triangles into a tree by their centroids in frame 0: by surface area
/// at the top, and into halves at the bottom, so that the lowest nodes are full. Node 0
/// is the root.
std::vector<TreeChildren> splitTriangles(const std::vector<MeshTriangle>& triangles,
                                         const VertexFrames& frames);

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
