// SPDX-License-Identifier: BSD-3-Clause
//
// FCL's bounding volumes as boxes in double.
#ifndef FCL_CCD_MODEL_FCL_VOLUMES_H
#define FCL_CCD_MODEL_FCL_VOLUMES_H

#include <cfloat>
#include <cmath>
#include <cstddef>
#include <limits>

#include "fcl/math/bv/AABB.h"
#include "fcl/math/bv/OBB.h"
#include "fcl/math/bv/OBBRSS.h"
#include "fcl/math/bv/RSS.h"
#include "fcl/math/bv/kDOP.h"
#include "fcl/math/bv/kIOS.h"
#include "tree/oriented_box.h"

namespace fcl {
namespace detail {
namespace deformable {

/// FCL fits a volume in S with rounding to nearest. So a point can stand out of its
/// volume by a few units in the last place of its coordinates. 2^12 units also cover axes
/// that are only nearly at right angles (isBox()). A margin that is too large costs only
/// a box test.
template <typename S>
constexpr double kFitSlack = 0x1p12 * std::numeric_limits<S>::epsilon();

/// @brief Whether a volume stores bounds along our directions. All other volumes are
/// boxes with axes of their own.
template <typename BV>
inline constexpr bool kHasSlabs = false;
template <typename S>
inline constexpr bool kHasSlabs<AABB<S>> = true;
template <typename S, std::size_t N>
inline constexpr bool kHasSlabs<KDOP<S, N>> = true;

/// @brief The oriented box that a volume is or has.
template <typename S>
OrientedBox orientedBoxOf(const OBB<S>& obb) {
  OrientedBox box;
  for (int k = 0; k < 3; ++k) {
    box.center[k] = double{obb.To[k]};
    for (int i = 0; i < 3; ++i) box.axis[i][k] = double{obb.axis(k, i)};
    box.extent[k] = double{obb.extent[k]};
  }
  return box;
}
template <typename S>
OrientedBox orientedBoxOf(const OBBRSS<S>& bv) {
  return orientedBoxOf(bv.obb);
}
template <typename S>
OrientedBox orientedBoxOf(const kIOS<S>& bv) {
  return orientedBoxOf(bv.obb);
}

/// @brief The box around a rectangle swept by a sphere. FCL chooses the rectangle so that
/// no point is further than the radius outside of a side, and it sets a negative length
/// to zero. So the box contains all points, even if a rounded corner of the volume does
/// not.
template <typename S>
OrientedBox orientedBoxOf(const RSS<S>& rss) {
  OrientedBox box;
  const double radius = double{rss.r};
  const double half[3] = {0.5 * double{rss.l[0]}, 0.5 * double{rss.l[1]}, 0};
  for (int k = 0; k < 3; ++k) {
    box.center[k] = double{rss.To[k]};
    for (int i = 0; i < 3; ++i) {
      box.axis[i][k] = double{rss.axis(k, i)};
      box.center[k] += box.axis[i][k] * half[i];
    }
    box.extent[k] = half[k] + radius;
  }
  return box;
}

/// @brief Whether the axes are unit vectors at right angles, up to an error. The error is
/// multiplied by coordinates, and so it has to be a small part of the slack by which
/// points may stand out. FCL's axes are arbitrary numbers if sums of squares of
/// coordinates have left the range of S. NaN: false.
inline bool isBox(const OrientedBox& box, double slack) {
  bool is_box = true;
  for (int i = 0; i < 3; ++i) {
    is_box &= std::abs(box.center[i]) < DBL_MAX && box.extent[i] < DBL_MAX;
    for (int j = 0; j <= i; ++j) {
      double product = i == j ? -1 : 0;
      for (int k = 0; k < 3; ++k) product += box.axis[i][k] * box.axis[j][k];
      is_box &= std::abs(product) < slack / 8;
    }
  }
  return is_box;
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
