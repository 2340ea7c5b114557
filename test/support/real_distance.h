// SPDX-License-Identifier: BSD-3-Clause
//
// Distances by textbook formulas in Real.
#ifndef FCL_TEST_SUPPORT_REAL_DISTANCE_H
#define FCL_TEST_SUPPORT_REAL_DISTANCE_H

#include <algorithm>

#include "real.h"

namespace fcl {
namespace test {

inline Real pointToSegment(const RealVector& p, const RealVector& q,
                           const RealVector& r) {
  const RealVector u = r - q;
  const Real square = u.squaredNorm();
  const Real along = square > 0 ? Real(u.dot(p - q)) / square : Real{0};
  return (p - q - std::min(std::max(along, Real{0}), Real{1}) * u).norm();
}

inline Real segmentToSegment(const RealVector& p, const RealVector& q,
                             const RealVector& r, const RealVector& s) {
  const Real ends = std::min({pointToSegment(p, r, s), pointToSegment(q, r, s),
                              pointToSegment(r, p, q), pointToSegment(s, p, q)});
  const RealVector u = q - p, v = s - r, n = u.cross(v), w = r - p;
  const Real square = n.squaredNorm();
  if (!(square > 0)) return ends;
  const Real x = w.cross(v).dot(n) / square, y = w.cross(u).dot(n) / square;
  const bool inside = x >= 0 && x <= 1 && y >= 0 && y <= 1;
  return inside ? std::min<Real>(ends, abs(Real(w.dot(n))) / sqrt(square)) : ends;
}

inline Real pointToTriangle(const RealVector& p, const RealVector& a, const RealVector& b,
                            const RealVector& c) {
  const Real border = std::min(
      {pointToSegment(p, a, b), pointToSegment(p, b, c), pointToSegment(p, c, a)});
  const RealVector n = (b - a).cross(c - a);
  const Real length = n.norm();
  if (!(length > 0) || n.dot((b - a).cross(p - a)) < 0 ||
      n.dot((c - b).cross(p - b)) < 0 || n.dot((a - c).cross(p - c)) < 0)
    return border;
  return std::min<Real>(border, abs(Real(n.dot(p - a))) / length);
}

}  // namespace test
}  // namespace fcl

#endif
