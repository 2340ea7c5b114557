// SPDX-License-Identifier: BSD-3-Clause
//
// The triangles of a mesh, seen from each vertex: what fans and owners of features are
// made from.
#ifndef FCL_CCD_MESH_VERTEX_CORNERS_H
#define FCL_CCD_MESH_VERTEX_CORNERS_H

#include <cassert>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/uninitialized_vector.h"
#include "mesh/tree_nodes.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief A triangle seen from one of its vertices.
struct alignas(16) Corner {
  /// The next vertex and the one after.
  std::uint32_t next, last;
  /// 4 * (the user's number of the triangle) + k; it is vertex k of the triangle.
  std::uint32_t number;
  /// 4 * (the place of the triangle) + k.
  std::uint32_t place;
};

/// @brief The corners at one vertex. Those of a fan are in order: each begins where the
/// one before it ends. In an open fan the first has none before it; in a closed fan the
/// last is before the first.
struct CornersAtVertex {
  enum Kind : std::uint8_t { kNoFan, kOpenFan, kClosedFan };

  const Corner* corners;
  std::uint32_t count;
  Kind kind;
};

/// @brief The corners of a mesh, vertex by vertex; see VertexFans for what a fan is.
class VertexCorners {
 public:
  /// @param triangles  in terms of places below num_vertices
  /// @param num_threads  as in parallelFor(); the result does not depend on it
  VertexCorners(const std::vector<TreeTriangle>& triangles, std::size_t num_vertices,
                int num_threads);

  std::size_t size() const { return kinds_.size(); }

  CornersAtVertex operator[](std::size_t place) const {
    assert(place < size() && first_[place] <= first_[place + 1]);
    return {corners_.data() + first_[place], first_[place + 1] - first_[place],
            kinds_[place]};
  }

 private:
  std::vector<std::uint32_t> first_;
  UninitializedVector<Corner> corners_;
  UninitializedVector<CornersAtVertex::Kind> kinds_;
};

/// @brief Sets what each triangle owns, as assignFeatures().
void assignOwners(const VertexCorners& corners, int num_threads,
                  std::vector<TreeTriangle>& triangles);

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
