// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_SHAPES_ELLIPSOID_CORE_H
#define FCL_CCD_SHAPES_ELLIPSOID_CORE_H

#include <algorithm>

#include "shapes/core.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief All points with (x / a)^2 + (y / b)^2 + (z / c)^2 <= 1: one piece.
struct EllipsoidCore : Core {
  explicit EllipsoidCore(const Vec& half_axes) : Core{half_axes} {}

  int pieceAt(const Vec&) const { return 0; }
  Vec supportOf(int, const Vec& d) const {
    const Vec scaled = {size.x * d.x, size.y * d.y, size.z * d.z};
    const double length = anyNorm(scaled);
    if (!(length > 0)) return {0, 0, 0};
    return {size.x * (scaled.x / length), size.y * (scaled.y / length),
            size.z * (scaled.z / length)};
  }
  double reach(const Vec& d) const {
    return anyNorm({size.x * d.x, size.y * d.y, size.z * d.z});
  }
  bool isCurved() const { return true; }
  Vec supportChange(int, const Vec& d, const Vec& change) const {
    return changeOnEllipsoid(size, d, change);
  }
  bool isBall() const { return size.x == size.y && size.y == size.z; }
  int axisOfRevolution() const {
    if (size.x == size.y) return 2;
    return size.y == size.z ? 0 : size.x == size.z ? 1 : -1;
  }
  double innerRadius() const { return std::min({size.x, size.y, size.z}); }
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
