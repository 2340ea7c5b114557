// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_NARROWPHASE_DETAIL_DEFORMABLE_RIGID_TREE_H
#define FCL_NARROWPHASE_DETAIL_DEFORMABLE_RIGID_TREE_H

#include <algorithm>
#include <cstddef>

#include "fcl/geometry/bvh/BVH_model.h"
#include "fcl/math/bv/moving_kdop.h"
#include "fcl/narrowphase/detail/deformable/moving_kdop_tree.h"
#include "fcl/narrowphase/detail/deformable/vertex_frames.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief FCL's own tree of a mesh that only translates, read as a tree of 16-DOPs: the
/// box of a node is made from FCL's bounding volume when a traversal asks for it, so that
/// a query costs nothing per vertex. Does not own the model.
class RigidTree {
 public:
  RigidTree() = default;

  /// @tparam BV  any of FCL's but RSS, whose refit trees are no bounds.
  /// @param pose  its rotation turns the boxes; its translation is left to
  /// relativeShift().
  template <typename BV>
  RigidTree(const BVHModel<BV>& model, const Pose& pose)
      : RigidTree(&model.getBV(0), sizeof(BVNode<BV>), &boxOf<BV>, slabsOf<BV>(), pose) {}

  /// @brief Makes a node of up to eight of FCL's below node i.
  void open(int i, MovingKdopNode& out) const;

  /// @brief Makes the box of one of FCL's nodes, the same in both frames.
  void makeBox(int node, MovingKdop& box) const;
  MovingKdop box(int node) const {
    MovingKdop made;
    makeBox(node, made);
    return made;
  }

  /// @brief Point (rotated frame) that the boxes are relative to.
  const double (&origin() const)[3] { return origin_; }

  /// @brief Bound on the distance of the mesh from the origin along an axis.
  double reach() const { return reach_; }

 private:
  /// A box in the model frame that contains a bounding volume: half axes as columns.
  struct OrientedBox {
    double center[3];
    double half_axis[3][3];
    /// Relative rounding of the volume's own numbers, see boxOf().
    double slack;
  };
  using BoxOf = OrientedBox (*)(const void* node);

  /// Bounds along the 8 directions, which AABBs and FCL's KDOPs have ready; null for
  /// others.
  struct Slabs {
    double lo[8];
    double hi[8];
    double slack;
  };
  using SlabsOf = Slabs (*)(const void* node);

  template <typename BV>
  static OrientedBox boxOf(const void* node);

  template <typename BV>
  static SlabsOf slabsOf();

  RigidTree(const BVNodeBase* nodes, std::size_t stride, BoxOf box_of, SlabsOf slabs_of,
            const Pose& pose);

  const BVNodeBase* at(int node) const {
    return reinterpret_cast<const BVNodeBase*>(reinterpret_cast<const char*>(nodes_) +
                                               static_cast<std::size_t>(node) * stride_);
  }
  int link(int node) const { return at(node)->first_child; }
  OrientedBox rotated(int node) const;
  void fromSlabs(const Slabs& slabs, MovingKdop& box) const;

  const BVNodeBase* nodes_{nullptr};
  std::size_t stride_{0};
  BoxOf box_of_{nullptr};
  SlabsOf slabs_of_{nullptr};  // null when rotated
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
  explicit RigidTreeReader(const RigidTree& tree) : tree_(tree) {
    std::fill(made_, made_ + kSlots, -1);
  }

  /// @brief The node; valid until another is asked for.
  const MovingKdopNode& node(int i) {
    const int slot = i % kSlots;
    if (made_[slot] != i) {
      tree_.open(i, node_[slot]);
      made_[slot] = i;
    }
    return node_[slot];
  }

 private:
  static constexpr int kSlots = 64;  // 68 KiB of nodes
  const RigidTree& tree_;
  int made_[kSlots];
  MovingKdopNode node_[kSlots];
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
