// SPDX-License-Identifier: BSD-3-Clause
//
// Triangles of a polygon of many corners, in O(n log n): a line sweeps over the plane,
// and each part of the polygon that it crosses keeps the chain of corners behind it that
// have not got all of their triangles. After Hertel and Mehlhorn 1983, "Fast
// triangulation of the plane with respect to simple polygons". All decisions are exact
// (crossSign()). Where we differ: corners and edges may coincide, as in a face with holes
// that are cut open; and at the end edges are flipped towards the Delaunay triangulation
// (Lawson 1977), since the sweep alone makes thin triangles.
#ifndef FCL_CCD_SWEEP_TRIANGULATION_H
#define FCL_CCD_SWEEP_TRIANGULATION_H

#include <vector>

#include "mesh_io.h"

namespace fcl_ccd {

/// @brief Divides a polygon into triangles.
/// (1) If the polygon does not cross itself, the triangles cover it once. They turn to
/// the left, seen along the axis, or have no area where the polygon has none (a corner
/// that is given twice, a spike). (2) A crossing is not always noticed. If it is not, the
/// triangles turn to the left all the same.
/// @param axis  the polygon is seen along this axis (0 to 2)
/// @param turns_left  whether it turns to the left there, as a whole
/// @return false, with nothing added, if the polygon crosses itself
bool addSweptTriangles(const Vertices& vertices, const std::vector<int>& corners,
                       int axis, bool turns_left, Triangles& out);

}  // namespace fcl_ccd

#endif
