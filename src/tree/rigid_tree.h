// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_TREE_RIGID_TREE_H
#define FCL_CCD_TREE_RIGID_TREE_H

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <cstdint>

#include "mesh/moving_kdop.h"
#include "mesh/tree_nodes.h"
#include "mesh/vertex_frames.h"
#include "tree/oriented_box.h"

namespace fcl {

template <typename BV>
class BVHModel;
struct BVNodeBase;

namespace detail {
namespace deformable {

/// @brief FCL's own tree of a mesh that only translates, read as a tree of 16-DOPs: the
/// box of a node is made from FCL's bounding volume when a traversal asks for it, so that
/// a query costs nothing per vertex. Does not own the model.
class RigidTree {
 public:
  RigidTree() = default;

  /// @tparam BV  any of FCL's
  /// @pre isTreeSound(model)
  /// @param pose  its rotation turns the boxes; its translation is left to
  /// relativeShift().
  template <typename BV>
  RigidTree(const BVHModel<BV>& model, const Pose& pose);

  /// @brief Makes a node of up to eight of FCL's below node i.
  void open(int i, MovingKdopNode& out) const;

  /// @brief The box of one of FCL's nodes, the same in both frames.
  MovingKdop box(int node) const;

  /// @brief The box that the node's 16-DOP is made from, in the rotated frame, or around
  /// what it is made from. Points of the mesh stand out by slack() times the size of
  /// their coordinates at most.
  void orientedBox(int node, OrientedBox& box) const {
    (this->*volumes_.set_box)(node, box);
  }
  double slack() const { return volumes_.slack; }

  /// @brief The left child of one of FCL's nodes, whose sibling follows it; ~triangle of
  /// a leaf.
  int link(int node) const;

  /// @brief Whether the 16-DOPs may be much wider than the oriented boxes.
  bool isOriented() const { return !volumes_.has_slabs || is_rotated_; }

  /// @brief Point (rotated frame) that the boxes are relative to.
  const double (&origin() const)[3] { return origin_; }

  /// @brief Bound on the distance of the mesh from the origin along an axis.
  double reach() const { return reach_; }

 private:
  static constexpr int kWidth = MovingKdopNode::kWidth;

  /// How bounding volumes of one kind are read.
  struct Volumes {
    std::size_t stride;
    /// By how much points can stand out of them, relative to the coordinates.
    double slack;
    /// Whether they have bounds along our directions ready.
    bool has_slabs;
    void (RigidTree::*set_box)(int node, OrientedBox& box) const;
    /// Fills the rows with the 16-DOPs of FCL's nodes.
    void (RigidTree::*set_rows)(const std::int32_t (&nodes)[kWidth],
                                MovingKdopNode& out) const;
  };
  template <typename BV>
  static Volumes volumesOf();

  RigidTree(const BVNodeBase* nodes, const Volumes& volumes, const Pose& pose);

  template <typename BV>
  void setBox(int node, OrientedBox& box) const;
  template <typename BV>
  void setRows(const std::int32_t (&nodes)[kWidth], MovingKdopNode& out) const;
  void roundOutward(float rounding, MovingKdopNode& out) const;
  void rotate(OrientedBox& box) const;

  const BVNodeBase* at(int node) const;

  const BVNodeBase* nodes_{nullptr};
  Volumes volumes_{};
  bool is_rotated_{false};
  double rotation_[9]{1, 0, 0, 0, 1, 0, 0, 0, 1};
  double origin_[3]{0, 0, 0};
  float origin_size_{0};
  double reach_{0};
};

/// @brief A RigidTree as one traversal reads it, eight children a node: what is made from
/// FCL's nodes stays in a small table, since a node is met in many pairs. For one thread.
class RigidTreeReader {
 public:
  /// @brief Nodes whose numbers differ by a multiple of it take each other's place.
  static constexpr int kSlots = 64;  // 76 KiB of nodes

  explicit RigidTreeReader(const RigidTree& tree) : tree_(tree) {
    std::fill(made_, made_ + kSlots, -1);
  }

  /// @brief The node; valid until another is asked for.
  const MovingKdopNode& node(int i) {
    assert(i >= 0);
    const int slot = i % kSlots;
    if (made_[slot] != i) {
      tree_.open(i, node_[slot]);
      made_[slot] = i;
    }
    return node_[slot];
  }

 private:
  const RigidTree& tree_;
  int made_[kSlots];
  MovingKdopNode node_[kSlots];
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
