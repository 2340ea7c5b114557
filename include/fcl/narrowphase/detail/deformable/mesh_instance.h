// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_NARROWPHASE_DETAIL_DEFORMABLE_MESH_INSTANCE_H
#define FCL_NARROWPHASE_DETAIL_DEFORMABLE_MESH_INSTANCE_H

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

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

  /// @brief Bound on the change of a coordinate of a vertex in the step. Posed
  /// coordinates are rounded at both ends, by less than 2^-49 of what they are made of.
  double displacement() const {
    double moved = 0, size = tree ? tree->reach() : rigid.reach();
    for (int k = 0; k < 3; ++k) {
      moved = std::max(moved, std::abs(translation[1][k] - translation[0][k]));
      for (int frame = 0; frame < 2; ++frame)
        size = std::max(size,
                        std::abs(translation[frame][k]) +
                            std::abs(tree ? tree->origin(frame)[k] : rigid.origin()[k]));
    }
    return (tree ? tree->displacement() : 0) + moved + 0x1p-46 * size;
  }
};

/// @brief By how much, at most, a vertex of a and one of b approach each other along x,
/// y or z in the step.
inline double approachOf(const MeshInstance& a, const MeshInstance& b) {
  return a.displacement() + b.displacement();
}

/// @brief Boxes that are further apart than this at t = 0, along a direction of theirs,
/// do not meet until `latest`; infinity if that is the end of the step, where their other
/// frame tells more. Two coordinates enter a direction; rounding up is more than what the
/// sum of two half-axes rounds.
/// @param approach  approachOf() the meshes
inline float gapUntil(double latest, double approach) {
  return latest < 1 ? roundUp(2 * latest * approach, 0.f)
                    : std::numeric_limits<float>::infinity();
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
