// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_WELD_H
#define FCL_CCD_WELD_H

#include <cstddef>
#include <vector>

#include "mesh_io.h"

namespace fcl_ccd {

/// @brief Whether every triangle stands alone, though vertices coincide: a mesh that was
/// exported with split vertices (STL always is).
bool isSoup(const Vertices& vertices, const Triangles& triangles);

/// @brief Which vertices are joined: each has the lowest id of those that it coincides
/// with in all frames. Two coincide if no coordinate differs by more than a distance; in
/// a chain of such vertices each is joined to one that it coincides with itself.
class Weld {
 public:
  /// @param eps  the distance, finite and not negative.
  Weld(const Vertices& first_frame, double eps);

  /// @brief Parts what does not coincide in a further frame.
  void refine(const Vertices& frame);

  /// @brief For each vertex the one that it is joined to, or itself.
  const std::vector<int>& map() const { return map_; }

  std::size_t numJoined() const;

 private:
  double eps_;
  std::vector<int> map_;
};

/// @brief Gives the triangles the ids that their vertices are joined to. One whose
/// corners are joined stays, with a repeated id, so that triangles keep their numbers.
void joinVertices(const std::vector<int>& map, Triangles& triangles);

}  // namespace fcl_ccd

#endif
