// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_QUERY_SURROUNDINGS_H
#define FCL_CCD_QUERY_SURROUNDINGS_H

#include <mutex>

#include "elementary/flat_passage.h"
#include "query/pair_filter.h"
#include "tree/mesh_instance.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief The triangles around the features of a query. Their lists are made when they
/// are first asked for, in time proportional to the size of the meshes: few queries need
/// them. Several threads may ask at the same time.
class Surroundings {
 public:
  /// @param a, b  kept by reference; the same object for a self-collision
  Surroundings(const MeshInstance& a, const MeshInstance& b) : mesh_{&a, &b} {}

  /// @param pair  VF or EE
  /// @return without the triangles at the vertices of a face
  PairStars of(const FeatureIds& pair) const;

 private:
  void addStar(int mesh, std::uint32_t vertex, std::vector<StarTriangle>& out) const;

  const MeshInstance* mesh_[2];
  mutable std::once_flag is_listed_[2];
  mutable TrianglesAtVertices triangles_[2];
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
