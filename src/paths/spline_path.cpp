// SPDX-License-Identifier: BSD-3-Clause
//
// Rounding (u = 2^-53) of a spline: the weights are within 4 u, the rotation vector
// within 20 u of the largest control point W, its length within 3 u of itself. Sine and
// cosine of half of it are within 4 u; these make A w and B w^2 within 24 u. An entry of
// the rotation: 24 + 24 W u.
#include "paths/motion_path.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <string>

#include "base/error.h"
#include "numerics/error_bounds.h"
#include "paths/path_matrix.h"
#include "paths/posed_vector.h"
#include "paths/sine.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

/// Weights of the control points of a uniform cubic B-spline.
void splineWeights(double t, double (&w)[4]) {
  const double s = 1 - t;
  w[0] = s * s * s / 6;
  w[1] = (4 - 3 * t * t * (2 - t)) / 6;
  w[2] = (4 - 3 * s * s * (2 - s)) / 6;
  w[3] = t * t * t / 6;
  assert(!isTimeOfStep(t) || (std::all_of(w, w + 4, [](double x) { return x >= 0; }) &&
                              std::abs(w[0] + w[1] + w[2] + w[3] - 1) <= 0x1p-48));
}

Vec splineAt(const double (&points)[4][3], const double (&w)[4]) {
  double v[3];
  for (int k = 0; k < 3; ++k)
    v[k] = (w[0] * points[0][k] + w[3] * points[3][k]) +
           (w[1] * points[1][k] + w[2] * points[2][k]);
  return vecOf(v);
}

/// The first derivative, a weighted mean of the differences of the control points.
Vec splineRateAt(const double (&points)[4][3], double t) {
  const double s = 1 - t, w[3] = {0.5 * s * s, 0.5 + t * s, 0.5 * t * t};
  double v[3];
  for (int k = 0; k < 3; ++k)
    v[k] = w[0] * (points[1][k] - points[0][k]) + w[1] * (points[2][k] - points[1][k]) +
           w[2] * (points[3][k] - points[2][k]);
  return vecOf(v);
}

/// The second derivative, between the second differences.
Vec splineAccelerationAt(const double (&points)[4][3], double t) {
  double v[3];
  for (int k = 0; k < 3; ++k)
    v[k] = (1 - t) * ((points[2][k] - points[1][k]) - (points[1][k] - points[0][k])) +
           t * ((points[3][k] - points[2][k]) - (points[2][k] - points[1][k]));
  return vecOf(v);
}

/// The largest length of a point; NaN if one of them is NaN.
double largestPoint(const double (&points)[4][3]) {
  double most = 0;
  for (const auto& point : points) {
    const double length = norm(vecOf(point));
    if (length > most || std::isnan(length)) most = length;
  }
  return most * kUpward;
}

double largestDifference(const double (&points)[4][3]) {
  double most = 0;
  for (int i = 0; i < 3; ++i)
    most = std::max(most, norm(vecOf(points[i + 1]) - vecOf(points[i])));
  return most * kUpward;
}

/// sin(x) / x and cos(x).
SineCosine cardinalSineCosine(double x) {
  const SineCosine at = sineCosine(x);
  return {x > 0x1p-500 ? at.sine / x : 1, at.cosine};
}

}  // namespace

MotionPath MotionPath::spline(const double (&translation)[4][3],
                              const double (&rotation)[4][3], const char* name) {
  MotionPath path;
  path.kind_ = Kind::kSpline;
  std::copy(&translation[0][0], &translation[0][0] + 12, &path.translation_points_[0][0]);
  std::copy(&rotation[0][0], &rotation[0][0] + 12, &path.rotation_points_[0][0]);
  const double most = largestPoint(rotation);
  if (!(most <= kMostAngle))
    throwBadInput(std::string(name) +
                  ": a rotation vector of the SplineMotion is longer than 2^20 radians "
                  "or not finite. Divide the motion into steps with smaller rotations");
  path.stretch_ = 1;
  path.turn_speed_ = largestDifference(rotation);
  path.translation_speed_ = largestDifference(translation);
  path.setSplineSize();
  path.rotation_error_ = 24 + 24 * most;
  return path;
}

void MotionPath::setSplineSize() {
  translation_size_ = largest_translation_ = largestPoint(translation_points_);
}

