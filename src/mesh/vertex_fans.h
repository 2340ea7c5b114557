// SPDX-License-Identifier: BSD-3-Clause
//
// The triangles around a vertex. Where they provably stay a fan that does not fold over
// itself during the step, no two of them meet but in what they share, and the pairs of
// features that they own need no test.
#ifndef FCL_CCD_MESH_VERTEX_FANS_H
#define FCL_CCD_MESH_VERTEX_FANS_H

#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/uninitialized_vector.h"

namespace fcl {
namespace detail {
namespace deformable {

class VertexCorners;
struct TreeTriangle;

/// @brief The spokes around one vertex, in order: triangle i lies between spokes i and i
/// + 1, all triangles turning the same way. A closed fan has as many triangles as spokes,
/// an open one (a vertex on the border) one less.
struct VertexFan {
  const std::uint32_t* spokes;
  std::uint32_t count;
  bool is_closed;
};

/// @brief The fans of a mesh. A vertex whose triangles form no fan (several sheets, edges
/// with three triangles, opposite windings) has none.
class VertexFans {
 public:
  /// Most fans have no more spokes. The others are long: a pole, the middle of a lid.
  static constexpr std::uint32_t kShort = 16;

  VertexFans() = default;

  /// @param triangles  in terms of places below num_vertices
  VertexFans(const std::vector<TreeTriangle>& triangles, std::size_t num_vertices);

  /// @param num_threads  as in parallelFor()
  VertexFans(const VertexCorners& corners, int num_threads);

  /// @brief Takes over the fans that other ones have, and makes the others.
  /// @param old_places  of the vertex at each place, among those of `before`; ~0: its fan
  /// is made from the corners
  /// @param new_places  of the vertices of `before` that are spokes of those taken over
  VertexFans(const VertexFans& before, const std::vector<std::uint32_t>& old_places,
             const std::vector<std::uint32_t>& new_places, const VertexCorners& corners);

  /// @brief Follows the vertices to other places; needs no memory.
  /// @param before  a copy of these fans
  /// @param new_places  of the vertex at each place
  /// @param old_places  of the vertex at each new place
  void renumber(const VertexFans& before, const std::vector<std::uint32_t>& new_places,
                const std::vector<std::uint32_t>& old_places);

  std::size_t size() const { return first_.empty() ? 0 : first_.size() - 1; }

  /// @brief The fan of the vertex at a place; without spokes if it has none.
  VertexFan operator[](std::size_t place) const {
    const std::uint32_t first = first_[place];
    return {spokes_.data() + first, first_[place + 1] - first, closed_[place] != 0};
  }

  /// @brief The largest number of spokes.
  std::uint32_t longest() const { return longest_; }

  std::size_t memUsage() const {
    return (first_.capacity() + spokes_.capacity()) * sizeof(std::uint32_t) +
           closed_.capacity();
  }

 private:
  UninitializedVector<std::uint32_t> first_;
  UninitializedVector<std::uint32_t> spokes_;
  UninitializedVector<std::uint8_t> closed_;
  std::uint32_t longest_{0};
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
