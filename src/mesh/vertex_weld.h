// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_MESH_VERTEX_WELD_H
#define FCL_CCD_MESH_VERTEX_WELD_H

#include <cassert>
#include <cmath>
#include <cstddef>
#include <vector>

namespace fcl {
namespace detail {
namespace deformable {

/// @brief Finds the vertices that coincide in all frames; see weldVertices() for what the
/// map is. It begins with all vertices joined to the first one. Each frame separates
/// those that do not coincide in it.
class VertexWeld {
 public:
  /// @param eps  finite and not negative
  VertexWeld(std::size_t num_vertices, double eps) : eps_(eps), map_(num_vertices, 0) {
    assert(eps >= 0 && std::isfinite(eps));
  }

  /// @brief Separates joined vertices that do not coincide in a frame. Those that leave a
  /// vertex are joined to each other where they coincide in this frame. With eps > 0 they
  /// may not do so in the frames before, which have to be given again.
  /// @param coordinates  x y z for each vertex, finite
  /// @return whether the map has changed
  template <typename S>
  bool refine(const S* coordinates);

  /// @brief Refines the map by frames until it no longer changes.
  /// @param refineBy  calls refine() with the frame of this number and returns its answer
  template <typename RefineBy>
  void refineByAll(std::size_t num_frames, RefineBy&& refineBy) {
    bool again = false;
    for (std::size_t i = 0; i < num_frames; ++i)
      // The map begins with all vertices joined to vertex 0, so the first frame always
      // changes it, which says nothing.
      again |= refineBy(i) && i > 0;
    // Each pass that changes the map makes the groups smaller, so that this ends.
    while (again && eps_ > 0) {
      again = false;
      for (std::size_t i = 0; i < num_frames; ++i) again |= refineBy(i);
    }
  }

  /// @brief For each vertex, the vertex that it is joined to, or itself.
  const std::vector<int>& map() const { return map_; }

  /// @brief The number of vertices that are joined to another one.
  std::size_t numJoined() const;

 private:
  double eps_;
  std::vector<int> map_;
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
