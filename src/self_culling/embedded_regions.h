// SPDX-License-Identifier: BSD-3-Clause
//
// Parts of a mesh that provably do not meet themselves during the step. Most of a smooth
// surface is in a few of them, and a query of the mesh with itself leaves them out.
#ifndef FCL_CCD_SELF_CULLING_EMBEDDED_REGIONS_H
#define FCL_CCD_SELF_CULLING_EMBEDDED_REGIONS_H

#include <cstdint>
#include <vector>

#include "kernels/kernels.h"
#include "tree/moving_kdop_tree.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief Which nodes of a tree are the roots of embedded regions, and which vertices lie
/// inside of one, with all of their triangles.
///
/// No VF or EE pair of triangles below such a node touches during the step unless it has
/// a vertex in common, nor does an edge pass through a face at its start: seen along a
/// direction all triangles keep facing it, and their border is embedded in the plane, so
/// that the plane is covered once at most at every time (doc/pipeline.md has the proof).
struct EmbeddedRegions {
  std::vector<std::uint8_t> nodes;
  std::vector<std::uint8_t> interior;
};

/// @brief Smaller regions are not worth their borders: to find those of 64 triangles
/// takes longer than it saves.
constexpr std::uint32_t kLeastRegion = 128;

/// @brief Finds the largest ones.
/// @param kernels  the answer is the same for all
/// @param num_threads  as in parallelFor(); the answer does not depend on it
/// @param least_triangles  regions of fewer, but for the whole mesh, are not looked for
/// @pre the tree has been refit
EmbeddedRegions findEmbeddedRegions(const MovingKdopTree& tree, const Kernels& kernels,
                                    int num_threads,
                                    std::uint32_t least_triangles = kLeastRegion);

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
