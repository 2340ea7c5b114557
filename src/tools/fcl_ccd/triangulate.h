// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_TRIANGULATE_H
#define FCL_CCD_TRIANGULATE_H

#include "mesh_io.h"

namespace fcl_ccd {

/// @brief Divides faces into triangles, by their shape at the given positions.
/// (1) A convex face p0 p1 p2 p3 ..., seen along its normal (Newell's), becomes the fan
/// (p0 p1 p2), (p0 p2 p3), ... if it turns at every corner.
/// (2) Any other face loses one ear at a time (Meisters 1975, "Polygons have ears"). The
/// triangles do not overlap and are inside of the face. A face that crosses itself may
/// have no ear at some point; then the rest becomes a fan.
/// (3) No corner of a face lies on an edge of a triangle that it is no corner of: such a
/// corner would touch the triangle, a contact of the mesh with itself. So a corner on a
/// straight run, also if it is straight up to rounding, is a corner of the triangles at
/// its edges, and no triangle is degenerate. This does not hold for a face that crosses
/// itself or has no area.
/// (4) The triangles have the order of their faces.
Triangles triangulate(const Vertices& vertices, const Faces& faces);

}  // namespace fcl_ccd

#endif
