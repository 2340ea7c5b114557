// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_WELD_H
#define FCL_CCD_WELD_H

#include <cstddef>
#include <vector>

#include "mesh_io.h"

namespace fcl_ccd {

/// @brief Whether every triangle has vertices of its own, although vertices of different
/// triangles coincide. Such a mesh was exported with split vertices (an STL always is).
bool isSoup(const Vertices& vertices, const Triangles& triangles);

/// @brief Tells which vertices are joined. Each vertex is joined to the one with the
/// lowest id with which it coincides in all frames. Two vertices coincide if no
/// coordinate differs by more than a distance. In a chain of such vertices each is joined
/// to a vertex with which it coincides itself.
class Weld {
 public:
  /// @param eps  the distance, finite and not negative.
  Weld(const Vertices& first_frame, double eps);

  /// @brief Separates joined vertices that do not coincide in another frame.
  void refine(const Vertices& frame);

  /// @brief For each vertex, the vertex that it is joined to, or itself.
  const std::vector<int>& map() const { return map_; }

  std::size_t numJoined() const;

 private:
  double eps_;
  std::vector<int> map_;
};

/// @brief Replaces the ids in the triangles by those that the vertices are joined to. A
/// triangle whose corners are joined stays, with a repeated id, so that triangles keep
/// their numbers.
void joinVertices(const std::vector<int>& map, Triangles& triangles);

}  // namespace fcl_ccd

#endif
