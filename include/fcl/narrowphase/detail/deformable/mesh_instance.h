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

/// @brief A mesh as one query sees it: vertex paths in the world, triangles, and a tree.
/// Owns nothing.
struct MeshInstance {
  VertexFrames frames;

  /// Triangles with owned features; null for a mesh that has not been prepared, whose
  /// triangles then own all their features (a pair of features can be met repeatedly).
  const MeshTriangle* prepared{nullptr};
  const Triangle* triangles{nullptr};
  std::size_t num_triangles{0};

  /// The moving tree, whose boxes are still to be moved by `translation`; null: the mesh
  /// only translates and `rigid` is used.
  const MovingKdopTree* tree{nullptr};
  RigidTree rigid;
  double translation[2][3]{{0, 0, 0}, {0, 0, 0}};

  MeshTriangle triangle(std::size_t i) const {
    if (prepared) return prepared[i];
    const Triangle& t = triangles[i];
    MeshTriangle out{{static_cast<std::uint32_t>(t[0]), static_cast<std::uint32_t>(t[1]),
                      static_cast<std::uint32_t>(t[2])},
                     kOwnsAll};
    // As in assignFeatures(), an edge with two equal ids is none.
    for (unsigned k = 0; k < 3; ++k)
      if (out.v[k] == out.v[(k + 1) % 3]) out.owned &= ~(1U << (3 + k));
    return out;
  }
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
