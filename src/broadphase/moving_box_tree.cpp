// SPDX-License-Identifier: BSD-3-Clause
#include "broadphase/moving_box_tree.h"
#include "base/prefetch.h"

#include <algorithm>
#include <cassert>
#include <cstdlib>

namespace fcl {
namespace detail {
namespace deformable {
namespace {

/// The boxes of the leaves are scattered in memory. So many are asked for before they are
/// read.
constexpr int kBoxesAhead = 16;

void prefetch(const LinearBox& box) {
  prefetchMemory(&box);
  prefetchMemory(reinterpret_cast<const char*>(&box) + sizeof(LinearBox) - 1);
}

[[maybe_unused]] bool isSame(const LinearBox& a, const LinearBox& b) {
  for (int k = 0; k < 3; ++k)
    if (!std::equal(a.axis[k], a.axis[k] + 4, b.axis[k])) return false;
  return true;
}

LinearBox unionOf(const LinearBox& a, const LinearBox& b) {
  LinearBox out;
  for (int k = 0; k < 3; ++k)
    for (int i = 0; i < 4; ++i) out.axis[k][i] = std::max(a.axis[k][i], b.axis[k][i]);
  return out;
}

}  // namespace

void MovingBoxTree::clear() {
  nodes_.clear();
  free_.clear();
  leaf_of_.clear();
  root_ = kNone;
  count_ = 0;
}

std::int32_t MovingBoxTree::newNode() {
  if (free_.empty()) {
    nodes_.emplace_back();
    return static_cast<std::int32_t>(nodes_.size()) - 1;
  }
  const std::int32_t node = free_.back();
  free_.pop_back();
  return node;
}

void MovingBoxTree::setLeaf(std::int32_t object, std::int32_t node) {
  if (index(object) >= leaf_of_.size()) leaf_of_.resize(index(object) + 1, kNone);
  leaf_of_[index(object)] = node;
}

void MovingBoxTree::fit(std::int32_t node) {
  Node& n = at(node);
  const Node &x = at(n.child[0]), &y = at(n.child[1]);
  assert(x.parent == node && y.parent == node);
  n.box = unionOf(x.box, y.box);
  n.height = 1 + std::max(x.height, y.height);
  assert(isSame(unionOf(n.box, x.box), n.box) && isSame(unionOf(n.box, y.box), n.box));
}

/// Finds the leaf beside which a box is inserted: goes down, each time to the child that
/// the box makes wider by less. Beside a leaf the heights grow by one at most.
std::int32_t MovingBoxTree::leafBeside(const LinearBox& box) const {
  std::int32_t node = root_;
  while (!at(node).isLeaf()) {
    float width[2], growth[2];
    for (int c = 0; c < 2; ++c) {
      const LinearBox& child = at(at(node).child[c]).box;
      width[c] = widthOf(unionOf(child, box));
      growth[c] = width[c] - widthOf(child);
    }
    const bool is_second =
        growth[1] != growth[0] ? growth[1] < growth[0] : width[1] < width[0];
    node = at(node).child[is_second ? 1 : 0];
  }
  return node;
}

void MovingBoxTree::replaceChild(std::int32_t parent, std::int32_t from,
                                 std::int32_t to) {
  if (parent == kNone)
    root_ = to;
  else
    at(parent).child[at(parent).child[0] == from ? 0 : 1] = to;
  at(to).parent = parent;
}

/// If one child is higher than the other by more than one, the higher child takes the
/// place of the node, and the node takes the lower child of that child. Returns the node
/// that is then in this place.
std::int32_t MovingBoxTree::balance(std::int32_t node) {
  const int difference = at(at(node).child[1]).height - at(at(node).child[0]).height;
  if (difference >= -1 && difference <= 1) return node;
  const int side = difference > 0 ? 1 : 0;
  const std::int32_t up = at(node).child[side];
  const int low = at(at(up).child[0]).height < at(at(up).child[1]).height ? 0 : 1;
  const std::int32_t moved = at(up).child[low];
  replaceChild(at(node).parent, node, up);
  at(up).child[low] = node;
  at(node).parent = up;
  at(node).child[side] = moved;
  at(moved).parent = node;
  fit(node);
  fit(up);
  for ([[maybe_unused]] const std::int32_t i : {node, up})
    assert(std::abs(at(at(i).child[0]).height - at(at(i).child[1]).height) <= 1);
  return up;
}

void MovingBoxTree::refitAbove(std::int32_t node) {
  while (node != kNone) {
    node = balance(node);
    fit(node);
    node = at(node).parent;
  }
}

void MovingBoxTree::insert(const Leaf& leaf) {
  assert(leaf.object >= 0 && !isInTree(leaf.object));
  const std::int32_t fresh = newNode();
  Node& node = at(fresh);
  node.box = *leaf.box;
  node.child[0] = leaf.object;
  node.child[1] = kNone;
  node.parent = kNone;
  node.height = 0;
  setLeaf(leaf.object, fresh);
  ++count_;
  if (root_ == kNone) {
    root_ = fresh;
    return;
  }
  const std::int32_t sibling = leafBeside(*leaf.box), parent = newNode();
  replaceChild(at(sibling).parent, sibling, parent);
  at(parent).child[0] = sibling;
  at(parent).child[1] = fresh;
  at(sibling).parent = at(fresh).parent = parent;
  refitAbove(parent);
  assert(isFull() && at(root_).parent == kNone);
}

void MovingBoxTree::remove(std::int32_t object) {
  assert(isInTree(object));
  const std::int32_t leaf = leaf_of_[index(object)];
  leaf_of_[index(object)] = kNone;
  free_.push_back(leaf);
  --count_;
  const std::int32_t parent = at(leaf).parent;
  if (parent == kNone) {
    root_ = kNone;
    return;
  }
  const std::int32_t sibling = at(parent).child[at(parent).child[0] == leaf ? 1 : 0],
                     above = at(parent).parent;
  replaceChild(above, parent, sibling);
  free_.push_back(parent);
  refitAbove(above);
  assert(isFull() && at(root_).parent == kNone);
}

/// Makes the tree of these leaves in a node that is there. Two siblings are neighbours in
/// memory, and are followed by what is below the first one.
void MovingBoxTree::buildPart(const std::vector<Leaf>& leaves, Middle* first,
                              Middle* last, std::int32_t node) {
  assert(first < last);
  if (last - first == 1) {
    const Leaf& leaf = leaves[first->leaf];
    assert(!isInTree(leaf.object));
    at(node).box = *leaf.box;
    at(node).child[0] = leaf.object;
    at(node).child[1] = kNone;
    at(node).height = 0;
    setLeaf(leaf.object, node);
    return;
  }
  if (last - first <= kBoxesAhead && last - first > kBoxesAhead / 2)
    for (const Middle* middle = first; middle != last; ++middle)
      prefetch(*leaves[middle->leaf].box);
  Middle lo = *first, hi = *first;
  for (const Middle* middle = first + 1; middle != last; ++middle)
    for (int k = 0; k < 3; ++k) {
      lo.at[k] = std::min(lo.at[k], middle->at[k]);
      hi.at[k] = std::max(hi.at[k], middle->at[k]);
    }
  int axis = 0;
  for (int k = 1; k < 3; ++k)
    if (hi.at[k] - lo.at[k] > hi.at[axis] - lo.at[axis]) axis = k;
  Middle* const half = first + (last - first) / 2;
  std::nth_element(first, half, last, [axis](const Middle& x, const Middle& y) {
    return x.at[axis] < y.at[axis];
  });
  const auto left = static_cast<std::int32_t>(nodes_.size());
  nodes_.resize(nodes_.size() + 2);
  for (int c = 0; c < 2; ++c) {
    at(node).child[c] = left + c;
    at(left + c).parent = node;
  }
  buildPart(leaves, first, half, left);
  buildPart(leaves, half, last, left + 1);
  fit(node);
}

/// The leaves in the order in which this tree has them, and then the others. Neighbours
/// in space are neighbours in it, so that a tree of boxes that moved a little takes half
/// of the time to build.
std::vector<MovingBoxTree::Leaf> MovingBoxTree::inThisOrder(
    const std::vector<Leaf>& leaves) const {
  constexpr std::uint32_t kNoLeaf = ~std::uint32_t{0};
  std::vector<std::uint32_t> at_node(nodes_.size(), kNoLeaf);
  std::vector<Leaf> out, others;
  out.reserve(leaves.size());
  for (std::uint32_t i = 0; i < leaves.size(); ++i) {
    const std::size_t object = index(leaves[i].object);
    if (object < leaf_of_.size() && leaf_of_[object] != kNone)
      at_node[index(leaf_of_[object])] = i;
    else
      others.push_back(leaves[i]);
  }
  for (const std::uint32_t leaf : at_node)
    if (leaf != kNoLeaf) out.push_back(leaves[leaf]);
  out.insert(out.end(), others.begin(), others.end());
  assert(out.size() == leaves.size());
  return out;
}

void MovingBoxTree::build(const std::vector<Leaf>& unordered) {
  const std::vector<Leaf> leaves = inThisOrder(unordered);
  std::vector<Middle> middles(leaves.size());
  for (std::size_t i = 0; i < leaves.size(); ++i) {
    prefetch(*leaves[std::min<std::size_t>(i + kBoxesAhead, leaves.size() - 1)].box);
    middles[i].leaf = static_cast<std::uint32_t>(i);
    for (int k = 0; k < 3; ++k) {
      const auto& axis = leaves[i].box->axis[k];
      middles[i].at[k] = (axis[2] - axis[0]) + (axis[3] - axis[1]);
    }
  }
  clear();
  if (leaves.empty()) return;
  nodes_.reserve(2 * leaves.size());
  count_ = leaves.size();
  root_ = newNode();
  at(root_).parent = kNone;
  buildPart(leaves, middles.data(), middles.data() + middles.size(), root_);
  assert(isFull() && free_.empty());
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
