// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_SHAPES_CYLINDER_CORE_H
#define FCL_CCD_SHAPES_CYLINDER_CORE_H

#include <algorithm>
#include <cmath>

#include "shapes/core.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief Around the z axis, from -height / 2 to height / 2. Its pieces are its ends.
struct CylinderCore : Core {
  static constexpr int kBase = 0, kTop = 1;

  CylinderCore(double radius, double height) : Core{{radius, radius, 0.5 * height}} {}

  int pieceAt(const Vec& d) const { return d.z < 0 ? kBase : kTop; }
  Vec supportOf(int piece, const Vec& d) const {
    return onCircle(size.x, piece == kBase ? -size.z : size.z, d);
  }
  double reach(const Vec& d) const {
    return circleReach(size.x, d) + size.z * std::abs(d.z);
  }
  bool isCurved() const { return true; }
  Vec supportChange(int, const Vec& d, const Vec& change) const {
    return changeOnEllipsoid({size.x, size.y, 0}, d, change);
  }
  int axisOfRevolution() const { return 2; }
  double innerRadius() const { return std::min({size.x, size.y, size.z}); }
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
