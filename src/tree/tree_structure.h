// SPDX-License-Identifier: BSD-3-Clause
//
// A tree without boxes, and the items that it is made from.
#ifndef FCL_CCD_TREE_TREE_STRUCTURE_H
#define FCL_CCD_TREE_TREE_STRUCTURE_H

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/uninitialized_vector.h"
#include "mesh/tree_nodes.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief The children of a node: >= 0 a node, < 0 ~leaf.
struct TreeChildren {
  std::int32_t child[MovingKdopNode::kWidth];
  std::int32_t count;
};

/// @brief A tree without boxes. Nodes and leaves are numbered in the order of a walk from
/// the root, node 0. The nodes among a node's children follow each other. The leaves
/// among them come before the leaves of its child nodes.
struct TreeStructure {
  UninitializedVector<TreeChildren> nodes;
  /// The user's number of each leaf's triangle.
  std::vector<std::uint32_t> leaves;
};

/// @brief Whether nodes and leaves have the numbers that TreeStructure says, and each
/// occurs once.
inline bool isInWalkOrder(const TreeStructure& tree) {
  std::size_t num_nodes = 1, num_leaves = 0;
  std::vector<std::int32_t> open{0};
  while (!open.empty()) {
    const TreeChildren& node = tree.nodes[static_cast<std::size_t>(open.back())];
    open.pop_back();
    if (node.count <= 0 || node.count > MovingKdopNode::kWidth) return false;
    for (int i = 0; i < node.count; ++i) {
      const std::int32_t child = node.child[i];
      std::size_t& next = child < 0 ? num_leaves : num_nodes;
      if (static_cast<std::size_t>(child < 0 ? ~child : child) != next++) return false;
    }
    if (num_nodes > tree.nodes.size() || num_leaves > tree.leaves.size()) return false;
    for (int i = node.count; i-- > 0;)
      if (node.child[i] >= 0) open.push_back(node.child[i]);
  }
  return num_nodes == tree.nodes.size() && num_leaves == tree.leaves.size();
}

/// @brief Whether each of 0 ... n - 1 occurs once among n numbers.
inline bool isPermutation(const std::vector<std::uint32_t>& numbers) {
  std::vector<bool> is_met(numbers.size(), false);
  for (const std::uint32_t i : numbers) {
    if (i >= numbers.size() || is_met[i]) return false;
    is_met[i] = true;
  }
  return true;
}

/// @brief Numbers the nodes and leaves of a tree in the order of a walk from node 0.
/// @param children  children(node, number) returns the children, by their old numbers, of
/// the node that gets this number
template <typename Children>
TreeStructure inWalkOrder(std::size_t num_leaves, Children&& children) {
  struct Numbered {
    std::int32_t node;
    std::size_t number;
  };
  TreeStructure tree;
  tree.leaves.reserve(num_leaves);
  tree.nodes.emplace_back();
  std::vector<Numbered> open{{0, 0}};
  while (!open.empty()) {
    const Numbered o = open.back();
    open.pop_back();
    TreeChildren node = children(o.node, o.number);
    assert(node.count > 0 && node.count <= MovingKdopNode::kWidth);
    // The first child is the next one to be visited.
    const std::size_t num_open = open.size();
    for (int i = 0; i < node.count; ++i) {
      std::int32_t& child = node.child[i];
      if (child < 0) {
        tree.leaves.push_back(static_cast<std::uint32_t>(~child));
        child = ~static_cast<std::int32_t>(tree.leaves.size() - 1);
      } else {
        open.push_back({child, tree.nodes.size()});
        child = static_cast<std::int32_t>(tree.nodes.size());
        tree.nodes.emplace_back();
      }
    }
    std::reverse(open.begin() + static_cast<std::ptrdiff_t>(num_open), open.end());
    tree.nodes[o.number] = node;
  }
  assert(tree.leaves.size() == num_leaves && isInWalkOrder(tree));
  return tree;
}

/// @brief An item of a tree: an index and a point. Seen as a vector of four numbers, only
/// the first three are the point.
struct alignas(16) TreeItem {
  float point[3];
  std::uint32_t index;
};

/// @brief The coordinate, limited so that widths, sums, and products of a few numbers
/// cannot overflow. NaN becomes 0, in the middle.
inline float clampedCoordinate(double coordinate) {
  constexpr double kFarthest = 1e37;
  return coordinate == coordinate
             ? static_cast<float>(std::max(-kFarthest, std::min(kFarthest, coordinate)))
             : 0.f;
}

/// @brief Four times the center of a child's box, over both frames.
inline void pointOf(const MovingKdopNode& node, int lane, float (&point)[3]) {
  for (int k = 0; k < 3; ++k) {
    const int lo = 2 * k, hi = lo + 1;
    point[k] = clampedCoordinate(double{(node.t0[hi][lane] - node.t0[lo][lane]) +
                                        (node.t1[hi][lane] - node.t1[lo][lane])});
  }
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
