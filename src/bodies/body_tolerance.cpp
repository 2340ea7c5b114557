// SPDX-License-Identifier: BSD-3-Clause
#include "bodies/body_tolerance.h"

#include <cassert>

#include "numerics/error_bounds.h"

namespace fcl {
namespace detail {
namespace deformable {

// A distance is the difference of two posed points, projected on a direction that is
// rounded too. Its error is that of the points and 16 u of their size. A time is rounded
// by u. A pair is touching if its computed distance is at most `touching` less the error,
// and a step leaves a gap of twice the error. So `touching` is four times the error.
BodyTolerance::BodyTolerance(const MovingBody& a, const MovingBody& b,
                             double wanted_distance)
    : distance(wanted_distance), radii(coreDistance(a.shape(), b.shape(), 0)) {
  // A support function rounds by another 16 u of the size and of the speed. So does a
  // height above a flat. The rounding of its normal, times the distance of a point from
  // its foot, is part of its position error: see ConvexShape::flat().
  const double speed = a.speed() + b.speed(),
               roundings = a.shape() || b.shape() ? 48 : 16;
  position =
      (a.positionError() + b.positionError() +
       kUnit * (roundings * (a.size() + b.size()) + 4 * speed + 8 * wanted_distance)) *
      kUpward;
  rate = (a.rateError() + b.rateError() + roundings * kUnit * speed) * kUpward;
  for (const MovingBody* body : {&a, &b})
    if (body->shape() && body->shape()->flat())
      rate += body->path().rotationError() * speed * kUpward;
  touching = 4 * position;
  assert(!(distance < 0) && !(position < 0) && !(rate < 0) && !(radii < 0));
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