// R = I + A [w] + B [w]^2 with A = sin(|w|) / |w|, B = (1 - cos(|w|)) / |w|^2, from half
// of the angle.
Pose MotionPath::splinePose(double t) const {
  double weights[4];
  splineWeights(t, weights);
  const Vec w = splineAt(rotation_points_, weights);
  const SineCosine half = cardinalSineCosine(0.5 * norm(w));
  const double a = half.sine * half.cosine, b = 0.5 * half.sine * half.sine;
  Pose out;
  set(out.translation, splineAt(translation_points_, weights));
  double(&r)[9] = out.rotation;
  r[0] = 1 - b * (w.y * w.y + w.z * w.z);
  r[4] = 1 - b * (w.x * w.x + w.z * w.z);
  r[8] = 1 - b * (w.x * w.x + w.y * w.y);
  r[1] = b * w.x * w.y - a * w.z;
  r[3] = b * w.x * w.y + a * w.z;
  r[2] = b * w.x * w.z + a * w.y;
  r[6] = b * w.x * w.z - a * w.y;
  r[5] = b * w.y * w.z - a * w.x;
  r[7] = b * w.y * w.z + a * w.x;
  assert(isRotation(r, 0x1p-44));
  assert(!isTimeOfStep(t) ||
         !(norm(vecOf(out.translation)) > largest_translation_ * kUpward + 0x1p-500));
  return out;
}

// R' = [v] R with v = w' + B w x w' + G w x (w x w'), G = (|w| - sin(|w|)) / |w|^3.
PoseRate MotionPath::splineRate(double t) const {
  double weights[4];
  splineWeights(t, weights);
  const Vec w = splineAt(rotation_points_, weights),
            w_rate = splineRateAt(rotation_points_, t);
  const double square = dot(w, w), angle = std::sqrt(square);
  const SineCosine half = cardinalSineCosine(0.5 * angle);
  const double b = 0.5 * half.sine * half.sine;
  // Below 1 the series of 1 / 3! - |w|^2 / 5! + ..., up to |w|^16 / 19!.
  double g = 0;
  if (square < 1) {
    constexpr double kTerms[9] = {6., 20., 42., 72., 110., 156., 210., 272., 342.};
    for (int i = 8; i >= 0; --i) g = (1 - square * g) / kTerms[i];
  } else {
    g = (1 - half.sine * half.cosine) / square;
  }
  const Vec turned = cross(w, w_rate);
  const Vec v = w_rate + b * turned + g * cross(w, turned);
  PoseRate out;
  crossColumns(v, splinePose(t).rotation, out.rotation);
  set(out.translation, splineRateAt(translation_points_, t));
  assert(!isTimeOfStep(t) || !(longestColumn(out.rotation) >
                               turn_speed_ * kUpward + rotationRateError() + 0x1p-500));
  // Control points that are shifted round by u.
  assert(!isTimeOfStep(t) ||
         !(norm(vecOf(out.translation)) > translation_speed_ * kUpward + rateError(0) +
                                              8 * kUnit * translation_size_ + 0x1p-500));
  return out;
}

// |R''| <= |v'| + |v|^2, |v| <= |w'|, |v'| <= |w''| + |w'|^2 / 2: the left Jacobian of
// the rotation vector is the mean of exp(s [w]) for s in [0, 1]. w'' is between its ends,
// w' between three control points. Their computed values are within 2^-46 of the control
// points of the spline.
AccelerationBound MotionPath::splineAcceleration(double t0, double t1) const {
  const auto largest = [](const Vec& x, const Vec& y) {
    return std::max(norm(x), norm(y));
  };
  constexpr double kRounding = 0x1p-46;
  const Vec w0 = splineAccelerationAt(rotation_points_, t0),
            w1 = splineAccelerationAt(rotation_points_, t1),
            rate0 = splineRateAt(rotation_points_, t0),
            rate1 = splineRateAt(rotation_points_, t1);
  const double slack = kRounding * largestPoint(rotation_points_);
  const double bending = largest(w0, w1) + slack;
  const double turning =
      std::max(largest(rate0, rate1), norm(rate0 + (0.5 * (t1 - t0)) * w0)) + slack;
  assert(!(norm(splineRateAt(rotation_points_, t0 + 0.5 * (t1 - t0))) >
           turning * kUpward + 0x1p-500));
  AccelerationBound bound{};
  bound.per_radius = bound.per_distance = (bending + 1.5 * turning * turning) * kUpward;
  bound.constant = (largest(splineAccelerationAt(translation_points_, t0),
                            splineAccelerationAt(translation_points_, t1)) +
                    kRounding * largestPoint(translation_points_)) *
                   kUpward;
  bound.per_displacement = 2 * turning * kUpward;
  bound.jerk = HUGE_VAL;
  return bound;
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
