// SPDX-License-Identifier: BSD-3-Clause
//
// The triangles around a vertex. If they provably stay a fan that does not fold over
// itself during the step, two of them touch only in what they share. Then the pairs of
// features that they own need no test.
#ifndef FCL_CCD_MESH_VERTEX_FANS_H
#define FCL_CCD_MESH_VERTEX_FANS_H

#include <cassert>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/uninitialized_vector.h"

namespace fcl {
namespace detail {
namespace deformable {

class VertexCorners;
struct TreeTriangle;

/// @brief The spokes around one vertex, in order. Triangle i lies between spokes i and i
/// + 1, and all triangles have the same orientation. A closed fan has as many triangles
/// as spokes, an open one (of a vertex on the border) has one less.
struct VertexFan {
  const std::uint32_t* spokes;
  std::uint32_t count;
  bool is_closed;
};

/// @brief The fans of a mesh. A vertex has no fan if its triangles form several sheets,
/// have an edge with three triangles, or have opposite windings.
class VertexFans {
 public:
  /// Most fans have at most this number of spokes. Longer ones are at a pole or in the
  /// middle of a lid.
  static constexpr std::uint32_t kShort = 16;

  VertexFans() = default;

  /// @param triangles  in terms of places below num_vertices
  VertexFans(const std::vector<TreeTriangle>& triangles, std::size_t num_vertices);

  /// @param num_threads  as in parallelFor()
  VertexFans(const VertexCorners& corners, int num_threads);

  /// @brief Copies the fans of unchanged vertices from `before`, and makes the others.
  /// @param old_places  for the vertex at each place, its place in `before`; ~0: its fan
  /// is made from the corners
  /// @param new_places  the new places of the vertices of `before` that are spokes of
  /// copied fans
  VertexFans(const VertexFans& before, const std::vector<std::uint32_t>& old_places,
             const std::vector<std::uint32_t>& new_places, const VertexCorners& corners);

  /// @brief Moves the fans to the new places of their vertices. It allocates nothing.
  /// @param before  a copy of these fans
  /// @param new_places  of the vertex at each place
  /// @param old_places  of the vertex at each new place
  void renumber(const VertexFans& before, const std::vector<std::uint32_t>& new_places,
                const std::vector<std::uint32_t>& old_places);

  std::size_t size() const { return first_.empty() ? 0 : first_.size() - 1; }

  /// @brief The fan of the vertex at a place; without spokes if it has none.
  VertexFan operator[](std::size_t place) const {
    assert(place < size());
    const std::uint32_t first = first_[place];
    assert(first <= first_[place + 1] && first_[place + 1] - first <= longest_);
    assert(!closed_[place] || first_[place + 1] - first >= 3);
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
