// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_QUERY_SELF_PROOFS_H
#define FCL_CCD_QUERY_SELF_PROOFS_H

#include <cstdint>
#include <vector>

#include "tree/mesh_instance.h"
#include "tree/traversal.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief The fans and regions of a mesh that are proved to be embedded, so that a
/// self-collision query leaves them out. Empty lists: none.
struct SelfProofs {
  std::vector<std::uint8_t> fans, regions;
  std::vector<std::uint32_t> nodes_in_fans;

  SelfCulling culling() const {
    return {dataOf(fans), dataOf(nodes_in_fans), dataOf(regions)};
  }

 private:
  template <typename T>
  static const T* dataOf(const std::vector<T>& x) {
    return x.empty() ? nullptr : x.data();
  }
};

/// @brief Finds what a query of a mesh with itself leaves out.
/// @param with_regions  also regions, not only fans
SelfProofs proveSelf(const MeshInstance& mesh, bool with_regions, double min_distance,
                     int num_threads);

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
