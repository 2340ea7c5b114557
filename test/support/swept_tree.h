// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_TEST_SUPPORT_SWEPT_TREE_H
#define FCL_TEST_SUPPORT_SWEPT_TREE_H

#include <algorithm>
#include <cstddef>
#include <vector>

#include "tree/moving_kdop_tree.h"

namespace fcl {
namespace test {

/// @brief A model's moving tree in which each moving box is replaced by one box around
/// both frames, as in the paper and in FCL.
class SweptTree {
 public:
  explicit SweptTree(const detail::deformable::MovingKdopTree& tree) { assign(tree); }

  /// @brief Copies the current boxes of the tree.
  void assign(const detail::deformable::MovingKdopTree& tree) {
    nodes_.clear();
    nodes_.reserve(tree.numNodes());
    for (std::size_t i = 0; i < tree.numNodes(); ++i) {
      detail::deformable::MovingKdopNode node = tree.node(static_cast<int>(i));
      for (int r = 0; r < 16; ++r)
        for (int lane = 0; lane < node.count; ++lane)
          node.t0[r][lane] = node.t1[r][lane] =
              std::max(node.t0[r][lane], node.t1[r][lane]);
      nodes_.push_back(node);
    }
  }
  const detail::deformable::MovingKdopNode& node(int i) const {
    return nodes_[static_cast<std::size_t>(i)];
  }

 private:
  std::vector<detail::deformable::MovingKdopNode> nodes_;
};

}  // namespace test
}  // namespace fcl

#endif
