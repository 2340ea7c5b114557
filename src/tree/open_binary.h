// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_TREE_OPEN_BINARY_H
#define FCL_CCD_TREE_OPEN_BINARY_H

#include <algorithm>
#include <cassert>
#include <cstdint>

#include "mesh/tree_nodes.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief Opens node i of a binary tree until there are eight nodes, or only leaves.
/// @param link  link(i) >= 0: left child of i (the right one follows it); < 0: ~triangle
/// @param nodes  the nodes of the binary tree that were found
/// @param children  the same nodes, but ~triangle for leaves
/// @return number of entries
template <typename Link>
int openBinary(std::int32_t i, std::int32_t (&nodes)[MovingKdopNode::kWidth],
               std::int32_t (&children)[MovingKdopNode::kWidth], Link&& link) {
  int n = 1;
  nodes[0] = i;
  for (bool grew = true; grew;) {
    grew = false;
    const int before = n;
    for (int k = 0; k < before && n < MovingKdopNode::kWidth; ++k) {
      const std::int32_t left = link(nodes[k]);
      if (left < 0) continue;
      nodes[k] = left;
      nodes[n++] = left + 1;
      grew = true;
    }
  }
  for (int k = 0; k < n; ++k) {
    const std::int32_t left = link(nodes[k]);
    children[k] = left < 0 ? left : nodes[k];
  }
  assert(
      n == MovingKdopNode::kWidth ||
      std::all_of(children, children + n, [](std::int32_t child) { return child < 0; }));
  return n;
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
