// SPDX-License-Identifier: BSD-3-Clause
//
// The nearest point of a polygon, and the direction in which it is, with twice the digits
// of a double: for pairs where rounding hides which corners are nearest.
#ifndef FCL_CCD_ELEMENTARY_ACCURATE_NEAREST_H
#define FCL_CCD_ELEMENTARY_ACCURATE_NEAREST_H

#include "elementary/nearest_point.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief The height of the lowest of some corners along a direction.
double lowestAlong(const Vec& n, const Vec* corners, int count);

/// @brief A unit direction, and the part of the polygon that it belongs to.
struct AccurateNearest {
  /// The zero vector if none was found: the polygon contains the origin, or nearly. Then
  /// the distance is 0.
  Vec direction{0, 0, 0};
  NearestPoint near{};
  /// The corners that it is perpendicular to; those that are not used are -1.
  int corners[3]{0, -1, -1};
};

/// @brief The unit direction along which the lowest corner is highest. u = 2^-53, L is
/// the largest length of a corner.
///
/// The nearest point of the polygon is on the plane, the line or the corner of one to
/// three corners, and is nearest to the origin there. So each of these is tried, in
/// DoubleDouble. The best direction differs from the true one by the rounding to double,
/// so that the height of each corner along it is at least the distance less 12 u L, as
/// computed: the components of a unit vector round by u each and its length by 5 u, a
/// product with a corner by 3 u.
///
/// nearestPoint() compares distances. Where the nearest point is near a corner, those of
/// both sides differ by the square of the way to it, which rounding hides, but their
/// directions by the way itself: what one of them leaves behind may come lower than the
/// nearest point.
/// @param corners  at one time
/// @pre the lengths of the corners are in the range of Advance
AccurateNearest accurateNearest(const DifferencePolygon& polygon, const Vec* corners);

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
