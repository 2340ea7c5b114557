// SPDX-License-Identifier: BSD-3-Clause
//
// The frame (R R_o, R t_o + T) of the offset (R_o, t_o). A point x of it is the point
// R_o x + t_o of the body, whose bounds hold for it. The product of the rotations and the
// sum of the translation round less than the contract of BoundedMotion allows. So what is
// more is the rounding of the body's path.
#include "paths/offset_path.h"

#include <cassert>

#include "base/default_floating_point.h"
#include "numerics/error_bounds.h"
#include "paths/path_matrix.h"
#include "paths/posed_vector.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

/// As of a pose or its derivative.
template <typename Numbers>
BoundedMotion::Placement times(const Numbers& body, const Pose& offset) {
  BoundedMotion::Placement out;
  multiply(body.rotation, offset.rotation, out.rotation);
  set(out.translation,
      rotated(body.rotation, vecOf(offset.translation)) + vecOf(body.translation));
  return out;
}

}  // namespace

OffsetPath::OffsetPath(const MotionPath& body, const Pose& offset)
    : body_(body), offset_(offset) {
  assert(isRotation(offset.rotation, 0x1p-44));
}

BoundedMotion::Placement OffsetPath::placementAt(double t) const {
  const DefaultFloatingPoint mode;
  return times(body_.pose(t), offset_);
}

BoundedMotion::Placement OffsetPath::rateAt(double t) const {
  const DefaultFloatingPoint mode;
  return times(body_.rate(t), offset_);
}

// The computed center is within 8 u of the sizes of its terms, and R_o is a rotation up
// to 2^-47.
double OffsetPath::accelerationBound(const double (&center)[3], double radius, double t0,
                                     double t1) const {
  const DefaultFloatingPoint mode;
  assert(!(radius < 0));
  const double size = norm(center) + norm(offset_.translation);
  return body_.acceleration(t0, t1).of(posed(offset_, vecOf(center)),
                                       radius * (1 + 0x1p-45) + 0x1p-48 * size);
}

double OffsetPath::angularSpeedBound(double t0, double t1) const {
  const DefaultFloatingPoint mode;
  // A point that moves in the body has this Coriolis acceleration, up to a factor of two.
  return 0.5 * body_.acceleration(t0, t1).per_displacement * (1 + 0x1p-45);
}

BoundedMotion::Rounding OffsetPath::moreRounding() const {
  const DefaultFloatingPoint mode;
  const double distance = norm(offset_.translation);
  return {body_.rotationError() * kUpward, body_.rotationRateError() * kUpward,
          body_.positionError(distance) * kUpward, body_.rateError(distance) * kUpward};
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
