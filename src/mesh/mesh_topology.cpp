// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/mesh_topology.h"

#include <algorithm>
#include <cassert>

#include "mesh/vertex_corners.h"

namespace fcl {
namespace detail {
namespace deformable {

std::string findTooMany(std::size_t num_triangles, std::size_t num_vertices) {
  const bool triangles = num_triangles > kMaxMeshSize;
  if (!triangles && num_vertices <= kMaxMeshSize) return {};
  return std::to_string(triangles ? num_triangles : num_vertices) +
         (triangles ? " triangles" : " vertices") + " are more than " +
         std::to_string(kMaxMeshSize) + ", the most that a model can have";
}

std::size_t findOutOfRange(TriangleArray triangles, std::size_t num_triangles,
                           std::size_t num_vertices) {
  for (std::size_t i = 0; i < num_triangles; ++i) {
    std::size_t id[3];
    triangles.copyIds(i, id);
    for (std::size_t k = 0; k < 3; ++k)
      if (id[k] >= num_vertices) return 3 * i + k;
  }
  return 3 * num_triangles;
}

std::vector<MeshTriangle> assignFeatures(TriangleArray triangles,
                                         std::size_t num_triangles,
                                         std::size_t num_vertices) {
  assert(findTooMany(num_triangles, num_vertices).empty() &&
         findOutOfRange(triangles, num_triangles, num_vertices) == 3 * num_triangles);
  std::vector<TreeTriangle> all(num_triangles);
  for (std::size_t i = 0; i < num_triangles; ++i) {
    all[i].index = static_cast<std::uint32_t>(i);
    triangles.copyIds(i, all[i].place);
  }
  assignOwners(VertexCorners(all, num_vertices, 1), 1, all);
  std::vector<MeshTriangle> result(num_triangles);
  for (std::size_t i = 0; i < num_triangles; ++i) {
    std::copy(all[i].place, all[i].place + 3, result[i].v);
    result[i].owned = all[i].owned;
  }
  return result;
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
