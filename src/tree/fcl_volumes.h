// SPDX-License-Identifier: BSD-3-Clause
//
// FCL's bounding volumes as boxes in double.
#ifndef FCL_CCD_TREE_FCL_VOLUMES_H
#define FCL_CCD_TREE_FCL_VOLUMES_H

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

/// FCL fits a volume in S with rounding to nearest, so that a point can stand out of its
/// volume by a few units in the last place of its coordinates; 2^12 units leave room for
/// axes that are at right angles only nearly (isBox()). Too large a margin costs only a
/// box test.
template <typename S>
constexpr double kFitSlack = 0x1p12 * std::numeric_limits<S>::epsilon();

/// @brief Whether a volume has bounds along our directions ready. All others are boxes
/// with axes of their own.
template <typename BV>
inline constexpr bool kHasSlabs = false;
template <typename S>
inline constexpr bool kHasSlabs<AABB<S>> = true;
template <typename S, std::size_t N>
inline constexpr bool kHasSlabs<KDOP<S, N>> = true;

/// @brief The oriented box that a volume is, or has beside other volumes.
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
/// no point lies further than the radius beyond a side, and clips a length that would be
/// negative: the box contains the points even where rounded corners leave one out.
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

/// @brief Whether axes are unit vectors at right angles but for an error that is a part
/// of what points may stand out, which it multiplies as their coordinates do. FCL's are
/// mere numbers where sums of squares of coordinates left the range of S. NaN: false.
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
