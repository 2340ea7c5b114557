// SPDX-License-Identifier: BSD-3-Clause
#include "motion/octree_cells.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "fcl/common/exception.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

constexpr double kUpward = 1 + 0x1p-40;

/// Child i of a cell. A key is that of the center of the cell, in cells of the greatest
/// depth; of a cell of that depth it is its own.
OctreeCellNumber childOf(const OctreeCellNumber& parent, unsigned i) {
  OctreeCellNumber child{{}, parent.depth + 1};
  const unsigned below = OctreeCellNumber::kDepth - child.depth;
  for (unsigned k = 0; k < 3; ++k) {
    const unsigned place = 2 * (unsigned{parent.key[k]} >> (below + 1)) + (i >> k & 1U);
    child.key[k] = static_cast<std::uint16_t>((place << below) + (1U << below) / 2);
  }
  return child;
}

}  // namespace

OctreeCells::OctreeCells(std::unique_ptr<const OctreeNodes> nodes, double root_size)
    : nodes_(std::move(nodes)), root_size_(root_size) {
  constexpr std::uint16_t kMiddle = 1U << (OctreeCellNumber::kDepth - 1);
  if (const void* root = nodes_->root()) add(root, {{kMiddle, kMiddle, kMiddle}, 0});
  findBounds();
}

void OctreeCells::add(const void* node, const OctreeCellNumber& name) {
  if (table_.size() >= std::numeric_limits<std::int32_t>::max())
    throw Exception("an octree has more cells near the other object than 2^31");
  table_.push_back({node, name, 0, -1, -1, nodes_->isLeaf(node)});
}

OctreeCells::Children OctreeCells::open(std::int32_t node) {
  const Node parent = at(node);
  if (parent.num_children >= 0) return {parent.first_child, parent.num_children};
  const auto first = static_cast<std::int32_t>(table_.size());
  if (parent.name.depth < OctreeCellNumber::kDepth) {
    const void* children[8];
    nodes_->readChildren(parent.node, children);
    for (unsigned i = 0; i < 8; ++i)
      if (children[i]) add(children[i], childOf(parent.name, i));
  }
  Node& opened = table_[static_cast<std::size_t>(node)];
  opened.first_child = first;
  opened.num_children = static_cast<std::int32_t>(table_.size()) - first;
  return {first, opened.num_children};
}

/// Opens the upper nodes of the octree, level by level. The boxes below these are within
/// the bounds. The root itself is far too large: 65,536 cells wide.
void OctreeCells::findBounds() {
  constexpr int kMostOpened = 256;
  std::fill(lower_, lower_ + 3, 0.5 * root_size_);
  std::fill(upper_, upper_ + 3, -0.5 * root_size_);
  int num_opened = 0;
  // Opening adds to the table.
  for (std::int32_t i = 0; static_cast<std::size_t>(i) < table_.size(); ++i) {
    if (!at(i).is_leaf && num_opened++ < kMostOpened) {
      open(i);
      continue;
    }
    is_empty_ = false;
    const OctreeCellNumber& name = at(i).name;
    const double size = name.size(root_size_);
    for (int k = 0; k < 3; ++k) {
      lower_[k] = std::min(lower_[k], name.index(k) * size);
      upper_[k] = std::max(upper_[k], (name.index(k) + 1) * size);
    }
  }
}

MotionBox OctreeCells::box(std::int32_t node) const {
  const OctreeCellNumber& name = at(node).name;
  const double size = name.size(root_size_);
  MotionBox box{};
  double far = 0, square = 0;
  for (int k = 0; k < 3; ++k) {
    const double lower = std::max(name.index(k) * size, lower_[k]),
                 upper = std::min((name.index(k) + 1) * size, upper_[k]);
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

const ConvexShape& OctreeCells::cell(std::int32_t leaf) {
  Node& node = table_[static_cast<std::size_t>(leaf)];
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
  shapes_.push_back(ConvexShape::hull(std::move(corners), 0));
  node.shape = static_cast<std::int32_t>(shapes_.size()) - 1;
  return shapes_.back();
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
