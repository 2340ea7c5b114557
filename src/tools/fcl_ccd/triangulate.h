// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_TRIANGULATE_H
#define FCL_CCD_TRIANGULATE_H

#include "mesh_io.h"

namespace fcl_ccd {

/// @brief Divides faces into triangles, as the given positions ask for.
/// (1) A convex face p0 p1 p2 p3 ... becomes the fan (p0 p1 p2), (p0 p2 p3), ...
/// (2) One that is concave, seen along its normal (Newell's), loses an ear at a time
/// (Meisters 1975, "Polygons have ears"): triangles that do not overlap and are inside of
/// it. A face that crosses itself has none at some point; the rest becomes a fan.
/// (3) Triangles follow each other in the order of their faces.
Triangles triangulate(const Vertices& vertices, const Faces& faces);

}  // namespace fcl_ccd

#endif
