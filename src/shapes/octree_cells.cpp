// SPDX-License-Identifier: BSD-3-Clause
#include "shapes/octree_cells.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

#include "base/error.h"
#include "numerics/error_bounds.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

/// Child i of a cell. The key of a cell is that of the cell of the greatest depth at its
/// center. A cell of the greatest depth has its own key.
OctreeCellNumber childOf(const OctreeCellNumber& parent, unsigned i) {
  assert(parent.depth < OctreeCellNumber::kDepth && i < 8);
  OctreeCellNumber child{{}, parent.depth + 1};
  const unsigned below = OctreeCellNumber::kDepth - child.depth;
  for (unsigned k = 0; k < 3; ++k) {
    const unsigned number = 2 * (unsigned{parent.key[k]} >> (below + 1)) + (i >> k & 1U);
    child.key[k] = static_cast<std::uint16_t>((number << below) + (1U << below) / 2);
  }
  return child;
}

/// Whether a box contains a cell. Its sides are parallel to the axes. For assertions.
[[maybe_unused]] bool isInBox(const ConvexShape& cell, const BodyBox& box) {
  for (int k = 0; k < 3; ++k)
    for (const double side : {-1., 1.}) {
      const Vec out = {k == 0 ? side : 0, k == 1 ? side : 0, k == 2 ? side : 0};
      if (cell.reach(out) > side * box.center[k] + box.extent[k] + box.pad) return false;
    }
  return true;
}

/// The number of levels below the children of an opened node that its boxes come from.
/// More of them make the boxes tighter, and read nodes that the query may not need.
constexpr int kLevelsAhead = 2;

}  // namespace

OctreeCells::Bounds OctreeCells::Bounds::of(const OctreeCellNumber& name) {
  Bounds bounds;
  const unsigned width = 1U << (OctreeCellNumber::kDepth - name.depth);
  for (int k = 0; k < 3; ++k) {
    const unsigned first = name.key[k] & ~(width - 1);
    bounds.lower[k] = static_cast<std::uint16_t>(first);
    bounds.upper[k] = static_cast<std::uint16_t>(first + width - 1);
  }
  return bounds;
}

OctreeCells::Bounds OctreeCells::Bounds::none() {
  return {{0xffff, 0xffff, 0xffff}, {0, 0, 0}};
}

void OctreeCells::Bounds::add(const Bounds& other) {
  for (int k = 0; k < 3; ++k) {
    lower[k] = std::min(lower[k], other.lower[k]);
    upper[k] = std::max(upper[k], other.upper[k]);
  }
}

bool OctreeCells::Bounds::contains(const Bounds& other) const {
  for (int k = 0; k < 3; ++k)
    if (other.lower[k] < lower[k] || other.upper[k] > upper[k]) return false;
  return true;
}

OctreeCells::OctreeCells(std::unique_ptr<const OctreeNodes> nodes, double root_size,
                         std::string name)
    : nodes_(std::move(nodes)), root_size_(root_size), name_(std::move(name)) {
  constexpr std::uint16_t kMiddle = 1U << (OctreeCellNumber::kDepth - 1);
  if (const void* root = nodes_->root()) add(root, {{kMiddle, kMiddle, kMiddle}, 0});
  openUpperNodes();
}

void OctreeCells::add(const void* node, const OctreeCellNumber& name) {
  if (table_.size() >= std::numeric_limits<std::int32_t>::max())
    throwBadInput(name_ +
                  ": the octree has more than 2^31 nodes near the other object. Divide "
                  "the map");
  table_.push_back({node, name, Bounds::of(name), 0, -1, -1, 0, nodes_->isLeaf(node)});
}

OctreeCells::Children OctreeCells::addChildren(std::int32_t node) {
  const Node parent = at(node);
  if (parent.num_children >= 0) return {parent.first_child, parent.num_children};
  const auto first = static_cast<std::int32_t>(table_.size());
  if (parent.name.depth < OctreeCellNumber::kDepth) {
    const void* children[8];
    nodes_->readChildren(parent.node, children);
    for (unsigned i = 0; i < 8; ++i)
      if (children[i]) add(children[i], childOf(parent.name, i));
  }
  assert(std::all_of(table_.begin() + first, table_.end(), [&](const Node& child) {
    return Bounds::of(parent.name).contains(child.bounds);
  }));
  Node& opened = at(node);
  opened.first_child = first;
  opened.num_children = static_cast<std::int32_t>(table_.size()) - first;
  assert(0 <= opened.num_children && opened.num_children <= 8);
  return {first, opened.num_children};
}

