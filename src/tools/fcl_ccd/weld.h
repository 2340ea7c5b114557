// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_WELD_H
#define FCL_CCD_WELD_H

#include <vector>

#include "mesh_io.h"

namespace fcl_ccd {

/// @brief Whether every triangle has vertices of its own, although vertices of different
/// triangles coincide. Such a mesh was exported with split vertices (an STL always is).
bool isSoup(const Vertices& vertices, const Triangles& triangles);

/// @brief Replaces the ids in the triangles by those that the vertices are joined to. A
/// triangle whose corners are joined stays, with a repeated id, so that triangles keep
/// their numbers.
void joinVertices(const std::vector<int>& map, Triangles& triangles);

/// @brief The same for free edges and points. An edge whose ends are joined stays, too.
void joinVertices(const std::vector<int>& map, FreeElements& free);

}  // namespace fcl_ccd

#endif
