// SPDX-License-Identifier: BSD-3-Clause
//
// Distances of features by textbook formulas in floating point, for comparison with the
// library's.
#ifndef FCL_TEST_SUPPORT_FEATURE_DISTANCE_H
#define FCL_TEST_SUPPORT_FEATURE_DISTANCE_H

#include <algorithm>
#include <cmath>

#include "fcl/common/types.h"

namespace fcl {
namespace test {

/// @brief Of two segments pq and rs, which may be points.
inline double distanceOfEdges(const Vector3<double>& p, const Vector3<double>& q,
                              const Vector3<double>& r, const Vector3<double>& s) {
  using V = Vector3<double>;
  const auto toSegment = [](const V& x, const V& from, const V& to) {
    const V way = to - from;
    const double square = way.squaredNorm();
    const double along = square > 0 ? way.dot(x - from) / square : 0;
    return (x - (from + std::min(std::max(along, 0.), 1.) * way)).norm();
  };
  double best = std::min(std::min(toSegment(p, r, s), toSegment(q, r, s)),
                         std::min(toSegment(r, p, q), toSegment(s, p, q)));
  const V u = q - p, v = s - r, n = u.cross(v), w = r - p;
  const double square = n.squaredNorm();
  if (!(square > 0)) return best;
  const double along = w.cross(v).dot(n) / square, across = w.cross(u).dot(n) / square;
  if (along > 0 && along < 1 && across > 0 && across < 1)
    best = std::min(best, std::abs(n.dot(w)) / std::sqrt(square));
  return best;
}

/// @brief Of a point and a triangle abc.
inline double distanceToFace(const Vector3<double>& p, const Vector3<double>& a,
                             const Vector3<double>& b, const Vector3<double>& c) {
  using V = Vector3<double>;
  double best =
      std::min(std::min(distanceOfEdges(p, p, a, b), distanceOfEdges(p, p, b, c)),
               distanceOfEdges(p, p, c, a));
  const V n = (b - a).cross(c - a);
  const bool is_inside = (b - a).cross(p - a).dot(n) > 0 &&
                         (c - b).cross(p - b).dot(n) > 0 &&
                         (a - c).cross(p - c).dot(n) > 0;
  if (is_inside) best = std::min(best, std::abs(n.dot(p - a)) / n.norm());
  return best;
}

}  // namespace test
}  // namespace fcl

#endif
