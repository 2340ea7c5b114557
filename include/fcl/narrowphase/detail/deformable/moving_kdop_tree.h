// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_NARROWPHASE_DETAIL_DEFORMABLE_MOVING_KDOP_TREE_H
#define FCL_NARROWPHASE_DETAIL_DEFORMABLE_MOVING_KDOP_TREE_H

#include <cstddef>
#include <cstdint>
#include <vector>

#include "fcl/math/bv/moving_kdop.h"
#include "fcl/narrowphase/detail/deformable/mesh_topology.h"
#include "fcl/narrowphase/detail/deformable/vertex_frames.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief A binary tree of moving 16-DOPs over the triangles of a mesh, one triangle a
/// leaf. The structure is made once, by build() or from links of another tree; refit()
/// sets the boxes for a pair of frames.
///
/// Nodes lie in one array; the children of a node are neighbours and come after it, so
/// that a refit is one backward pass.
class MovingKdopTree {
 public:
  /// @brief Makes the structure by binned surface-area splits of the triangles' centroids
  /// in frame 0. Depth is at most kMaxSahDepth + 32.
  void build(const std::vector<MeshTriangle>& triangles, const VertexFrames& frames);

  /// @brief Takes the structure from links: links[i] >= 0 is the left child of node i
  /// (the right one follows it; both come after i), links[i] < 0 is leaf ~links[i].
  void setLinks(std::vector<std::int32_t> links);

  /// @brief Sets every box: the box interpolated at t contains the subtree's triangles at
  /// t, for every t in [0, 1], up to nothing: all rounding is outward.
  void refit(const std::vector<MeshTriangle>& triangles, const VertexFrames& frames);

  const std::vector<std::int32_t>& links() const { return links_; }
  bool isLeaf(int node) const { return links_[static_cast<std::size_t>(node)] < 0; }
  int leftChild(int node) const { return links_[static_cast<std::size_t>(node)]; }
  int triangle(int node) const { return ~links_[static_cast<std::size_t>(node)]; }
  const MovingKdop& box(int node) const { return boxes_[static_cast<std::size_t>(node)]; }

  /// @brief World point that the boxes are relative to.
  const double (&origin() const)[3] { return origin_; }

  /// @brief Largest distance of a vertex from the origin along an axis, in both frames.
  double reach() const { return reach_; }

  std::size_t memUsage() const;

 private:
  std::vector<std::int32_t> links_;
  std::vector<MovingKdop> boxes_;
  /// Boxes of the vertices, from which a refit makes those of the leaves.
  std::vector<MovingKdop> vertex_boxes_;
  double origin_[3]{0, 0, 0};
  double reach_{0};
};

/// From this depth on build() halves instead of searching for a good split, so that no
/// input makes a deep tree.
constexpr int kMaxSahDepth = 64;

/// @brief What to add to the sum of a box of a tree around origin_a and one of a tree
/// around origin_b, whose meshes are moved by translations on top: outward by the
/// rounding of everything that is added, and of the moved coordinates themselves.
/// @param translation_a, translation_b  [frame][axis]
/// @param reach_a, reach_b  as MovingKdopTree::reach()
KdopShift relativeShift(const double (&origin_a)[3], const double (&translation_a)[2][3],
                        double reach_a, const double (&origin_b)[3],
                        const double (&translation_b)[2][3], double reach_b);

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
