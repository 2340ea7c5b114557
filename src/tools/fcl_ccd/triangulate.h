// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_TRIANGULATE_H
#define FCL_CCD_TRIANGULATE_H

#include "mesh_io.h"

namespace fcl_ccd {

/// @brief Divides faces into triangles, by their shape at the given positions.
/// (1) A convex face p0 p1 p2 p3 ... becomes the fan (p0 p1 p2), (p0 p2 p3), ...
/// (2) A face that is concave, seen along its normal (Newell's), loses one ear at a time
/// (Meisters 1975, "Polygons have ears"). The triangles do not overlap and are inside of
/// the face. A face that crosses itself may have no ear at some point; then the rest
/// becomes a fan.
/// (3) The triangles have the order of their faces.
Triangles triangulate(const Vertices& vertices, const Faces& faces);

}  // namespace fcl_ccd

#endif
