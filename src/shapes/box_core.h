// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_SHAPES_BOX_CORE_H
#define FCL_CCD_SHAPES_BOX_CORE_H

#include <algorithm>
#include <cassert>
#include <cmath>

#include "shapes/core.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief From minus these sizes to these sizes. Its pieces are its corners.
struct BoxCore : Core {
  explicit BoxCore(const Vec& half_sides) : Core{half_sides} {}

  int pieceAt(const Vec& d) const {
    return (d.x > 0 ? 1 : 0) + (d.y > 0 ? 2 : 0) + (d.z > 0 ? 4 : 0);
  }
  Vec supportOf(int piece, const Vec&) const {
    assert(0 <= piece && piece < 8);
    return {piece % 2 == 0 ? -size.x : size.x, piece / 2 % 2 == 0 ? -size.y : size.y,
            piece < 4 ? -size.z : size.z};
  }
  double reach(const Vec& d) const {
    return size.x * std::abs(d.x) + size.y * std::abs(d.y) + size.z * std::abs(d.z);
  }
  bool fills(const BodyBox&) const { return true; }
  double innerRadius() const { return std::min({size.x, size.y, size.z}); }
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
