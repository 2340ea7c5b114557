// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_TREE_RIGID_TREE_H
#define FCL_CCD_TREE_RIGID_TREE_H

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "base/prefetch.h"
#include "base/slot_cache.h"
#include "mesh/moving_kdop.h"
#include "mesh/tree_nodes.h"
#include "mesh/vertex_frames.h"
#include "tree/bent_boxes.h"
#include "tree/oriented_box.h"
#include "tree/volume_tree.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief The caller's own tree of a rigid mesh (FCL's), read as a tree of 16-DOPs. The
/// box of a node is made from the caller's bounding volume when a traversal asks for it.
/// So a query needs no time per vertex. The mesh only translates, or each vertex goes
/// straight from its place in the first pose to that in the last one. Does not own the
/// tree.
class RigidTree {
 public:
  RigidTree() = default;

  /// @pre a volume contains all triangles below it, up to its slack
  /// @param pose  its rotation is applied to the boxes. Its translation is applied by
  /// relativeShift().
  RigidTree(const VolumeTree& volumes, const Pose& pose)
      : RigidTree(volumes, pose, pose) {}

  /// @brief The same tree with other rotations at t = 0 and t = 1.
  RigidTree turned(const Pose& beginning, const Pose& end) const {
    return RigidTree(volumes_, beginning, end);
  }

  /// @brief Makes a node with up to eight children from FCL's nodes below node i.
  void open(int i, MovingKdopNode& out) const;

  /// @brief From here on the boxes of nodes contain paths that are bent.
  /// @param translation  of the mesh, at t = 0 and t = 1
  void setBend(const Bend& bend, const double (&translation)[2][3]) {
    bent_boxes_.emplace(bend, origin_, translation);
  }

  /// @brief The box of one of FCL's nodes.
  MovingKdop box(int node) const;

  /// @brief The oriented box of a node at t = 0 or t = 1, rotated. The node's 16-DOP is
  /// made from it, or from a volume inside of it. Points of the mesh stand out by at most
  /// slack() times the size of their coordinates.
  void orientedBox(int node, OrientedBox& box, int frame = 0) const;
  double slack() const { return volumes_.reader.slack; }

  /// @brief Starts to load the volume of a node into the cache.
  void prefetch(int node) const {
    constexpr std::size_t kCacheLine = 64;
    const char* const from = static_cast<const char*>(volumes_.at(node));
    for (std::size_t i = kCacheLine; i < volumes_.reader.stride; i += kCacheLine)
      prefetchMemory(from + i);
  }

  /// @brief The left child of one of FCL's nodes (the right child follows it), or
  /// ~triangle of a leaf.
  int link(int node) const { return volumes_.link(node); }

  /// @brief Whether the rotations at t = 0 and t = 1 differ.
  bool turns() const { return turns_; }

  /// @brief Whether the 16-DOPs may be much wider than the oriented boxes.
  bool isOriented() const { return !volumes_.reader.slabs || is_rotated_; }

  /// @brief The point (rotated) that the boxes at t = 0 or t = 1 are relative to.
  const double (&origin(int frame) const)[3] { return origin_[frame]; }

  /// @brief Bound on the distance of the mesh from the origin along an axis.
  double largestCoordinate() const { return largest_coordinate_; }

 private:
  static constexpr int kWidth = MovingKdopNode::kWidth;

  RigidTree(const VolumeTree& volumes, const Pose& beginning, const Pose& end);
  void setOrigin(int frame);

  void setRows(const std::int32_t (&nodes)[kWidth], MovingKdopNode& out) const;
  void roundOutward(float rounding, float (&rows)[16][kWidth]) const;
  bool containsBox(int frame, int lane, int node, const MovingKdopNode& rows) const;
  void rotate(int frame, OrientedBox& box) const;

  VolumeTree volumes_;
  bool is_rotated_{false};
  /// Whether the rotations differ.
  bool turns_{false};
  double rotation_[2][9]{{1, 0, 0, 0, 1, 0, 0, 0, 1}, {1, 0, 0, 0, 1, 0, 0, 0, 1}};
  double origin_[2][3]{};
  float origin_size_{0};
  double largest_coordinate_{0};
  /// Bound on the motion of a point along an axis that is due to the rotations.
  float displacement_{0};
  std::optional<BentBoxes> bent_boxes_;
};

/// @brief A RigidTree as one traversal reads it, with eight children per node. A small
/// table keeps the nodes that were made, since a node is met in many pairs. For one
/// thread.
class RigidTreeReader {
 public:
  /// @brief Two nodes have the same slot if their numbers differ by a multiple of this.
  static constexpr int kSlots = 64;  // 76 KiB of nodes

  explicit RigidTreeReader(const RigidTree& tree) : tree_(tree) {}

  /// @brief Node i. It is valid until the next call.
  const MovingKdopNode& node(int i) {
    assert(i >= 0);
    return nodes_.get(static_cast<unsigned>(i) % kSlots, i,
                      [&](MovingKdopNode& node) { tree_.open(i, node); });
  }

 private:
  const RigidTree& tree_;
  SlotCache<int, MovingKdopNode, kSlots> nodes_{-1};
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
