// SPDX-License-Identifier: BSD-3-Clause
//
// The occupied cells of an octree, as a query reads them.
#ifndef FCL_CCD_SHAPES_OCTREE_CELLS_H
#define FCL_CCD_SHAPES_OCTREE_CELLS_H

#include <cassert>
#include <cstdint>
#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "shapes/body_boxes.h"
#include "shapes/convex_shape.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief A cell by octomap's key and its depth; the root has the depth 0. As a number:
/// the key along x, y and z in 16 bits each, from the lowest bit on, then the depth.
struct OctreeCellNumber {
  static constexpr unsigned kDepth = 16;

  std::uint16_t key[3];
  unsigned depth;

  std::int64_t toNumber() const {
    assert(depth <= kDepth);
    std::int64_t number = depth;
    for (int k = 2; k >= 0; --k) number = number << 16 | key[k];
    return number;
  }
  /// @pre isNumber(number)
  static OctreeCellNumber of(std::int64_t number) {
    assert(isNumber(number));
    OctreeCellNumber out;
    for (int k = 0; k < 3; ++k)
      out.key[k] = static_cast<std::uint16_t>(number >> (16 * k) & 0xffff);
    out.depth = static_cast<unsigned>(number >> 48);
    return out;
  }
  static bool isNumber(std::int64_t number) {
    return number >= 0 && number >> 48 <= std::int64_t{kDepth};
  }

  /// @brief The place of the cell along an axis among the cells of its depth, less half
  /// of their number: the cell is from index(k) to index(k) + 1 times its size.
  double index(int k) const {
    assert(depth <= kDepth);
    return static_cast<double>(key[k] >> (kDepth - depth)) - 0.5 * (1U << depth);
  }
  /// @brief The size of the cell.
  /// @param root_size  the side of the root
  double size(double root_size) const { return root_size / (1U << depth); }
};

/// @brief The nodes of an octree where the program has them. A node that is not occupied
/// does not count, and neither does what is below it.
class OctreeNodes {
 public:
  virtual ~OctreeNodes() = default;
  /// @brief Null: there is none, or it is not occupied.
  virtual const void* root() const = 0;
  virtual bool isLeaf(const void* node) const = 0;
  /// @brief The occupied children; null for others. Bit k of a child's number: whether it
  /// is on the upper side along axis k.
  virtual void readChildren(const void* node, const void* (&children)[8]) const = 0;
};

/// @brief The nodes of an octree that a query has seen, numbered in the order in which it
/// saw them; the root is 0. No node is copied that the query does not reach. For one
/// thread.
class OctreeCells {
 public:
  /// @param root_size  the side of the root, whose center is the origin
  /// @param name  the name of the octree in errors
  OctreeCells(std::unique_ptr<const OctreeNodes> nodes, double root_size,
              std::string name);

  /// @brief Whether no cell is occupied, as far as the upper nodes tell.
  bool isEmpty() const { return is_empty_; }

  bool isLeaf(std::int32_t node) const { return at(node).is_leaf; }

  /// @brief A box around the occupied cells of a node.
  BodyBox box(std::int32_t node) const;

  /// @brief The largest coordinate of that box along a direction. It has no pad: what
  /// lies on its sides rounds as the corners of cells do.
  double reach(std::int32_t node, const Vec& direction) const;

  /// @brief The occupied children of a node have consecutive numbers. Opening a node
  /// looks a few levels further down, so that the boxes of its children are near to their
  /// cells.
  struct Children {
    std::int32_t first;
    int count;
  };
  /// @pre it is no leaf
  Children open(std::int32_t node);

  /// @brief The cell of a leaf, which is solid. Valid as long as this object.
  const ConvexShape& cell(std::int32_t leaf);

  /// @brief The number by which contacts name the cell of a leaf.
  std::int64_t number(std::int32_t leaf) const { return at(leaf).name.toNumber(); }

 private:
  /// The first and the last cell of the greatest depth along each axis, as far as is
  /// known.
  struct Bounds {
    std::uint16_t lower[3], upper[3];

    static Bounds of(const OctreeCellNumber& name);
    static Bounds none();
    void add(const Bounds& other);
    /// For assertions.
    bool contains(const Bounds& other) const;
  };
  struct Node {
    const void* node;
    OctreeCellNumber name;
    Bounds bounds;
    std::int32_t first_child;
    /// -1: not opened yet.
    std::int32_t num_children;
    /// -1: no shape yet.
    std::int32_t shape;
    /// The number of levels below it that its bounds come from.
    std::int8_t levels;
    bool is_leaf;
  };
  const Node& at(std::int32_t node) const {
    assert(0 <= node && static_cast<std::size_t>(node) < table_.size());
    return table_[static_cast<std::size_t>(node)];
  }
  Node& at(std::int32_t node) {
    assert(0 <= node && static_cast<std::size_t>(node) < table_.size());
    return table_[static_cast<std::size_t>(node)];
  }
  void add(const void* node, const OctreeCellNumber& name);
  Children addChildren(std::int32_t node);
  void lookBelow(std::int32_t node, int levels);
  /// The least bounds around the children.
  void fit(std::int32_t node);
  void openUpperNodes();

  std::unique_ptr<const OctreeNodes> nodes_;
  double root_size_;
  std::string name_;
  bool is_empty_{true};
  std::vector<Node> table_;
  std::deque<ConvexShape> shapes_;
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
