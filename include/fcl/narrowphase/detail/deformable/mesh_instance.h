// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_NARROWPHASE_DETAIL_DEFORMABLE_MESH_INSTANCE_H
#define FCL_NARROWPHASE_DETAIL_DEFORMABLE_MESH_INSTANCE_H

#include <cstddef>

#include "fcl/math/triangle.h"
#include "fcl/narrowphase/detail/deformable/mesh_topology.h"
#include "fcl/narrowphase/detail/deformable/moving_kdop_tree.h"
#include "fcl/narrowphase/detail/deformable/rigid_tree.h"
#include "fcl/narrowphase/detail/deformable/vertex_frames.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief A mesh as one query sees it: a tree, vertex paths in the world, and, without a
/// moving tree, the triangles. Owns nothing.
struct MeshInstance {
  VertexFrames frames;

  /// The moving tree, whose boxes are still to be moved by `translation`; null: the mesh
  /// only translates and `rigid` is used.
  const MovingKdopTree* tree{nullptr};
  RigidTree rigid;
  double translation[2][3]{{0, 0, 0}, {0, 0, 0}};

  /// Without a moving tree: triangles with owned features; null for a mesh that has not
  /// been prepared, whose triangles then own all their features (a pair of features can
  /// be met repeatedly).
  const MeshTriangle* prepared{nullptr};
  const Triangle* triangles{nullptr};

  /// @brief Whether the paths of the tree's vertices are those in the world.
  bool isInPlace() const {
    for (const auto& v : translation)
      if (v[0] != 0 || v[1] != 0 || v[2] != 0) return false;
    return tree;
  }

  bool hasOwners() const { return tree || prepared; }
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
