// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_TREE_MESH_INSTANCE_H
#define FCL_CCD_TREE_MESH_INSTANCE_H

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>

#include "mesh/bend.h"
#include "mesh/mesh_topology.h"
#include "mesh/vertex_frames.h"
#include "tree/moving_kdop_tree.h"
#include "tree/rigid_tree.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief A mesh as one query uses it: a tree, the vertex paths in the world, and the
/// triangles if there is no moving tree. Owns nothing.
struct MeshInstance {
  /// The name of the mesh in errors, for example "o1".
  const char* name{"the mesh"};

  VertexFrames frames;

  /// The moving tree. Its boxes are in the object's coordinates and have to be moved by
  /// `translation`. Null: the mesh is rigid, FCL's tree is sound, and `rigid` is used.
  const MovingKdopTree* tree{nullptr};
  RigidTree rigid;
  double translation[2][3]{{0, 0, 0}, {0, 0, 0}};

  /// Without a moving tree: the triangles with the features that they own. Null: each
  /// triangle owns all its features, so that a feature pair can be met repeatedly.
  const MeshTriangle* owners{nullptr};
  TriangleArray triangles;
  std::size_t num_triangles{0};

  /// How the paths of the vertices are bent. Null: they are straight. Not with a moving
  /// tree; set RigidTree::setBend() too.
  const Bend* bend{nullptr};

  /// @brief Whether the tree's vertices have the same paths as in the world.
  bool isInPlace() const {
    for (const auto& v : translation)
      if (v[0] != 0 || v[1] != 0 || v[2] != 0) return false;
    return tree;
  }

  /// @brief Whether every feature is owned by one triangle, so that a feature pair is met
  /// at most once.
  bool hasOwners() const { return tree || owners; }

  /// @brief The pose moves a vertex in addition to its motion in the tree. This is a
  /// bound on that motion along each axis. The pose also rounds both ends, by less than
  /// 2^-49 of the numbers that are added; the bound contains this.
  double poseDisplacement() const {
    if (isInPlace()) return 0;
    double moved = 0, size = tree ? tree->largestCoordinate() : rigid.largestCoordinate();
    for (int k = 0; k < 3; ++k) {
      moved = std::max(moved, std::abs(translation[1][k] - translation[0][k]));
      for (int frame = 0; frame < 2; ++frame)
        size = std::max(
            size, std::abs(translation[frame][k]) +
                      std::abs(tree ? tree->origin(frame)[k] : rigid.origin(frame)[k]));
    }
    assert(moved >= 0 && size >= 0);
    return moved + 0x1p-46 * size;
  }
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
