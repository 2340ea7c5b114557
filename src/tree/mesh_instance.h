// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_TREE_MESH_INSTANCE_H
#define FCL_CCD_TREE_MESH_INSTANCE_H

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "fcl/math/triangle.h"
#include "mesh/mesh_topology.h"
#include "mesh/vertex_frames.h"
#include "tree/moving_kdop_tree.h"
#include "tree/rigid_tree.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief A mesh as one query sees it: a tree, vertex paths in the world, and, without a
/// moving tree, the triangles. Owns nothing.
struct MeshInstance {
  VertexFrames frames;

  /// The moving tree, whose boxes are still to be moved by `translation`; null: the mesh
  /// only translates, FCL's tree is sound and `rigid` is used.
  const MovingKdopTree* tree{nullptr};
  RigidTree rigid;
  double translation[2][3]{{0, 0, 0}, {0, 0, 0}};

  /// Without a moving tree: the triangles with the features that they own. Null: each
  /// owns all its features, so that a pair of features can be met repeatedly.
  const MeshTriangle* owners{nullptr};
  const Triangle* triangles{nullptr};

  /// @brief Whether the paths of the tree's vertices are those in the world.
  bool isInPlace() const {
    for (const auto& v : translation)
      if (v[0] != 0 || v[1] != 0 || v[2] != 0) return false;
    return tree;
  }

  /// @brief Whether every feature is owned by one triangle, and a pair met once at most.
  bool hasOwners() const { return tree || owners; }

  /// @brief By how much more than in the tree a coordinate of a vertex changes in the
  /// step: as the pose moves it, and rounds it at both ends, by less than 2^-49 of what
  /// it is made of.
  double poseDisplacement() const {
    if (isInPlace()) return 0;
    double moved = 0, size = tree ? tree->reach() : rigid.reach();
    for (int k = 0; k < 3; ++k) {
      moved = std::max(moved, std::abs(translation[1][k] - translation[0][k]));
      for (int frame = 0; frame < 2; ++frame)
        size = std::max(size,
                        std::abs(translation[frame][k]) +
                            std::abs(tree ? tree->origin(frame)[k] : rigid.origin()[k]));
    }
    return moved + 0x1p-46 * size;
  }
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
