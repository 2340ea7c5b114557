// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/triangle_soup.h"

#include <algorithm>
#include <cassert>
#include <cstdint>

#include "mesh/mesh_triangle.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

/// @param idsOf  gives the three ids of a triangle; false for a free leaf. The loop ends
/// at the first triangle that shares a vertex. In a mesh that is no soup it is one of the
/// first as a rule.
template <typename IdsOf>
bool standAlone(std::size_t num_triangles, std::size_t num_free, std::size_t num_vertices,
                IdsOf&& idsOf) {
  if (num_triangles < num_free + 2) return false;
  constexpr std::uint32_t kNone = ~std::uint32_t{0};
  std::vector<std::uint32_t> triangle_of(num_vertices, kNone);
  for (std::uint32_t i = 0; i < num_triangles; ++i) {
    std::uint32_t ids[3];
    if (!idsOf(i, ids)) continue;
    for (const std::uint32_t id : ids) {
      if (id >= num_vertices) return false;
      if (triangle_of[id] != kNone && triangle_of[id] != i) return false;
      triangle_of[id] = i;
    }
  }
  return true;
}

}  // namespace

bool isTriangleSoup(TriangleArray triangles, std::size_t num_triangles,
                    std::size_t num_vertices) {
  return standAlone(num_triangles, 0, num_vertices,
                    [&](std::uint32_t i, std::uint32_t(&ids)[3]) {
                      triangles.copyIds(i, ids);
                      return true;
                    });
}

bool isTriangleSoup(const std::vector<TreeTriangle>& triangles, std::size_t num_vertices,
                    std::size_t num_free) {
  assert(num_free <= triangles.size());
  return standAlone(triangles.size(), num_free, num_vertices,
                    [&](std::uint32_t i, std::uint32_t(&ids)[3]) {
                      std::copy(triangles[i].place, triangles[i].place + 3, ids);
                      return (triangles[i].owned & kFreeLeaf) == 0;
                    });
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
