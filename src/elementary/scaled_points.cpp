// SPDX-License-Identifier: BSD-3-Clause
#include "elementary/scaled_points.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "elementary/nearest_point.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

double sizeOf(ContinuousContactKind kind, const FeaturePoints& x, double distance) {
  const DifferencePolygon polygon(kind, x);
  double size = distance;
  for (int k = 0; k < polygon.count(); ++k)
    size = std::max(size, std::max(maxNorm(polygon.t0(k)), maxNorm(polygon.t1(k))));
  return size;
}

}  // namespace

ScaledPoints::ScaledPoints(ContinuousContactKind kind, const FeaturePoints& x,
                           double distance)
    : points_(x) {
  constexpr int kMostShift = 1000;
  const double size = sizeOf(kind, x, distance);
  // Features that are one point at all times have no size.
  const int shift = size == 0 ? 0 : std::isfinite(size) ? -std::ilogb(size) : -kMostShift;
  scale_ = std::ldexp(1, std::max(-kMostShift, std::min(kMostShift, shift)));
  // The largest length is about 1, unless the factor is the largest or least one.
  assert(size == 0 || scale_ == 0x1p1000 || scale_ == 0x1p-1000 ||
         (1 <= size * scale_ && size * scale_ < 2));
  for (int i = 0; i < 4; ++i) {
    if (!x.point[i]) continue;
    for (int k = 0; k < 3; ++k) {
      scaled_[i].t0[k] = x[i].t0[k] * scale_;
      scaled_[i].t1[k] = x[i].t1[k] * scale_;
    }
    points_.point[i] = &scaled_[i];
  }
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
