// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_TREE_TREE_BUILDER_H
#define FCL_CCD_TREE_TREE_BUILDER_H

#include <cstddef>

#include "mesh/mesh_triangle.h"
#include "mesh/vertex_frames.h"
#include "tree/tree_structure.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief Splits the triangles into a tree by their centroids in frame 0, as splitItems()
/// does. The components are its groups. All free leaves are one group.
/// @param num_threads  as in parallelFor(); the tree does not depend on it
/// @param free  how many of the triangles, at their end, are free leaves
TreeStructure splitTriangles(TriangleArray triangles, std::size_t num_triangles,
                             const VertexFrames& frames, int num_threads,
                             FreeLeaves free = {});

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
