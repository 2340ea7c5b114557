// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_TEST_SUPPORT_SWEPT_TREE_H
#define FCL_TEST_SUPPORT_SWEPT_TREE_H

#include <algorithm>
#include <cstddef>
#include <vector>

#include "fcl/narrowphase/detail/deformable/moving_kdop_tree.h"

namespace fcl {
namespace test {

/// @brief A model's moving tree with each pair of boxes replaced by one box around both,
/// which is what the paper and FCL use.
class SweptTree {
 public:
  explicit SweptTree(const detail::deformable::MovingKdopTree& tree) : tree_(tree) {
    boxes_.reserve(tree.links().size());
    for (std::size_t i = 0; i < tree.links().size(); ++i) {
      MovingKdop box = tree.box(static_cast<int>(i));
      for (int j = 0; j < 16; ++j)
        box.t0.half[j] = box.t1.half[j] = std::max(box.t0.half[j], box.t1.half[j]);
      boxes_.push_back(box);
    }
  }
  bool isLeaf(int node) const { return tree_.isLeaf(node); }
  int leftChild(int node) const { return tree_.leftChild(node); }
  int triangle(int node) const { return tree_.triangle(node); }
  const MovingKdop& box(int node) const { return boxes_[static_cast<std::size_t>(node)]; }

 private:
  const detail::deformable::MovingKdopTree& tree_;
  std::vector<MovingKdop> boxes_;
};

}  // namespace test
}  // namespace fcl

#endif
