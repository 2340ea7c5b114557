// SPDX-License-Identifier: BSD-3-Clause
#include "broadphase/moving_box_tree.h"

#include <algorithm>
#include <cassert>

namespace fcl {
namespace detail {
namespace deformable {
namespace {

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
  place_.clear();
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

void MovingBoxTree::setPlace(std::int32_t object, std::int32_t node) {
  if (index(object) >= place_.size()) place_.resize(index(object) + 1, kNone);
  place_[index(object)] = node;
}

void MovingBoxTree::fit(std::int32_t node) {
  Node& n = at(node);
  const Node &x = at(n.child[0]), &y = at(n.child[1]);
  n.box = unionOf(x.box, y.box);
  n.height = 1 + std::max(x.height, y.height);
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
  const std::int32_t fresh = newNode();
  Node& node = at(fresh);
  node.box = leaf.box;
  node.child[0] = leaf.object;
  node.child[1] = kNone;
  node.parent = kNone;
  node.height = 0;
  setPlace(leaf.object, fresh);
  ++count_;
  if (root_ == kNone) {
    root_ = fresh;
    return;
  }
  const std::int32_t sibling = leafBeside(leaf.box), parent = newNode();
  replaceChild(at(sibling).parent, sibling, parent);
  at(parent).child[0] = sibling;
  at(parent).child[1] = fresh;
  at(sibling).parent = at(fresh).parent = parent;
  refitAbove(parent);
}

void MovingBoxTree::remove(std::int32_t object) {
  const std::int32_t leaf = place_[index(object)];
  assert(leaf != kNone);
  place_[index(object)] = kNone;
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
}

std::int32_t MovingBoxTree::buildPart(const std::vector<Leaf>& leaves, Middle* first,
                                      Middle* last, std::int32_t parent) {
  const std::int32_t node = newNode();
  at(node).parent = parent;
  if (last - first == 1) {
    const Leaf& leaf = leaves[first->leaf];
    at(node).box = leaf.box;
    at(node).child[0] = leaf.object;
    at(node).child[1] = kNone;
    at(node).height = 0;
    setPlace(leaf.object, node);
    return node;
  }
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
  // The vector of nodes may grow in between.
  const std::int32_t left = buildPart(leaves, first, half, node);
  const std::int32_t right = buildPart(leaves, half, last, node);
  at(node).child[0] = left;
  at(node).child[1] = right;
  fit(node);
  return node;
}

/// The leaves in the order in which this tree has them, and then the others. Neighbours
/// in space are neighbours in it, so that a tree of boxes that moved a little takes half
/// of the time to build.
std::vector<MovingBoxTree::Leaf> MovingBoxTree::inThisOrder(
    const std::vector<Leaf>& leaves) const {
  std::vector<const Leaf*> at_node(nodes_.size(), nullptr);
  std::vector<Leaf> out, others;
  out.reserve(leaves.size());
  for (const Leaf& leaf : leaves) {
    const std::size_t object = index(leaf.object);
    if (object < place_.size() && place_[object] != kNone)
      at_node[index(place_[object])] = &leaf;
    else
      others.push_back(leaf);
  }
  for (const Leaf* leaf : at_node)
    if (leaf) out.push_back(*leaf);
  out.insert(out.end(), others.begin(), others.end());
  return out;
}

void MovingBoxTree::build(const std::vector<Leaf>& unordered) {
  const std::vector<Leaf> leaves = inThisOrder(unordered);
  clear();
  if (leaves.empty()) return;
  std::vector<Middle> middles(leaves.size());
  for (std::size_t i = 0; i < leaves.size(); ++i) {
    const LinearBox& box = leaves[i].box;
    middles[i].leaf = static_cast<std::uint32_t>(i);
    for (int k = 0; k < 3; ++k) {
      const auto& axis = box.axis[k];
      middles[i].at[k] = (axis[2] - axis[0]) + (axis[3] - axis[1]);
    }
  }
  nodes_.reserve(2 * leaves.size());
  count_ = leaves.size();
  root_ = buildPart(leaves, middles.data(), middles.data() + middles.size(), kNone);
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
