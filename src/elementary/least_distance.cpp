// SPDX-License-Identifier: BSD-3-Clause
#include "elementary/least_distance.h"

#include <algorithm>
#include <cassert>
#include <cfloat>
#include <cmath>

#include "elementary/distance_advance.h"
#include "elementary/nearest_point.h"
#include "elementary/scaled_points.h"

namespace fcl {
namespace detail {
namespace deformable {

namespace {

[[maybe_unused]] bool isAtRest(const DifferencePolygon& polygon) {
  for (int k = 0; k < polygon.count(); ++k)
    if (maxNorm(polygon.t1(k) - polygon.t0(k)) != 0) return false;
  return true;
}

double leastDistanceOf(const DifferencePolygon& polygon) {
  assert(isAtRest(polygon));
  Vec corners[DifferencePolygon::kMaxCorners];
  for (int k = 0; k < polygon.count(); ++k) corners[k] = polygon.t0(k);
  const NearestPoint near = nearestPoint(polygon, corners);
  double best = 0;
  for (int attempt = 0; attempt < kDirectionAttempts; ++attempt) {
    const Vec n = directionApart(polygon, corners, near, attempt);
    assert(isDirection(n));
    double gap = dot(n, corners[0]);
    for (int k = 1; k < polygon.count(); ++k) gap = std::min(gap, dot(n, corners[k]));
    best = std::max(best, gap);
    if (best > LeastDistance::kEnough * near.distance) break;
  }
  const double least =
      best * (1 - LeastDistance::kOfGap) - LeastDistance::kOfSize * polygon.size();
  // A point of the polygon was found there.
  assert(least <= near.distance + DistanceTolerance(0, polygon.size()).distance_error);
  return least > 0 ? least : 0;
}

}  // namespace

double leastDistance(ContinuousContactKind kind, const FeaturePoints& x) {
  const DifferencePolygon polygon(kind, x);
  if (polygon.size() >= Advance::kLeastSize && polygon.size() <= Advance::kMostSize)
    return leastDistanceOf(polygon);
  const ScaledPoints scaled(kind, x, 0);
  const double least =
      leastDistanceOf(DifferencePolygon(kind, scaled.points())) / scaled.scale();
  // A subnormal number is rounded, one that is not finite no bound.
  if (least < DBL_MIN) return least > 0 ? std::nextafter(least, 0.) : 0;
  return std::min(least, DBL_MAX);
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
