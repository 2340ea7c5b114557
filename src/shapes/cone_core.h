// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_SHAPES_CONE_CORE_H
#define FCL_CCD_SHAPES_CONE_CORE_H

#include <algorithm>
#include <cmath>

#include "shapes/core.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief Around the z axis, from the base at -height / 2 to the tip at height / 2: its
/// pieces.
struct ConeCore : Core {
  static constexpr int kBase = 0, kTip = 1;

  ConeCore(double radius, double height) : Core{{radius, radius, 0.5 * height}} {}

  int pieceAt(const Vec& d) const {
    return size.z * d.z >= circleReach(size.x, d) - size.z * d.z ? kTip : kBase;
  }
  Vec supportOf(int piece, const Vec& d) const {
    if (piece == kTip) return {0, 0, size.z};
    return onCircle(size.x, -size.z, d);
  }
  double reach(const Vec& d) const {
    return std::max(size.z * d.z, circleReach(size.x, d) - size.z * d.z);
  }
  bool isCurved() const { return true; }
  Vec supportChange(int piece, const Vec& d, const Vec& change) const {
    if (piece == kTip) return {0, 0, 0};
    return changeOnEllipsoid({size.x, size.y, 0}, d, change);
  }
  int axisOfRevolution() const { return 2; }
  /// The distance of the line from the base to the tip.
  double innerRadius() const {
    const double length = std::sqrt(size.x * size.x + 4 * size.z * size.z);
    return length > 0 ? size.x * (size.z / length) : 0;
  }
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
