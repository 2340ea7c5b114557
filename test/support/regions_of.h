// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_TEST_REGIONS_OF_H
#define FCL_CCD_TEST_REGIONS_OF_H

#include <cstdint>

#include "self_culling/embedded_regions.h"

namespace fcl {
namespace test {

/// @brief The embedded regions of a tree of which nothing is known.
inline detail::deformable::EmbeddedRegions regionsOf(
    const detail::deformable::MovingKdopTree& tree,
    const detail::deformable::Kernels& kernels, int num_threads,
    std::uint32_t least_triangles = detail::deformable::kLeastRegion) {
  detail::deformable::EmbeddedRegions found(tree);
  addEmbeddedRegions(tree, kernels, num_threads, found, least_triangles);
  return found;
}

}  // namespace test
}  // namespace fcl

#endif
