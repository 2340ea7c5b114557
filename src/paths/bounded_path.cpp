// SPDX-License-Identifier: BSD-3-Clause
//
// Rounding (u = 2^-53) of a motion of the program: an entry of the rotation within 64 u,
// the translation within 16 u of its size, the velocity within 128 u. This is the
// contract of BoundedMotion.
#include "paths/motion_path.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "base/error.h"
#include "numerics/error_bounds.h"
#include "paths/posed_vector.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

/// A placement or a rate of the program, if it is one.
/// @param function, name  of the program's function and of the object, for errors
BoundedMotion::Placement checked(const BoundedMotion::Placement& placement,
                                 const char* function, const char* name) {
  const auto is_finite = [](double x) { return std::isfinite(x); };
  if (std::all_of(placement.rotation, placement.rotation + 9, is_finite) &&
      std::all_of(placement.translation, placement.translation + 3, is_finite))
    return placement;
  throwBadInput(std::string(name) + ": BoundedMotion::" + function +
                " gives a number that is not finite. Correct the function");
}

/// A bound of the program, if it is one.
double checked(double bound, const char* function, const char* name) {
  if (bound >= 0 && std::isfinite(bound)) return bound * kUpward;
  throwBadInput(std::string(name) + ": BoundedMotion::" + function +
                " gives a number that is negative or not finite. Correct the function");
}

double checkedAcceleration(const BoundedMotion& motion, const char* name,
                           const Vec& center, double radius, double t0, double t1) {
  const double point[3] = {center.x, center.y, center.z};
  return checked(motion.accelerationBound(point, radius, t0, t1), "accelerationBound()",
                 name);
}

double checkedAngularSpeed(const BoundedMotion& motion, const char* name, double t0,
                           double t1) {
  return checked(motion.angularSpeedBound(t0, t1), "angularSpeedBound()", name);
}

}  // namespace

double AccelerationBound::ofProgram(const Vec& center, double radius) const {
  return checkedAcceleration(*motion, name, center, radius, t0, t1);
}

MotionPath MotionPath::bounded(const BoundedMotion& motion, const char* name) {
  const BoundedMotion::Placement rate = checked(motion.rateAt(0), "rateAt()", name);
  MotionPath path;
  path.kind_ = Kind::kBounded;
  path.motion_ = &motion;
  path.name_ = name;
  path.stretch_ = 1 + 0x1p-39;
  path.turn_speed_ = checkedAngularSpeed(motion, name, 0, 1);
  path.translation_speed_ = (norm(vecOf(rate.translation)) +
                             checkedAcceleration(motion, name, {0, 0, 0}, 0, 0, 1)) *
                            kUpward;
  path.rotation_error_ = 64;
  path.setBoundedSize();
  return path;
}

void MotionPath::setBoundedSize() {
  translation_size_ = largest_translation_ =
      (norm(vecOf(pose(0).translation)) + norm(vecOf(origin_)) + translation_speed_) *
      kUpward;
}

Pose MotionPath::boundedPose(double t) const {
  const BoundedMotion::Placement at =
      checked(motion_->placementAt(t), "placementAt()", name_);
  Pose out;
  std::copy(at.rotation, at.rotation + 9, out.rotation);
  for (int k = 0; k < 3; ++k) out.translation[k] = at.translation[k] - origin_[k];
  return out;
}

PoseRate MotionPath::boundedRate(double t) const {
  const BoundedMotion::Placement at = checked(motion_->rateAt(t), "rateAt()", name_);
  PoseRate out;
  std::copy(at.rotation, at.rotation + 9, out.rotation);
  std::copy(at.translation, at.translation + 3, out.translation);
  return out;
}

AccelerationBound MotionPath::boundedAcceleration(double t0, double t1) const {
  AccelerationBound bound{};
  bound.motion = motion_;
  bound.name = name_;
  bound.t0 = t0;
  bound.t1 = t1;
  bound.per_displacement = 2 * checkedAngularSpeed(*motion_, name_, t0, t1);
  bound.jerk = HUGE_VAL;
  return bound;
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
