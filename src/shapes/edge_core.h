// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_SHAPES_EDGE_CORE_H
#define FCL_CCD_SHAPES_EDGE_CORE_H

#include <cmath>

#include "shapes/core.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief The edge of the z axis from -half_length to half_length: the core of a capsule,
/// and of a sphere. Its pieces are its ends.
struct EdgeCore : Core {
  explicit EdgeCore(double half_length) : Core{{0, 0, half_length}} {}

  int pieceAt(const Vec& d) const { return d.z > 0 ? 1 : 0; }
  Vec supportOf(int piece, const Vec&) const {
    return {0, 0, piece == 0 ? -size.z : size.z};
  }
  double reach(const Vec& d) const { return size.z * std::abs(d.z); }
  bool fills(const BodyBox&) const { return true; }
  bool isBall() const { return size.z == 0; }
  int axisOfRevolution() const { return 2; }
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
