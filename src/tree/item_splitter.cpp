// SPDX-License-Identifier: BSD-3-Clause
#include "tree/item_splitter.h"

namespace fcl {
namespace detail {
namespace deformable {

std::vector<OpenItems> splitRange(Splitter& splitter, const OpenItems& root,
                                  std::size_t max_left, std::size_t max_parts,
                                  std::vector<TreeChildren>& nodes,
                                  std::vector<std::uint32_t>& leaves) {
  constexpr std::size_t kWidth = MovingKdopNode::kWidth;
  std::vector<OpenItems> open{root}, left;
  while (!open.empty()) {
    const OpenItems o = open.back();
    open.pop_back();
    assert(o.node < nodes.size() && o.first_leaf + o.range.count <= leaves.size());
    if (o.range.count <= max_left) {
      left.push_back(o);
      continue;
    }
    Splitter::ItemRange parts[kWidth];
    const std::size_t n =
        splitter.split(o.range, o.node == root.node ? max_parts : kWidth, o.depth, parts);
    TreeChildren node{};
    node.count = static_cast<std::int32_t>(n);
    std::size_t leaf = o.first_leaf;
    for (std::size_t i = 0; i < n; ++i) {
      if (parts[i].count > 1) continue;
      leaves[leaf] = splitter.index(parts[i].first);
      node.child[i] = ~static_cast<std::int32_t>(leaf++);
    }
    // The first child is the next one to be split.
    const std::size_t num_nodes = nodes.size();
    for (std::size_t i = 0; i < n; ++i) {
      if (parts[i].count == 1) continue;
      node.child[i] = static_cast<std::int32_t>(nodes.size());
      open.push_back({parts[i], nodes.size(), leaf, o.depth + 1});
      leaf += parts[i].count;
      nodes.emplace_back();
    }
    assert(leaf == o.first_leaf + o.range.count);
    std::reverse(open.end() - static_cast<std::ptrdiff_t>(nodes.size() - num_nodes),
                 open.end());
    nodes[o.node] = node;
  }
  return left;
}

TreeStructure splitItems(UninitializedVector<TreeItem> items,
                         std::vector<std::size_t> ends, std::size_t max_parts,
                         int depth) {
  TreeStructure tree;
  const std::size_t count = items.size();
  tree.leaves.resize(count);
  Splitter splitter(std::move(items), std::move(ends));
  std::vector<TreeChildren> nodes(1);
  splitRange(splitter, {{0, count}, 0, 0, depth}, 0, max_parts, nodes, tree.leaves);
  tree.nodes.assign(nodes.begin(), nodes.end());
  assert(isInWalkOrder(tree));
  return tree;
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
