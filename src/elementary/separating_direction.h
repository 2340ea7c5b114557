// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_ELEMENTARY_SEPARATING_DIRECTION_H
#define FCL_CCD_ELEMENTARY_SEPARATING_DIRECTION_H

#include <algorithm>

#include "numerics/moving_vector.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief Point of segment [p, q] nearest to the origin, in floating point.
inline Vec nearestOnSegment(const Vec& p, const Vec& q) {
  const Vec e = q - p;
  const double length = dot(e, e);
  const double s = length > 0 ? std::max(0., std::min(1., -dot(p, e) / length)) : 0.;
  return p + s * e;
}

/// @brief Point of triangle pqr nearest to the origin, in floating point.
inline Vec nearestOnTriangle(const Vec& p, const Vec& q, const Vec& r) {
  const Vec n = cross(q - p, r - p);
  const double area = dot(n, n);
  if (area > 0 && dot(cross(p, q), n) >= 0 && dot(cross(q, r), n) >= 0 &&
      dot(cross(r, p), n) >= 0)
    return (dot(p, n) / area) * n;
  Vec best = nearestOnSegment(p, q);
  for (const Vec& c : {nearestOnSegment(q, r), nearestOnSegment(r, p)})
    if (dot(c, c) < dot(best, best)) best = c;
  return best;
}

/// @brief The direction from one feature to the nearest point of the other. The
/// differences of their points form a triangle (VF) or a parallelogram (EE).
/// @param corner  the corners of PairTable
inline Vec separatingDirection(const Vec* corner, bool is_triangle) {
  if (is_triangle) return nearestOnTriangle(corner[0], corner[1], corner[2]);
  // The parallelogram's corners in a circle are 0, 1, 3, 2.
  const Vec d = nearestOnTriangle(corner[0], corner[1], corner[3]),
            e = nearestOnTriangle(corner[0], corner[3], corner[2]);
  return dot(e, e) < dot(d, d) ? e : d;
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
