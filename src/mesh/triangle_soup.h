// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_MESH_TRIANGLE_SOUP_H
#define FCL_CCD_MESH_TRIANGLE_SOUP_H

#include <cstddef>
#include <vector>

#include "mesh/tree_nodes.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief Whether no two triangles have a common vertex. False for fewer than two
/// triangles, and if an id is not below num_vertices.
bool isTriangleSoup(TriangleArray triangles, std::size_t num_triangles,
                    std::size_t num_vertices);

/// @brief The same for triangles in a tree, in terms of their places.
/// @param num_free  how many of them are free leaves, which do not count
bool isTriangleSoup(const std::vector<TreeTriangle>& triangles, std::size_t num_vertices,
                    std::size_t num_free = 0);

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
