// SPDX-License-Identifier: BSD-3-Clause
//
// Components of a mesh: triangles that are connected through common vertices.
#ifndef FCL_CCD_TREE_COMPONENT_GROUPS_H
#define FCL_CCD_TREE_COMPONENT_GROUPS_H

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

#include "base/uninitialized_vector.h"
#include "tree/tree_structure.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief A component with at least this many triangles is large, see groupItems(). These
/// are eight of the lowest nodes.
constexpr std::size_t kLeastComponent = 64;

/// @brief For each vertex, the first vertex of its component.
/// @param verticesOf  verticesOf(i, v): sets v to the three vertices of triangle i
template <typename VerticesOf>
std::vector<std::uint32_t> findComponents(std::size_t num_vertices,
                                          std::size_t num_triangles,
                                          VerticesOf&& verticesOf) {
  std::vector<std::uint32_t> parent(num_vertices);
  std::iota(parent.begin(), parent.end(), std::uint32_t{0});
  const auto find = [&parent](std::uint32_t v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  for (std::size_t i = 0; i < num_triangles; ++i) {
    std::uint32_t v[3];
    verticesOf(i, v);
    assert(std::max({v[0], v[1], v[2]}) < num_vertices);
    if (parent[v[0]] == parent[v[1]] && parent[v[0]] == parent[v[2]]) continue;
    const std::uint32_t a = find(v[0]), b = find(v[1]), c = find(v[2]);
    parent[a] = parent[b] = parent[c] = std::min(a, std::min(b, c));
  }
  // A parent comes before its children.
  for (std::uint32_t& p : parent) {
    p = parent[p];
    assert(parent[p] == p && p <= static_cast<std::size_t>(&p - parent.data()));
  }
  return parent;
}

/// @brief Puts the items of each large component together. With a tree of its own a
/// component can be proved to be embedded where layers lie on each other, and its boxes
/// stay small when components move apart. Small components stay together in one group.
/// @param component_of  the component of each item, a number below num_components
/// @param least  a component with at least this many items is large
/// @param items  in the order of their indices
/// @return the end of each group, with groups in an order in which neighbours are near
/// each other; empty if there is only one group
std::vector<std::size_t> groupItems(std::vector<std::uint32_t> component_of,
                                    std::size_t num_components, std::size_t least,
                                    UninitializedVector<TreeItem>& items);

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
