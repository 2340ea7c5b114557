// SPDX-License-Identifier: BSD-3-Clause
//
// How far two convex sets are apart, and in which direction (Gilbert, Johnson, Keerthi
// 1988). A direction proves a gap; the nearest points only propose one.
#ifndef FCL_CCD_SHAPES_CONVEX_DISTANCE_H
#define FCL_CCD_SHAPES_CONVEX_DISTANCE_H

#include "shapes/posed_convex.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief Finds the gap of two convex sets.
/// @param guess  a direction from a to b
/// @param enough  ends when the gap minus this distance is at least half of the distance
/// of the points minus this distance. 0 or more.
/// @param contact  ends when the points are not further apart than this
/// @param known  corners to begin with: those of the same sets in other poses
ConvexGap convexGap(const PosedConvex& a, const PosedConvex& b, const Vec& guess,
                    double enough, double contact, const NearestCorners& known = {});

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
