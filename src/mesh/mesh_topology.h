// SPDX-License-Identifier: BSD-3-Clause
//
// Representative triangles (Curtis, Tamstorf, Manocha 2008): every vertex, edge and face
// is owned by exactly one triangle, so that each VF and EE pair of a scene is met once.
#ifndef FCL_CCD_MESH_MESH_TOPOLOGY_H
#define FCL_CCD_MESH_MESH_TOPOLOGY_H

#include <cstddef>
#include <string>
#include <vector>

#include "mesh/mesh_triangle.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief The text of an error if a mesh has more than kMaxMeshSize triangles or
/// vertices; empty if it does not.
std::string findTooMany(std::size_t num_triangles, std::size_t num_vertices);

/// @brief The first corner, 3 * triangle + k, whose vertex id is not below num_vertices;
/// 3 * num_triangles if there is none.
std::size_t findOutOfRange(TriangleArray triangles, std::size_t num_triangles,
                           std::size_t num_vertices);

/// @brief The lowest-numbered triangle that has a feature owns it. A vertex without a
/// triangle is not a feature; of several faces with the same vertex set only the first
/// owns its face; an edge whose two ids are equal is owned by nobody.
/// @param triangles indices below num_vertices (not checked here).
std::vector<MeshTriangle> assignFeatures(TriangleArray triangles,
                                         std::size_t num_triangles,
                                         std::size_t num_vertices);

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
