// SPDX-License-Identifier: BSD-3-Clause
#include "broadphase/moving_box_tree.h"

#include <algorithm>
#include <cassert>

namespace fcl {
namespace detail {
namespace deformable {
namespace {

constexpr int kSides = HalfAxisBox::kSides;

LinearBox unionOf(const LinearBox& a, const LinearBox& b) {
  LinearBox out;
  for (int j = 0; j < kSides; ++j) {
    out.t0[j] = std::max(a.t0[j], b.t0[j]);
    out.t1[j] = std::max(a.t1[j], b.t1[j]);
  }
  return out;
}

/// The sum of the widths at both ends: what a random box meets grows with it.
float widthOf(const LinearBox& box) {
  float sum = 0;
  for (int j = 0; j < kSides; ++j) sum += box.t0[j] + box.t1[j];
  return sum;
}

/// Four times the center along an axis, in the middle of the step.
float middleOf(const LinearBox& box, int axis) {
  const int upper = HalfAxisBox::opposite(axis);
  return (box.t0[upper] - box.t0[axis]) + (box.t1[upper] - box.t1[axis]);
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

/// Goes down to a leaf, each time to the child that the box makes wider by less. Beside
/// a leaf, so that heights grow by one at most.
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

/// If one child is higher than the other by more than one, it takes the place of the
/// node, which takes the lower grandchild. Returns the node that is in the place now.
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

std::int32_t MovingBoxTree::buildPart(Leaf* first, Leaf* last, std::int32_t parent) {
  const std::int32_t node = newNode();
  at(node).parent = parent;
  if (last - first == 1) {
    at(node).box = first->box;
    at(node).child[0] = first->object;
    at(node).child[1] = kNone;
    at(node).height = 0;
    setPlace(first->object, node);
    return node;
  }
  float widest = -1;
  int axis = 0;
  for (int k = 0; k < 3; ++k) {
    float lo = middleOf(first->box, k), hi = lo;
    for (const Leaf* leaf = first + 1; leaf != last; ++leaf) {
      lo = std::min(lo, middleOf(leaf->box, k));
      hi = std::max(hi, middleOf(leaf->box, k));
    }
    if (hi - lo > widest) {
      widest = hi - lo;
      axis = k;
    }
  }
  Leaf* const middle = first + (last - first) / 2;
  std::nth_element(first, middle, last, [axis](const Leaf& x, const Leaf& y) {
    return middleOf(x.box, axis) < middleOf(y.box, axis);
  });
  // The vector of nodes may grow in between.
  const std::int32_t left = buildPart(first, middle, node);
  const std::int32_t right = buildPart(middle, last, node);
  at(node).child[0] = left;
  at(node).child[1] = right;
  fit(node);
  return node;
}

void MovingBoxTree::build(std::vector<Leaf>& leaves) {
  clear();
  if (leaves.empty()) return;
  nodes_.reserve(2 * leaves.size());
  count_ = leaves.size();
  root_ = buildPart(leaves.data(), leaves.data() + leaves.size(), kNone);
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
