// SPDX-License-Identifier: BSD-3-Clause
//
// What all kinds of paths have. Each kind has a file: turn_path.cpp, spline_path.cpp,
// bounded_path.cpp.
#include "paths/motion_path.h"

#include <algorithm>
#include <cassert>

#include "numerics/error_bounds.h"
#include "paths/posed_vector.h"

namespace fcl {
namespace detail {
namespace deformable {

double AccelerationBound::of(const Vec& center, double radius) const {
  assert(!(radius < 0) && !(per_radius < 0) && !(per_distance < 0) && !(constant < 0));
  if (motion) return ofProgram(center, radius);
  return (norm(rotated(turn, center) + vecOf(offset)) + per_radius * radius +
          per_distance * norm(center) + constant) *
         kUpward;
}

// The terms with the center are convex in it, so that the ends of its line are enough. Of
// a bound of the program nothing is known but what it says of balls.
double AccelerationBound::between(const Vec& begin, const Vec& end, double radius) const {
  if (!motion) {
    const double most = std::max(of(begin, radius), of(end, radius));
    assert(!(of(0.5 * (begin + end), radius) > most * kUpward + 0x1p-500));
    return most;
  }
  const Vec half = 0.5 * (end - begin);
  return of(begin + half, (radius + norm(half)) * kUpward);
}

bool AccelerationBound::isZero() const {
  return !motion && per_radius == 0 && per_distance == 0 && constant == 0;
}

void MotionPath::shift(const double (&origin)[3]) {
  if (kind_ == Kind::kBounded) {
    for (int k = 0; k < 3; ++k) origin_[k] += origin[k];
    return setBoundedSize();
  }
  for (int k = 0; k < 3; ++k) turn_.beginning.translation[k] -= origin[k];
  if (kind_ == Kind::kTurn) return setTurnBounds();
  for (auto& point : translation_points_)
    for (int k = 0; k < 3; ++k) point[k] -= origin[k];
  setSplineSize();
}

Pose MotionPath::pose(double t) const {
  switch (kind_) {
    case Kind::kTurn:
      return turnPose(t);
    case Kind::kSpline:
      return splinePose(t);
    default:
      return boundedPose(t);
  }
}

PoseRate MotionPath::rate(double t) const {
  switch (kind_) {
    case Kind::kTurn:
      return turnRate(t);
    case Kind::kSpline:
      return splineRate(t);
    default:
      return boundedRate(t);
  }
}

AccelerationBound MotionPath::acceleration(double t0, double t1) const {
  assert(isPartOfStep(t0, t1));
  switch (kind_) {
    case Kind::kTurn:
      return turnAcceleration();
    case Kind::kSpline:
      return splineAcceleration(t0, t1);
    default:
      return boundedAcceleration(t0, t1);
  }
}

double MotionPath::rotationError() const {
  return (3 * rotation_error_ + 13) * stretch_ * kUnit + more_rounding_.rotation;
}

double MotionPath::positionError(double radius) const {
  return rotationError() * radius + 35 * translation_size_ * kUnit +
         more_rounding_.translation;
}

double MotionPath::rotationRateError() const {
  return (80 + 4 * (rotation_error_ - 24)) * kUnit * turn_speed_ +
         more_rounding_.rotation_rate;
}

double MotionPath::rateError(double radius) const {
  return (80 + 4 * (rotation_error_ - 24)) * kUnit * speed(radius) +
         more_rounding_.rotation_rate * radius + more_rounding_.translation_rate;
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
