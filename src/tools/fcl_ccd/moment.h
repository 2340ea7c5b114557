// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_MOMENT_H
#define FCL_CCD_MOMENT_H

#include <optional>

#include "mesh_io.h"
#include "scene.h"

namespace fcl_ccd {

/// @brief The positions of all vertices at a time of the step, B's after A's.
Vertices verticesAt(const SceneFrame& from, const SceneFrame& to, double time);

/// @brief The scene as one mesh at a time of the step, B's vertices after A's.
Mesh meshAt(const SceneTriangles& triangles, const SceneFrame& from, const SceneFrame& to,
            double time);

/// @brief The number that a vertex has in meshAt().
inline std::size_t idInScene(const SceneVertex& vertex, const SceneFrame& frame) {
  return static_cast<std::size_t>(vertex.id) + (vertex.of_b ? frame.a->size() : 0);
}

/// @brief The number that a feature's triangle has in meshAt(), or nothing for a free
/// edge or point.
std::optional<std::size_t> triangleInScene(const SceneContact& contact,
                                           std::size_t feature,
                                           const SceneTriangles& triangles);

}  // namespace fcl_ccd

#endif
