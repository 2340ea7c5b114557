// SPDX-License-Identifier: BSD-3-Clause
//
// The parts of the advancement that features on other paths take too: directions that
// separate features, how they turn, and which parts of the features are nearest.
#include <cassert>
#include <cmath>
#include <utility>

#include "elementary/accurate_nearest.h"
#include "elementary/distance_advance.h"
#include "elementary/following_direction.h"
#include "elementary/least_length.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

/// n, of length 1 or less, without its parts along v and w, and with length 1; the zero
/// vector if nothing is left.
Vec perpendicular(Vec n, Vec v, Vec w) {
  assert(!(dot(n, n) > 1 + 0x1p-46));
  const auto without = [](const Vec& x, const Vec& y) {
    const double square = dot(y, y);
    return square > 0 ? x - (dot(x, y) / square) * y : x;
  };
  if (dot(v, v) < dot(w, w)) std::swap(v, w);
  // In a sliver v and w have nearly one direction. Twice is enough: what the first time
  // leaves is rounding, relative to the part that is taken away.
  const Vec across = without(without(w, v), v);
  for (int i = 0; i < 2; ++i) {
    const double length = std::sqrt(dot(n, n));
    if (!(length > kLeastLength)) return {0, 0, 0};
    n = without(without(without((1 / length) * n, v), across), v);
  }
  const double length = std::sqrt(dot(n, n));
  return length > kLeastLength ? (1 / length) * n : Vec{0, 0, 0};
}

/// n, of length 1 or less, without its part along v, and with length 1.
Vec perpendicular(Vec n, const Vec& v) {
  assert(!(dot(n, n) > 1 + 0x1p-46));
  const double square = dot(v, v);
  if (square > 0) n = n - (dot(n, v) / square) * v;
  const double length = std::sqrt(dot(n, n));
  return length > kLeastLength ? (1 / length) * n : Vec{0, 0, 0};
}

}  // namespace

Vec directionApart(const DifferencePolygon& polygon, const Vec* corners,
                   const NearestPoint& near, int attempt) {
  assert(0 <= attempt && attempt < kDirectionAttempts);
  const bool is_corner = near.corner >= 0, is_inside = !is_corner && near.side < 0;
  Vec n = near.point;
  if (is_inside && attempt == 0)
    n = (dot(near.normal, near.point) < 0 ? -1. : 1.) * near.normal;
  const double length = is_inside && attempt == 0 ? std::sqrt(dot(n, n)) : near.distance;
  if (!(length > kLeastLength)) return {0, 0, 0};
  n = (1 / length) * n;
  const int last = polygon.count() - 1;
  if (last > 1 && (attempt == 4 || (is_inside && attempt > 0)))
    return perpendicular(n, corners[1] - corners[0], corners[last] - corners[0]);
  if (is_inside || (is_corner && attempt < 2)) return n;
  const Vec& base = corners[is_corner ? near.corner : near.side];
  const Vec side = is_corner ? Vec{0, 0, 0} : corners[polygon.next(near.side)] - base;
  if (!is_corner) n = perpendicular(n, side);
  if (attempt == 0) return n;
  if (!is_corner) n = perpendicular(n, side);
  if (attempt == 1) return n;
  int lowest = 0;
  for (int k = 1; k <= last; ++k)
    if (dot(n, corners[k]) < dot(n, corners[lowest])) lowest = k;
  const Vec other = corners[lowest] - base;
  if (attempt == 2) return perpendicular(n, side, other);
  // The side from the end of this one to the lowest corner.
  return perpendicular(perpendicular(n, near.along < 0.5 ? other : other - side),
                       near.along < 0.5 ? other : other - side);
}

NearestPoint sureNearest(const DifferencePolygon& polygon, const Vec* corners,
                         const NearestPoint& near, double error) {
  const Vec n = directionApart(polygon, corners, near, 0);
  assert(isDirection(n) && error >= 0);
  const double height = lowestAlong(n, corners, polygon.count());
  return height >= near.distance - error ? near : accurateNearest(polygon, corners).near;
}

