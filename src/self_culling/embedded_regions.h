// SPDX-License-Identifier: BSD-3-Clause
//
// Parts of a mesh that are proved not to meet themselves during the step. Most of a
// smooth surface is in a few of them. A query of the mesh with itself leaves them out.
#ifndef FCL_CCD_SELF_CULLING_EMBEDDED_REGIONS_H
#define FCL_CCD_SELF_CULLING_EMBEDDED_REGIONS_H

#include <cstddef>
#include <cstdint>
#include <vector>

#include "kernels/kernels.h"
#include "tree/moving_kdop_tree.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief The nodes of a tree that are roots of embedded regions, and the vertices that
/// are inside of a region with all of their triangles.
///
/// No VF or EE pair of triangles below such a node touches during the step unless it has
/// a common vertex, and no edge crosses a face at t = 0. The reason: there is a direction
/// that all triangles face during the whole step, and the projection of their border
/// along it is embedded in the plane. So the region covers the plane at most once at
/// every time (doc/pipeline.md has the proof).
struct EmbeddedRegions {
  static constexpr std::uint8_t kNoDirection = 255;

  std::vector<std::uint8_t> nodes;
  std::vector<std::uint8_t> interior;
  /// For each node that is a root, the bit of the direction (kAxes) of the proof, or
  /// kNoDirection if it is a body (findEmbeddedBodies()).
  std::vector<std::uint8_t> directions;

  /// @brief No region.
  explicit EmbeddedRegions(const MovingKdopTree& tree)
      : nodes(tree.numNodes(), 0),
        interior(tree.vertices().size(), 0),
        directions(tree.numNodes(), kNoDirection) {}

  /// @brief Whether this is about the nodes and vertices of a tree.
  bool isOf(const MovingKdopTree& tree) const {
    return nodes.size() == tree.numNodes() && directions.size() == tree.numNodes() &&
           interior.size() == tree.vertices().size();
  }
};

/// @brief Least number of triangles of a region. To find regions of 64 triangles takes
/// longer than it saves.
constexpr std::uint32_t kLeastRegion = 128;

/// @brief Finds the largest embedded regions, and adds them to what is known.
/// @param kernels  the answer is the same for all
/// @param num_threads  as in parallelFor(); the answer does not depend on it
/// @param[in,out] found  nodes that are proved already. They are not searched
/// @param least_triangles  smaller regions are not searched for, except for the whole
/// mesh
/// @pre the tree has been refit
void addEmbeddedRegions(const MovingKdopTree& tree, const Kernels& kernels,
                        int num_threads, EmbeddedRegions& found,
                        std::uint32_t least_triangles = kLeastRegion);

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
