// SPDX-License-Identifier: BSD-3-Clause
#include "elementary/nearest_point.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "elementary/least_length.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

Vec difference(const double (&p)[3], const double (&q)[3]) {
  return {p[0] - q[0], p[1] - q[1], p[2] - q[2]};
}

/// The nearest point of a side.
NearestPoint nearestOnSide(const Vec& p, const Vec& q) {
  const Vec way = q - p;
  const double length = dot(way, way), along = -dot(p, way);
  NearestPoint near;
  if (!(along > 0)) {
    near.point = p;
  } else if (!(along < length)) {
    near.point = q;
    near.along = 1;
  } else {
    near.along = along / length;
    near.point = p + near.along * way;
  }
  assert(0 <= near.along && near.along <= 1);
  near.square = dot(near.point, near.point);
  return near;
}

/// Moves the point of a sliver to where it is nearest. The error of the weights is
/// relative to the width of the sliver, which is small. After this the error of the point
/// is relative to its length only.
void improve(const Vec& p, Vec v, Vec w, NearestPoint& near) {
  double along = near.along, across = near.across;
  const bool is_exchanged = dot(v, v) < dot(w, w);
  if (is_exchanged) {
    std::swap(v, w);
    std::swap(along, across);
  }
  const double square = dot(v, v);
  const Vec once = w - (dot(w, v) / square) * v,
            beside = once - (dot(once, v) / square) * v;
  const double width = dot(beside, beside);
  if (!(width > 0)) return;
  Vec point = near.point;
  for (int i = 0; i < 2; ++i) {
    const double back = dot(point, beside) / width;
    across -= back;
    along -= dot(point - back * w, v) / square;
    point = p + along * v + across * w;
  }
  if (is_exchanged) std::swap(along, across);
  const double reached = dot(point, point);
  if (reached < near.square) {
    near.along = along;
    near.across = across;
    near.point = point;
    near.square = reached;
  }
}

/// Whether the nearest point is inside of the polygon, of three or four corners.
/// @param[out] is_sure  whether the polygon is no sliver, where rounding is large
bool isNearestInside(const Vec* corners, int count, NearestPoint& near, bool& is_sure) {
  const Vec &p = corners[0], v = corners[1] - p, w = corners[count - 1] - p;
  near.normal = cross(v, w);
  const double square = dot(near.normal, near.normal);
  const double along = dot(cross(w, p), near.normal),
               across = dot(cross(p, v), near.normal);
  if (!(along > 0) || !(across > 0)) return false;
  if (count == 3 ? !(along + across < square) : !(along < square && across < square))
    return false;
  near.along = along / square;
  near.across = across / square;
  assert(near.along <= 1 && near.across <= 1);
  near.point = p + near.along * v + near.across * w;
  near.square = dot(near.point, near.point);
  is_sure = square > kLeastSquare && square > kSliver * (dot(v, v) * dot(w, w));
  if (is_sure) return true;
  improve(p, v, w, near);
  return near.along > 0 && near.across > 0 &&
         (count == 3 ? near.along + near.across < 1 : near.along < 1 && near.across < 1);
}

NearestPoint findNearest(const DifferencePolygon& polygon, const Vec* corners) {
  const int count = polygon.count();
  NearestPoint best;
  best.square = HUGE_VAL;
  bool is_sure = false;
  if (count > 2 && isNearestInside(corners, count, best, is_sure)) {
    if (is_sure) return best;
  } else {
    best.square = HUGE_VAL;
  }
  if (count == 1) {
    best.point = corners[0];
    best.square = dot(best.point, best.point);
    best.corner = 0;
    return best;
  }
  for (int k = 0; k < polygon.sides(); ++k) {
    const int l = polygon.next(k);
    const NearestPoint near = nearestOnSide(corners[k], corners[l]);
    if (!(near.square < best.square)) continue;
    best = near;
    if (near.along == 0 || near.along == 1)
      best.corner = near.along == 0 ? k : l;
    else
      best.side = k;
  }
  return best;
}

}  // namespace

DifferencePolygon::DifferencePolygon(ContinuousContactKind kind, const FeaturePoints& x) {
  constexpr int kCorners[] = {3, 4, 0, 2, 1};
  const int corners = kCorners[static_cast<int>(kind)];
  assert(corners > 0);
  for (int k = 0; k < corners; ++k) {
    const CornerPoints points = pointsOf(kind, k);
    add(x[points.first], x[points.second]);
  }
  // Three squares, two sums and a root: less than 4 units.
  size_ = std::sqrt(size_) * (1 + 0x1p-50);
  assert(isSizeBound());
}

/// Whether no coordinate of a corner is above size(), unless squares underflow.
bool DifferencePolygon::isSizeBound() const {
  double most = 0;
  for (int k = 0; k < count_; ++k)
    most = std::max(most, std::max(maxNorm(t0_[k]), maxNorm(t1_[k])));
  return most <= size_ || most < kLeastLength;
}

CornerPoints DifferencePolygon::pointsOf(ContinuousContactKind kind, int corner) {
  assert(corner >= 0 && corner < kMaxCorners);
  constexpr CornerPoints kEdgeEdge[] = {{0, 2}, {0, 3}, {1, 3}, {1, 2}};
  if (kind == ContinuousContactKind::kEdgeEdge) return kEdgeEdge[corner];
  return {0, 1 + corner};
}

void DifferencePolygon::add(const VertexPath& from, const VertexPath& to) {
  assert(count_ < kMaxCorners);
  t0_[count_] = difference(to.t0, from.t0);
  t1_[count_] = difference(to.t1, from.t1);
  size_ = std::max(
      size_, std::max(dot(t0_[count_], t0_[count_]), dot(t1_[count_], t1_[count_])));
  ++count_;
}

NearestPoint nearestPoint(const DifferencePolygon& polygon, const Vec* corners) {
  NearestPoint near = findNearest(polygon, corners);
  near.distance = std::sqrt(near.square);
  // Only if all squares overflow, or no coordinate is a number, no point is the nearest.
  assert(near.square < HUGE_VAL || !(0 < polygon.size() && polygon.size() < HUGE_VAL));
  assert(near.corner < polygon.count() && near.side < polygon.sides());
  return near;
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
