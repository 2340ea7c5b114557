// SPDX-License-Identifier: BSD-3-Clause
#include "weld.h"

#include <cassert>
#include <cstddef>

#include "mesh/vertex_weld.h"

namespace fcl_ccd {

bool isSoup(const Vertices& vertices, const Triangles& triangles) {
  if (triangles.empty()) return false;
  std::vector<char> used(vertices.size(), 0);
  for (const auto& triangle : triangles)
    for (const int id : triangle) {
      if (used[static_cast<std::size_t>(id)] != 0) return false;
      used[static_cast<std::size_t>(id)] = 1;
    }
  fcl::detail::deformable::VertexWeld weld(vertices.size(), 0);
  weld.refine(vertices.data()->data());
  return weld.numJoined() > 0;
}

void joinVertices(const std::vector<int>& map, Triangles& triangles) {
  for (auto& triangle : triangles)
    for (int& id : triangle) {
      assert(static_cast<std::size_t>(id) < map.size());
      id = map[static_cast<std::size_t>(id)];
    }
}

void joinVertices(const std::vector<int>& map, FreeElements& free) {
  for (auto& edge : free.edges)
    for (int& id : edge) id = map[static_cast<std::size_t>(id)];
  for (int& id : free.points) id = map[static_cast<std::size_t>(id)];
}

}  // namespace fcl_ccd