OctreeCells::Children OctreeCells::open(std::int32_t node) {
  assert(!isLeaf(node));
  lookBelow(node, 1 + kLevelsAhead);
  assert(at(node).num_children >= 0);
  return {at(node).first_child, at(node).num_children};
}

void OctreeCells::lookBelow(std::int32_t node, int levels) {
  if (at(node).is_leaf || at(node).levels >= levels) return;
  const Children children = addChildren(node);
  for (std::int32_t i = children.first; levels > 1 && i < children.first + children.count;
       ++i)
    lookBelow(i, levels - 1);
  fit(node);
  at(node).levels = static_cast<std::int8_t>(levels);
}

void OctreeCells::fit(std::int32_t node) {
  const Node& parent = at(node);
  assert(parent.num_children >= 0);
  Bounds bounds = Bounds::none();
  for (std::int32_t i = 0; i < parent.num_children; ++i)
    bounds.add(at(parent.first_child + i).bounds);
  assert(parent.bounds.contains(bounds));
  at(node).bounds = bounds;
}

/// Opens the upper nodes of the octree, level by level. The root itself is far too large:
/// 65,536 cells wide.
void OctreeCells::openUpperNodes() {
  constexpr int kMostOpened = 256;
  int num_opened = 0;
  // Opening adds to the table, below.
  for (std::int32_t i = 0; static_cast<std::size_t>(i) < table_.size(); ++i)
    if (!at(i).is_leaf && num_opened++ < kMostOpened)
      addChildren(i);
    else
      is_empty_ = false;
  for (auto i = static_cast<std::int32_t>(table_.size()) - 1; i >= 0; --i)
    if (at(i).num_children >= 0) fit(i);
}

BodyBox OctreeCells::box(std::int32_t node) const {
  const Bounds& bounds = at(node).bounds;
  constexpr double kMiddle = 1U << (OctreeCellNumber::kDepth - 1);
  const double unit = root_size_ / (2 * kMiddle);
  BodyBox box{};
  double far = 0, square = 0;
  for (int k = 0; k < 3; ++k) {
    const double lower = (bounds.lower[k] - kMiddle) * unit,
                 upper = (bounds.upper[k] + 1 - kMiddle) * unit;
    box.center[k] = 0.5 * (lower + upper);
    box.extent[k] = std::max(0.5 * (upper - lower), 0.);
    box.axis[k][k] = 1;
    far += std::abs(box.center[k]);
    square += box.extent[k] * box.extent[k];
  }
  // Every number above rounds by less than this.
  box.pad = 0x1p-45 * (far + std::sqrt(square));
  box.radius = std::sqrt(square) * kUpward + box.pad;
  return box;
}

double OctreeCells::reach(std::int32_t node, const Vec& direction) const {
  const Bounds& bounds = at(node).bounds;
  constexpr double kMiddle = 1U << (OctreeCellNumber::kDepth - 1);
  const double unit = root_size_ / (2 * kMiddle);
  const auto corner = [&](int k, double along) {
    return ((along < 0 ? bounds.lower[k] : bounds.upper[k] + 1) - kMiddle) * unit;
  };
  return dot(direction,
             Vec{corner(0, direction.x), corner(1, direction.y), corner(2, direction.z)});
}

const ConvexShape& OctreeCells::cell(std::int32_t leaf) {
  Node& node = at(leaf);
  assert(node.is_leaf);
  if (node.shape >= 0) return shapes_[static_cast<std::size_t>(node.shape)];
  const double size = node.name.size(root_size_);
  // Neighbours have equal corners.
  const auto corner = [&](unsigned i, int k) {
    return (node.name.index(k) + (i >> k & 1U)) * size;
  };
  std::vector<Vec> corners;
  corners.reserve(8);
  for (unsigned i = 0; i < 8; ++i)
    corners.push_back({corner(i, 0), corner(i, 1), corner(i, 2)});
  shapes_.push_back(ConvexShape::hull(std::move(corners)));
  assert(isInBox(shapes_.back(), box(leaf)));
  node.shape = static_cast<std::int32_t>(shapes_.size()) - 1;
  return shapes_.back();
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
