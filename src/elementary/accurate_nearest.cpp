// SPDX-License-Identifier: BSD-3-Clause
#include "elementary/accurate_nearest.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "numerics/double_double.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

/// As AccurateNearest::corners.
struct Corners {
  int i, j, k;
};

void setDifference(const Vec& p, const Vec& q, AccurateVector& out) {
  out[0] = DoubleDouble::difference(p.x, q.x);
  out[1] = DoubleDouble::difference(p.y, q.y);
  out[2] = DoubleDouble::difference(p.z, q.z);
}

/// The unit vector; zero if the vector has no length.
Vec unitOf(const AccurateVector& v) {
  Vec n{v[0].hi, v[1].hi, v[2].hi};
  const double size = maxNorm(n);
  if (!(size > 0 && std::isfinite(size))) return {0, 0, 0};
  // First by the largest component, since squares might leave the range of double.
  n = {n.x / size, n.y / size, n.z / size};
  return (1 / std::sqrt(dot(n, n))) * n;
}

/// The direction, from the origin, of the point that is nearest to it on the plane, the
/// line or the point of some corners.
Vec directionOf(const Vec* corners, const Corners& some) {
  const Vec& c = corners[some.i];
  AccurateVector p, n;
  setDifference(c, {0, 0, 0}, p);
  if (some.j < 0) return unitOf(p);
  AccurateVector v;
  setDifference(corners[some.j], c, v);
  if (some.k < 0) {
    // Without its part along v, p is v x p x v / v^2.
    AccurateVector across;
    cross(v, p, across);
    cross(across, v, n);
    return unitOf(n);
  }
  AccurateVector w;
  setDifference(corners[some.k], c, w);
  cross(v, w, n);
  const Vec unit = unitOf(n);
  return dot(n, p).hi < 0 ? -1. * unit : unit;
}

/// The corner, the side or the inside that some corners belong to, for the turn of the
/// direction. A diagonal belongs to the inside.
NearestPoint nearestOf(const DifferencePolygon& polygon, const Vec* corners,
                       const Corners& some, const Vec& n, double height) {
  NearestPoint near;
  near.distance = height;
  near.square = height * height;
  near.point = height * n;
  const int last = polygon.count() - 1;
  if (some.j < 0) {
    near.corner = some.i;
  } else if (some.k < 0 && (polygon.next(some.i) == some.j || last == 1)) {
    near.side = some.i;
  } else if (some.k < 0 && polygon.next(some.j) == some.i) {
    near.side = some.j;
  } else {
    near.normal = cross(corners[1] - corners[0], corners[last] - corners[0]);
  }
  if (near.side >= 0) {
    const Vec &from = corners[near.side], way = corners[polygon.next(near.side)] - from;
    // On the side: a point behind its end is none of the polygon.
    const double along = -dot(from, way) / dot(way, way);
    near.along = along > 0 ? std::min(along, 1.) : 0;
  }
  // Only a polygon of three corners or more has an inside.
  assert(near.corner >= 0 || near.side >= 0 || polygon.count() > 2);
  assert(near.corner < polygon.count() && near.side < polygon.sides());
  return near;
}

}  // namespace

double lowestAlong(const Vec& n, const Vec* corners, int count) {
  assert(count > 0);
  double height = dot(n, corners[0]);
  for (int k = 1; k < count; ++k) height = std::min(height, dot(n, corners[k]));
  return height;
}

AccurateNearest accurateNearest(const DifferencePolygon& polygon, const Vec* corners) {
  const int count = polygon.count();
  Vec best{0, 0, 0};
  Corners of_best{0, -1, -1};
  double height = 0;
  const auto take = [&](const Corners& some) {
    const Vec n = directionOf(corners, some);
    const double other = lowestAlong(n, corners, count);
    if (!(other > height)) return;
    best = n;
    of_best = some;
    height = other;
  };
  for (int i = 0; i < count; ++i) {
    take({i, -1, -1});
    for (int j = i + 1; j < count; ++j) {
      take({i, j, -1});
      for (int k = j + 1; k < count; ++k) take({i, j, k});
    }
  }
  AccurateNearest out;
  if (!(height > 0)) return out;
  // No corner is nearer. A vector is at most 1.8 times as long as its largest coordinate.
  assert(isDirection(best) && !(height > 3 * maxNorm(corners[0])));
  out.direction = best;
  out.near = nearestOf(polygon, corners, of_best, best, height);
  out.corners[0] = of_best.i;
  out.corners[1] = of_best.j;
  out.corners[2] = of_best.k;
  return out;
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
