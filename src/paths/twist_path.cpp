// SPDX-License-Identifier: BSD-3-Clause
//
// Rounding (u = 2^-53), in spectral norms and lengths. w is the length of a vector: it is
// within 2.5 u of itself, w t within 3.5 u. The axis is within 6 u, C within 12 u, D
// within 24 u. With sin and 1 - cos, at most 1 and 2 and within 4 and 8.2 u, and the
// sums, R is within 12 + 48 + 4 + 8.2 + 27 u and the error of the angle: below
// (128 + 6 w) u. C o is within 18 u |o|, D o within 27 u |o|: 18 + 54 + 4 + 8.2 + 12 u is
// below the same. R' and the velocity of the reference point about the axis have smaller
// terms, times w.
//
// v_a is within 15 u |v|, v_p within 16 u |v|, a x v_p within 25 u |v|. sin(w t) / w and
// (1 - cos(w t)) / w, at most t and 0.73 t, are within 16 u: sin(x) for x below pi / 4
// and 1 - cos(x) for x below 1 are relatively exact. So q is within 15 + 16 + 18 + 23 u
// |v|, and its sum with T1 and the turn rounds by 8 u of each: below 96 u |v| and 8 u
// |T1|. q' is within 15 + 16 + 25 + 6 + 8 u |v| and the error of the angle.
#include "paths/twist_path.h"

#include <cassert>

#include "base/default_floating_point.h"
#include "numerics/error_bounds.h"
#include "paths/path_matrix.h"
#include "paths/posed_vector.h"
#include "paths/sine.h"

namespace fcl {
namespace detail {
namespace deformable {

TwistPath::TwistPath(const Pose& pose, const Vec& linear, const Vec& angular,
                     const Vec& reference, bool is_screw)
    : pose_(pose),
      angle_(norm(angular)),
      straight_(linear),
      reference_size_(norm(reference)),
      speed_(norm(linear)) {
  assert(isRotation(pose.rotation, 0x1p-44) && !(angle_ > kMostAngle));
  // The square of a smaller angle loses digits. Such a turn moves a point by less than
  // the rounding of its coordinates.
  constexpr double kLeastAngle = 0x1p-200;
  if (angle_ < kLeastAngle) {
    angle_ = 0;
    return;
  }
  Vec axis = (1 / angle_) * angular;
  axis = (1 / norm(axis)) * axis;
  assert(isUnit(axis));
  crossColumns(axis, pose.rotation, sine_rotation_);
  crossColumns(axis, sine_rotation_, cosine_rotation_);
  sine_reference_ = rotated(sine_rotation_, reference);
  cosine_reference_ = cross(axis, sine_reference_);
  if (!is_screw) return;
  straight_ = dot(linear, axis) * axis;
  sine_way_ = linear - straight_;
  assert(!(std::abs(dot(axis, sine_way_)) > 0x1p-46 * speed_ + 0x1p-500));
  cosine_way_ = cross(axis, sine_way_);
}

BoundedMotion::Placement TwistPath::placementAt(double t) const {
  const DefaultFloatingPoint mode;
  Placement out;
  std::copy(pose_.rotation, pose_.rotation + 9, out.rotation);
  Vec at = vecOf(pose_.translation) + t * straight_;
  if (angle_ > 0) {
    const SineCosine turn = sineAndOneMinusCosine(angle_ * t);
    for (int i = 0; i < 9; ++i)
      out.rotation[i] +=
          turn.sine * sine_rotation_[i] + turn.cosine * cosine_rotation_[i];
    const Vec way =
        (turn.sine / angle_) * sine_way_ + (turn.cosine / angle_) * cosine_way_;
    at = at + (way - (turn.sine * sine_reference_ + turn.cosine * cosine_reference_));
  }
  set(out.translation, at);
  assert(isRotation(out.rotation, 0x1p-42));
  return out;
}

BoundedMotion::Placement TwistPath::rateAt(double t) const {
  const DefaultFloatingPoint mode;
  Placement out{};
  Vec at = straight_;
  if (angle_ > 0) {
    const SineCosine turn = sineCosine(angle_ * t);
    const double cosine = angle_ * turn.cosine, sine = angle_ * turn.sine;
    for (int i = 0; i < 9; ++i)
      out.rotation[i] = cosine * sine_rotation_[i] + sine * cosine_rotation_[i];
    at = at + (turn.cosine * sine_way_ + turn.sine * cosine_way_) -
         (cosine * sine_reference_ + sine * cosine_reference_);
  }
  set(out.translation, at);
  return out;
}

// p'' = w a x (w C (x - o) + v_p), turned by w t: its length does not change. The sum in
// brackets is at right angles to a, and within 24 u of the sizes of its terms.
double TwistPath::accelerationBound(const double (&center)[3], double radius, double,
                                    double) const {
  const DefaultFloatingPoint mode;
  const Vec turning = rotated(sine_rotation_, vecOf(center)) - sine_reference_,
            speed = angle_ * turning + sine_way_;
  const double rounding =
      32 * kUnit * (angle_ * (norm(center) + reference_size_) + speed_);
  return angle_ * (norm(speed) + rounding + angle_ * radius * kUpward) * kUpward;
}

double TwistPath::angularSpeedBound(double, double) const { return angle_ * kUpward; }

BoundedMotion::Rounding TwistPath::moreRounding() const {
  const DefaultFloatingPoint mode;
  const double turn = (128 + 6 * angle_) * kUnit;
  return {
      turn * kUpward, angle_ * turn * kUpward,
      (turn * reference_size_ + (96 * speed_ + 8 * norm(pose_.translation)) * kUnit) *
          kUpward,
      (angle_ * turn * reference_size_ + (96 + 6 * angle_) * kUnit * speed_) * kUpward};
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