Vec turnApart(const DifferencePolygon& polygon, const Vec* corners, const Vec* velocities,
              const NearestPoint& near, const Vec& n) {
  const auto across = [&n](const Vec& v) { return v - dot(v, n) * n; };
  if (near.corner >= 0) return (1 / near.distance) * across(velocities[near.corner]);
  if (near.side >= 0) {
    const int next = polygon.next(near.side);
    const Vec side = corners[next] - corners[near.side], from = velocities[near.side],
              change = velocities[next] - from;
    const Vec beside = cross(side, n), moved = from + near.along * change;
    const double square = dot(side, side);
    return (-dot(n, change) / square) * side +
           (dot(beside, moved) / (square * near.distance)) * beside;
  }
  const int last = polygon.count() - 1;
  const Vec v = corners[1] - corners[0], w = corners[last] - corners[0],
            dv = velocities[1] - velocities[0], dw = velocities[last] - velocities[0];
  const double length = dot(near.normal, n);
  return (1 / length) * across(cross(dv, w) + cross(v, dw));
}

double firstRoot(double gap, double rate, double bend) {
  assert(gap > 0);
  const double discriminant = rate * rate - 4 * gap * bend;
  if (!(discriminant >= 0)) return HUGE_VAL;
  const double root = std::sqrt(discriminant);
  // The root has two forms. The one is used whose sum does not cancel.
  if (rate > 0) return bend < 0 ? (root + rate) / (-2 * bend) : HUGE_VAL;
  const double divisor = root - rate;
  return divisor > 0 ? 2 * gap / divisor : HUGE_VAL;
}

void setNearest(ContinuousContactKind kind, const NearestPoint& near,
                const int (&number)[4], DistanceContact& out) {
  const auto set = [&](ContinuousContactKind part, int i, int j, int k) {
    out.kind = part;
    const int points[] = {i, j, k};
    for (int m = 0; m < 3; ++m) out.points[m] = points[m] < 0 ? -1 : number[points[m]];
    out.points[3] = -1;
  };
  if (near.corner >= 0) {
    const CornerPoints p = DifferencePolygon::pointsOf(kind, near.corner);
    return set(ContinuousContactKind::kVertexVertex, p.first, p.second, -1);
  }
  if (near.side < 0 || kind == ContinuousContactKind::kVertexEdge) {
    out.kind = kind;
    for (int m = 0; m < 4; ++m) out.points[m] = number[m];
    if (kind == ContinuousContactKind::kVertexEdge) out.points[3] = -1;
    return;
  }
  if (kind == ContinuousContactKind::kVertexFace)
    return set(ContinuousContactKind::kVertexEdge, 0, 1 + near.side,
               1 + (near.side + 1) % 3);
  // A side of the parallelogram belongs to an end of one edge and to the other edge.
  constexpr int kVertex[] = {0, 3, 1, 2};
  assert(kind == ContinuousContactKind::kEdgeEdge && near.side < 4);
  const int other = near.side % 2 == 0 ? 2 : 0;
  set(ContinuousContactKind::kVertexEdge, kVertex[near.side], other, other + 1);
}

void setPart(ContinuousContactKind kind, const NearestPoint& near, const int (&number)[4],
             DistanceContact& out) {
  setNearest(kind, near, number, out);
  int* p = out.points;
  if (out.kind == ContinuousContactKind::kVertexEdge && p[2] < p[1])
    std::swap(p[1], p[2]);
  if (out.kind == ContinuousContactKind::kVertexVertex && p[1] < p[0])
    std::swap(p[0], p[1]);
  if (out.kind == kind)
    for (int m = 0; m < 4; ++m)
      if (p[m] >= 0) p[m] = m;
  assert(out.kind != ContinuousContactKind::kVertexEdge || p[1] < p[2]);
  assert(out.kind != ContinuousContactKind::kVertexVertex || p[0] < p[1]);
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
