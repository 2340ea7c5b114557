// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_TREE_TOPOLOGY_DIFFERENCE_H
#define FCL_CCD_TREE_TOPOLOGY_DIFFERENCE_H

#include <cstddef>
#include <cstdint>
#include <vector>

#include "tree/moving_kdop_tree.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief The triangles and vertices that a change of topology leaves as they were. A
/// triangle is the same under three conditions: it is the first one with its origin, its
/// corners are the same vertices, and the numbers of all triangles that are the same
/// ascend as before. A vertex is the same if all triangles around it are the same, and no
/// other triangle was there. Then its fan is the same, and so is the owner of each
/// feature that has it.
class TopologyDifference {
 public:
  /// No triangle, or no vertex.
  static constexpr std::uint32_t kNone = ~std::uint32_t{0};

  /// @param before  triangles in the order of a tree that has num_places_before vertices
  /// @param origins  for each new triangle the number of the triangle that it was or was
  /// cut from, or -1; empty: the triangle of the same number
  TopologyDifference(const std::vector<TreeTriangle>& before,
                     std::size_t num_places_before, TriangleArray triangles,
                     std::size_t num_triangles, std::size_t num_vertices,
                     const std::vector<int>& origins);

  /// @brief For each new triangle, the place in the tree of its origin, or kNone.
  const std::vector<std::uint32_t>& origins() const { return origins_; }

  /// @brief For each new vertex, by its id, the place in the tree of the same vertex, or
  /// kNone if it is not the same.
  const std::vector<std::uint32_t>& vertices() const { return vertices_; }

  /// @brief For each vertex of the tree, by its place, the new id, or kNone. It is known
  /// for all neighbours of vertices that are the same.
  const std::vector<std::uint32_t>& newIds() const { return new_ids_; }

 private:
  void findOrigins(const std::vector<TreeTriangle>& before, std::size_t num_triangles,
                   const std::vector<int>& origins);
  void findVertices(const std::vector<TreeTriangle>& before, TriangleArray triangles);
  void dropTriangles(const std::vector<TreeTriangle>& before, TriangleArray triangles);

  std::vector<std::uint32_t> origins_;
  /// Whether a new triangle may be the same as one of the tree, and whether one of the
  /// tree may be the same as a new one.
  std::vector<std::uint8_t> is_same_;
  std::vector<std::uint8_t> stays_;
  std::vector<std::uint32_t> vertices_;
  std::vector<std::uint32_t> new_ids_;
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
