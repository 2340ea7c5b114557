// SPDX-License-Identifier: BSD-3-Clause
//
// Rounding (u = 2^-53) of a motion of the program: an entry of the rotation within 64 u,
// the translation within 16 u of its size, the velocity within 128 u, and what the motion
// says in moreRounding(). This is the contract of BoundedMotion.
#include "paths/motion_path.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <string>

#include "base/error.h"
#include "numerics/error_bounds.h"
#include "paths/chain_path.h"
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

BoundedMotion::Rounding checkedRounding(const BoundedMotion& motion, const char* name) {
  const BoundedMotion::Rounding more = motion.moreRounding();
  for (const double x :
       {more.rotation, more.rotation_rate, more.translation, more.translation_rate})
    checked(x, "moreRounding()", name);
  return more;
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

bool MotionPath::hasSteadyAcceleration() const {
  return hasConstantAcceleration() || (link_ && link_->isSteady());
}

MotionPath MotionPath::bounded(const BoundedMotion& motion, const char* name) {
  MotionPath path;
  const auto* const link = dynamic_cast<const LinkPath*>(&motion);
  if (link && link->keptPath()) {
    path = *link->keptPath();
    path.name_ = name;
    return path;
  }
  path.kind_ = Kind::kBounded;
  path.motion_ = &motion;
  path.link_ = link;
  path.name_ = name;
  path.stretch_ = 1 + 0x1p-39;
  path.turn_speed_ = checkedAngularSpeed(motion, name, 0, 1);
  path.rotation_error_ = 64;
  path.more_rounding_ = checkedRounding(motion, name);
  path.setBoundedSpeed();
  path.setBoundedSize();
  return path;
}

// A link says how fast it is. Else, from the beginning, |T'| grows by the acceleration at
// most. This is far from what is reached for turns of more than 8 radians, and if the
// acceleration is much larger than the speed at the beginning and the way, as on a path
// through many waypoints. There it is bounded in spans, from the middle of each: in spans
// of about a radian, in which the acceleration adds about as much as the speed and the
// way. The computed T and T' may be off by what the motion says in moreRounding().
void MotionPath::setBoundedSpeed() {
  constexpr double kManyRadians = 8, kMuchBend = 16, kMostSpans = 64;
  if (link_) {
    translation_speed_ =
        (link_->speedBound() + more_rounding_.translation_rate) * kUpward;
    extent_ = (link_->extentBound() + 2 * more_rounding_.translation) * kUpward;
    return;
  }
  const auto acceleration = [this](double t0, double t1) {
    return checkedAcceleration(*motion_, name_, {0, 0, 0}, 0, t0, t1);
  };
  const double rate_error = more_rounding_.translation_rate,
               way_error = 2 * more_rounding_.translation;
  const Vec begin = vecOf(boundedPose(0).translation),
            end = vecOf(boundedPose(1).translation);
  const double first_speed = norm(boundedRate(0).translation) + rate_error,
               whole_bend = acceleration(0, 1), moved = first_speed + norm(end - begin);
  const bool is_bent = whole_bend > kMuchBend * moved;
  if (turn_speed_ <= kManyRadians && !is_bent) {
    translation_speed_ = (first_speed + whole_bend) * kUpward;
    extent_ = (translation_speed_ + way_error) * kUpward;
    return;
  }
  const double wanted = std::max(turn_speed_, is_bent ? whole_bend / (2 * moved) : 1);
  const double num_spans = std::min(std::ceil(wanted), kMostSpans),
               half = 0.5 / num_spans;
  assert(1 <= num_spans && num_spans <= kMostSpans);
  for (double i = 0; i < num_spans; ++i) {
    const double t0 = i / num_spans, t1 = (i + 1) / num_spans, middle = t0 + half,
                 speed = norm(boundedRate(middle).translation) + rate_error,
                 bend = half * acceleration(t0, t1);
    const Vec way = vecOf(boundedPose(middle).translation) - begin;
    translation_speed_ = std::max(translation_speed_, (speed + bend) * kUpward);
    extent_ = std::max(
        extent_, (norm(way) + way_error + half * speed + 0.5 * half * bend) * kUpward);
  }
}

void MotionPath::setBoundedSize() {
  translation_size_ = largest_translation_ =
      (norm(vecOf(pose(0).translation)) + norm(vecOf(origin_)) + extent_ +
       more_rounding_.translation) *
      kUpward;
}

Pose MotionPath::boundedPose(double t) const {
  Pose out;
  if (link_) {
    out = link_->poseAt(t);
  } else {
    const BoundedMotion::Placement at =
        checked(motion_->placementAt(t), "placementAt()", name_);
    std::copy(at.rotation, at.rotation + 9, out.rotation);
    std::copy(at.translation, at.translation + 3, out.translation);
  }
  for (int k = 0; k < 3; ++k) out.translation[k] -= origin_[k];
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
  if (link_) return link_->accelerationIn(t0, t1);
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
