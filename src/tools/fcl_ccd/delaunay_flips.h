// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_DELAUNAY_FLIPS_H
#define FCL_CCD_DELAUNAY_FLIPS_H

#include <vector>

#include "polygon_rings.h"

namespace fcl_ccd {

/// @brief Makes triangles rounder: exchanges the common edge of two triangles for the
/// other diagonal if their angles across the edge are more than 180 degrees together
/// (Lawson 1977). Both new triangles turn to the left, decided exactly, so that the
/// triangles cover what they covered before. The number of exchanges has a bound in
/// proportion to the number of triangles.
void flipTowardsDelaunay(const PolygonRings& rings,
                         std::vector<PolygonTriangle>& triangles);

}  // namespace fcl_ccd

#endif
