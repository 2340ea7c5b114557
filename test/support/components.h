// SPDX-License-Identifier: BSD-3-Clause
//
// Connected components of a mesh, computed without the library.
#ifndef FCL_TEST_SUPPORT_COMPONENTS_H
#define FCL_TEST_SUPPORT_COMPONENTS_H

#include <cstddef>
#include <numeric>
#include <vector>

#include "fcl/math/triangle.h"

namespace fcl {
namespace test {

/// @brief For each vertex the number of its component, counted from 0.
inline std::vector<std::size_t> componentsOf(const std::vector<Triangle>& triangles,
                                             std::size_t num_vertices) {
  std::vector<std::size_t> parent(num_vertices);
  std::iota(parent.begin(), parent.end(), std::size_t{0});
  const auto root = [&parent](std::size_t v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  for (const Triangle& t : triangles)
    for (int k = 1; k < 3; ++k) parent[root(t[k])] = root(t[0]);
  std::vector<std::size_t> number(parent.size(), 0), name(parent.size(), 0);
  std::size_t count = 0;
  for (std::size_t v = 0; v < parent.size(); ++v)
    if (root(v) == v) name[v] = count++;
  for (std::size_t v = 0; v < parent.size(); ++v) number[v] = name[root(v)];
  return number;
}

}  // namespace test
}  // namespace fcl

#endif
