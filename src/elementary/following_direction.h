// SPDX-License-Identifier: BSD-3-Clause
//
// A direction that follows corners of a polygon as they move: a polynomial in time, and a
// proof that the polygon stays away from the origin along it.
#ifndef FCL_CCD_ELEMENTARY_FOLLOWING_DIRECTION_H
#define FCL_CCD_ELEMENTARY_FOLLOWING_DIRECTION_H

#include "elementary/accurate_nearest.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief How long the polygon provably stays further than d from the origin; 0 without a
/// proof. At most `longest`.
///
/// The direction is perpendicular to one to three corners at all times: c; s x (c x s)
/// for a side s that begins at c; v x w for two sides. It has no length of its own, so
/// that these are polynomials of degree 1 to 3. A direction that only turns at a constant
/// rate leaves a long feature after a time of about the root of distance / length: where
/// features are 1e9 times as long as they are apart, steps of it do not come to an end.
///
/// With the direction n(h), a corner c + h c', and a positive linear function q near |n|,
///   2 q n . (c + h c') - least (n . n + q^2) > 0
/// proves that the corner is above `least` along n, since |n| is at most (n . n + q^2) /
/// 2 q. This has degree 6 or less. Its Bernstein coefficients for [0, h] prove it.
///
/// Rounding, with u = 2^-53 and n made so long that |n(0)| = 1. Let S be the sum of the
/// lengths of the coefficients of n, times powers of h; L bounds corners. A corner is off
/// by 8 u L and a velocity, below 2 L, by 4 u L; products with n and their sums round by
/// 12 u L: 24 u L S in a height, twice that times q, which is at most S: 48 u L S^2. The
/// terms of the polynomial are below 8 L S^2 together. Each is a sum with 16 roundings,
/// 128 u L S^2; coefficients of Bernstein have 18 more, 144 u L S^2. 384 u L S^2 is more
/// than all. It is subtracted. At h = 0 it is 192 u L of the height, which has more:
/// DistanceTolerance.
/// @param corners, velocities  at h = 0
/// @param nearest  at h = 0
/// @param size  L
/// @param least  d and its margin
double followingStep(const DifferencePolygon& polygon, const Vec* corners,
                     const Vec* velocities, const AccurateNearest& nearest, double size,
                     double least, double longest);

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
