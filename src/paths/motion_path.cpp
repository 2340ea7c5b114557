// SPDX-License-Identifier: BSD-3-Clause
//
// Rounding (u = 2^-53). A turn: the angle w t < 3.2 is rounded once. So its sine and
// cosine are within 4 + 3.2 u, and 1 - cos(w t) within 8.2 u (for w t < 1 it is computed
// from half of the angle: within 11 u of itself). An entry of C and D is at most 1 in
// size (times what R1 stretches): 7.2 + 8.2 u, and 3 products and sums of sizes up to 4,
// 13 u: below 32 u an entry, 96 u for the matrix (Frobenius norm). A product of three and
// a sum of four add 4 u of their size an entry, 13 u in all. A coordinate of the
// translation: below 16 u of the size of its terms, 28 u for the vector, and 7 u in that
// sum.
//
// A spline: the weights are within 4 u, the rotation vector within 20 u of the largest
// control point W, its length within 3 u of itself. Sine and cosine of half of it are
// within 4 u; these make A w and B w^2 within 24 u. An entry of the rotation: 24 + 24 W
// u.
//
// A motion of the program: an entry of the rotation within 64 u, the translation within
// 16 u of its size, the velocity within 128 u. This is the contract of BoundedMotion.
#include "paths/motion_path.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <string>

#include "fcl/common/exception.h"
#include "numerics/error_bounds.h"
#include "paths/posed_vector.h"
#include "paths/sine.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

/// A smaller rotation is only the rounding of the poses from which it was made.
constexpr double kLeastAngle = 0x1p-50;

/// From this angle on, a turn may go either way round. Poses that are rotations up to
/// rounding need a few u below pi. But FCL's axis and this one may be computed from
/// matrices that differ as a matrix and its nearest rotation, by 0.047 in the sine of the
/// angle (poses that deviate by 2^-6 in each entry of R^T R). The other way round is
/// shorter than 3.2, as the bounds on rounding above assume.
constexpr double kLeastHalfTurn = 3.09;

void set(double (&to)[3], const Vec& v) {
  to[0] = v.x;
  to[1] = v.y;
  to[2] = v.z;
}

double frobenius(const double (&m)[9]) {
  double sum = 0;
  for (const double x : m) sum += x * x;
  return std::sqrt(sum);
}

/// Bound on the spectral norm: the square is that of M^T M, at most its largest row. The
/// root of a row rounds by less than 8 u.
double spectralBound(const double (&m)[9]) {
  double most = 0;
  for (int i = 0; i < 3; ++i) {
    double row = 0;
    for (int j = 0; j < 3; ++j)
      row += std::abs(m[i] * m[j] + m[3 + i] * m[3 + j] + m[6 + i] * m[6 + j]);
    most = std::max(most, row);
  }
  return std::sqrt(most) * (1 + 0x1p-48);
}

/// Columns of [a] m.
void crossColumns(const Vec& a, const double (&m)[9], double (&out)[9]) {
  for (int j = 0; j < 3; ++j) {
    const Vec c = cross(a, {m[j], m[3 + j], m[6 + j]});
    out[j] = c.x;
    out[3 + j] = c.y;
    out[6 + j] = c.z;
  }
}

/// The rotation from one pose to the other: a unit axis and an angle in [0, pi]. The
/// angle is 0 if the rotation is only rounding.
double turnBetween(const Pose& from, const Pose& to, Vec& axis) {
  double m[3][3];
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      m[i][j] = to.rotation[3 * i] * from.rotation[3 * j] +
                to.rotation[3 * i + 1] * from.rotation[3 * j + 1] +
                to.rotation[3 * i + 2] * from.rotation[3 * j + 2];
  // Four times the quaternion, times its largest component (Shepperd 1978).
  double q[4];
  const double trace = m[0][0] + m[1][1] + m[2][2];
  if (trace > 0) {
    q[3] = 1 + trace;
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3, k = (i + 2) % 3;
      q[i] = m[k][j] - m[j][k];
    }
  } else {
    int i = m[1][1] > m[0][0] ? 1 : 0;
    if (m[2][2] > m[i][i]) i = 2;
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    q[i] = 1 + m[i][i] - m[j][j] - m[k][k];
    q[j] = m[j][i] + m[i][j];
    q[k] = m[k][i] + m[i][k];
    q[3] = m[k][j] - m[j][k];
  }
  Vec v = {q[0], q[1], q[2]};
  if (q[3] < 0) {
    v = -1. * v;
    q[3] = -q[3];
  }
  const double length = norm(v), whole = std::sqrt(dot(v, v) + q[3] * q[3]);
  if (!(length > 0.5 * kLeastAngle * whole)) return 0;
  axis = (1 / length) * v;
  axis = (1 / norm(axis)) * axis;
  return 2 * angleOf(q[3] / whole, length / whole);
}

SineCosine sineAndOneMinusCosine(double x) {
  const SineCosine at = sineCosine(x);
  if (x >= 1) return {at.sine, 1 - at.cosine};
  const double half = sineCosine(0.5 * x).sine;
  return {at.sine, 2 * half * half};
}

/// Weights of the control points of a uniform cubic B-spline.
void splineWeights(double t, double (&w)[4]) {
  const double s = 1 - t;
  w[0] = s * s * s / 6;
  w[1] = (4 - 3 * t * t * (2 - t)) / 6;
  w[2] = (4 - 3 * s * s * (2 - s)) / 6;
  w[3] = t * t * t / 6;
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

/// A placement or a rate of the program, if it is one.
/// @param function, name  of the program's function and of the object, for errors
BoundedMotion::Placement checked(const BoundedMotion::Placement& placement,
                                 const char* function, const char* name) {
  const auto is_finite = [](double x) { return std::isfinite(x); };
  if (std::all_of(placement.rotation, placement.rotation + 9, is_finite) &&
      std::all_of(placement.translation, placement.translation + 3, is_finite))
    return placement;
  throw Exception(std::string(name) + ": BoundedMotion::" + function +
                  " gives a number that is not finite. Correct the function");
}

/// A bound of the program, if it is one.
double checked(double bound, const char* function, const char* name) {
  if (bound >= 0 && std::isfinite(bound)) return bound * kUpward;
  throw Exception(std::string(name) + ": BoundedMotion::" + function +
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

/// sin(x) / x and cos(x).
SineCosine cardinalSineCosine(double x) {
  const SineCosine at = sineCosine(x);
  return {x > 0x1p-500 ? at.sine / x : 1, at.cosine};
}

}  // namespace

double AccelerationBound::of(const Vec& center, double radius) const {
  if (motion) return checkedAcceleration(*motion, name, center, radius, t0, t1);
  return (norm(rotated(turn, center) + vecOf(offset)) + per_radius * radius +
          per_distance * norm(center) + constant) *
         kUpward;
}

// The terms with the center are convex in it, so that the ends of its line are enough. Of
// a bound of the program nothing is known but what it says of balls.
double AccelerationBound::between(const Vec& begin, const Vec& end, double radius) const {
  if (!motion) return std::max(of(begin, radius), of(end, radius));
  const Vec half = 0.5 * (end - begin);
  return of(begin + half, (radius + norm(half)) * kUpward);
}

bool AccelerationBound::isZero() const {
  return !motion && per_radius == 0 && per_distance == 0 && constant == 0;
}

MotionPath MotionPath::still(const Pose& pose) {
  MotionPath path = turnFrom(pose, pose, {0, 0, 0});
  path.setTurnBounds();
  return path;
}

MotionPath MotionPath::turnFrom(const Pose& beginning, const Pose& end,
                                const Vec& half_turn_axis) {
  MotionPath path;
  path.turn_.beginning = beginning;
  path.turn_.angle = turnBetween(beginning, end, path.turn_.axis);
  if (path.turn_.angle > kLeastHalfTurn && dot(path.turn_.axis, half_turn_axis) < 0) {
    path.turn_.axis = -1. * path.turn_.axis;
    path.turn_.angle = 2 * M_PI - path.turn_.angle;
  }
  path.stretch_ =
      std::max(spectralBound(beginning.rotation), spectralBound(end.rotation));
  if (path.turn_.angle > 0) {
    crossColumns(path.turn_.axis, beginning.rotation, path.turn_.sine_rotation);
    crossColumns(path.turn_.axis, path.turn_.sine_rotation, path.turn_.cosine_rotation);
  }
  return path;
}

/// Sets the straight part so that the path ends at the end pose. It is computed from the
/// difference of the poses, not from the end pose, which rounds much more far from the
/// origin.
void MotionPath::reachEnd(const Pose& end) {
  const SineCosine at =
      turn_.angle == 0 ? SineCosine{0, 0} : sineAndOneMinusCosine(turn_.angle);
  for (int i = 0; i < 9; ++i)
    turn_.linear_rotation[i] =
        (end.rotation[i] - turn_.beginning.rotation[i]) -
        (at.sine * turn_.sine_rotation[i] + at.cosine * turn_.cosine_rotation[i]);
  for (int k = 0; k < 3; ++k)
    turn_.linear_translation[k] =
        (end.translation[k] - turn_.beginning.translation[k]) -
        (at.sine * turn_.sine_translation[k] + at.cosine * turn_.cosine_translation[k]);
  // A rotation of the beginning, and a part of E.
  stretch_ =
      (spectralBound(turn_.beginning.rotation) + frobenius(turn_.linear_rotation)) *
      kUpward;
}

namespace {

/// Whether the last pose, which is known exactly, is met within the bounds on rounding.
[[maybe_unused]] bool endsWithinError(const MotionPath& path, const Pose& end) {
  const Pose at = path.pose(1);
  double off[9];
  for (int i = 0; i < 9; ++i) off[i] = at.rotation[i] - end.rotation[i];
  const Vec shift = vecOf(at.translation) - vecOf(end.translation);
  return !(frobenius(off) > path.rotationError()) &&
         !(norm(shift) > path.positionError(0));
}

}  // namespace

MotionPath MotionPath::interpolation(const Pose& beginning, const Pose& end,
                                     const double (&reference)[3],
                                     const Vec& half_turn_axis) {
  MotionPath path = turnFrom(beginning, end, half_turn_axis);
  const Vec point = vecOf(reference);
  set(path.turn_.sine_translation, -1. * rotated(path.turn_.sine_rotation, point));
  set(path.turn_.cosine_translation, -1. * rotated(path.turn_.cosine_rotation, point));
  path.reachEnd(end);
  path.reference_size_ = norm(point);
  path.setTurnBounds();
  assert(endsWithinError(path, end));
  return path;
}

// The translation of a screw turns about the axis: T1 - p = -(o + cot(w / 2) a x o) / 2
// for the part o of the way T2 - T1 that is perpendicular to the axis a, so that P = a x
// (T1 - p) and Q = a x P. For a small angle these are large, |o| / w, but P sin(w t) and
// Q (1 - cos(w t)) are not, and lose nothing.
MotionPath MotionPath::screw(const Pose& beginning, const Pose& end,
                             const Vec& half_turn_axis) {
  MotionPath path = turnFrom(beginning, end, half_turn_axis);
  if (path.turn_.angle > 0) {
    const Vec way = vecOf(end.translation) - vecOf(beginning.translation);
    const Vec across = way - dot(way, path.turn_.axis) * path.turn_.axis;
    const SineCosine half = sineCosine(0.5 * path.turn_.angle);
    const Vec turning =
        0.5 * ((half.cosine / half.sine) * across - cross(path.turn_.axis, across));
    set(path.turn_.sine_translation, turning);
    set(path.turn_.cosine_translation, cross(path.turn_.axis, turning));
  }
  path.reachEnd(end);
  path.setTurnBounds();
  assert(endsWithinError(path, end));
  return path;
}

MotionPath MotionPath::withFixedRotation() const {
  MotionPath path = *this;
  Turn& turn = path.turn_;
  for (auto* matrix : {&turn.sine_rotation, &turn.cosine_rotation, &turn.linear_rotation})
    std::fill(std::begin(*matrix), std::end(*matrix), 0.);
  path.stretch_ = spectralBound(turn.beginning.rotation);
  if (norm(turn.sine_translation) == 0 && norm(turn.cosine_translation) == 0)
    turn.angle = 0;
  path.setTurnBounds();
  return path;
}

MotionPath MotionPath::withoutTurn() const {
  MotionPath path = *this;
  for (auto* vector : {&path.turn_.sine_translation, &path.turn_.cosine_translation})
    std::fill(std::begin(*vector), std::end(*vector), 0.);
  path.reference_size_ = 0;
  return path.withFixedRotation();
}

/// Whether the rotation changes with the angle.
bool MotionPath::hasTurningRotation() const {
  return turn_.angle > 0 &&
         std::any_of(std::begin(turn_.sine_rotation), std::end(turn_.sine_rotation),
                     [](double x) { return x != 0; });
}

void MotionPath::setTurnBounds() {
  const double sine = norm(vecOf(turn_.sine_translation)),
               cosine = norm(vecOf(turn_.cosine_translation)),
               linear = norm(vecOf(turn_.linear_translation)), w = turn_.angle;
  translation_size_ =
      (norm(vecOf(turn_.beginning.translation)) + linear + std::min(1., w) * sine +
       std::min(2., w * w) * cosine + reference_size_) *
      kUpward;
  largest_translation_ = translation_size_;
  turn_speed_ =
      ((hasTurningRotation() ? w * stretch_ : 0) + frobenius(turn_.linear_rotation)) *
      kUpward;
  translation_speed_ = (linear + w * (sine + cosine)) * kUpward;
  rotation_error_ = 32;
}

MotionPath MotionPath::spline(const double (&translation)[4][3],
                              const double (&rotation)[4][3], const char* name) {
  MotionPath path;
  path.kind_ = Kind::kSpline;
  std::copy(&translation[0][0], &translation[0][0] + 12, &path.translation_points_[0][0]);
  std::copy(&rotation[0][0], &rotation[0][0] + 12, &path.rotation_points_[0][0]);
  const double most = largestPoint(rotation);
  if (!(most <= kMostAngle))
    throw Exception(std::string(name) +
                    ": a rotation vector of the SplineMotion is longer than 2^20 radians "
                    "or not finite. Divide the motion into steps with smaller rotations");
  path.stretch_ = 1;
  path.turn_speed_ = largestDifference(rotation);
  path.translation_speed_ = largestDifference(translation);
  path.translation_size_ = path.largest_translation_ = largestPoint(translation);
  path.rotation_error_ = 24 + 24 * most;
  return path;
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

void MotionPath::shift(const double (&origin)[3]) {
  if (kind_ == Kind::kBounded) {
    for (int k = 0; k < 3; ++k) origin_[k] += origin[k];
    return setBoundedSize();
  }
  for (int k = 0; k < 3; ++k) turn_.beginning.translation[k] -= origin[k];
  if (kind_ == Kind::kTurn) return setTurnBounds();
  for (auto& point : translation_points_)
    for (int k = 0; k < 3; ++k) point[k] -= origin[k];
  translation_size_ = largest_translation_ = largestPoint(translation_points_);
}

Pose MotionPath::pose(double t) const {
  if (kind_ == Kind::kSpline) return splinePose(t);
  if (kind_ == Kind::kBounded) {
    const BoundedMotion::Placement at =
        checked(motion_->placementAt(t), "placementAt()", name_);
    Pose out;
    std::copy(at.rotation, at.rotation + 9, out.rotation);
    for (int k = 0; k < 3; ++k) out.translation[k] = at.translation[k] - origin_[k];
    return out;
  }
  const SineCosine at =
      turn_.angle == 0 ? SineCosine{0, 0} : sineAndOneMinusCosine(turn_.angle * t);
  Pose out;
  for (int i = 0; i < 9; ++i)
    out.rotation[i] =
        turn_.beginning.rotation[i] +
        (at.sine * turn_.sine_rotation[i] + at.cosine * turn_.cosine_rotation[i] +
         t * turn_.linear_rotation[i]);
  for (int k = 0; k < 3; ++k)
    out.translation[k] =
        turn_.beginning.translation[k] +
        (at.sine * turn_.sine_translation[k] + at.cosine * turn_.cosine_translation[k] +
         t * turn_.linear_translation[k]);
  return out;
}

PoseRate MotionPath::rate(double t) const {
  if (kind_ == Kind::kSpline) return splineRate(t);
  if (kind_ == Kind::kBounded) {
    const BoundedMotion::Placement at = checked(motion_->rateAt(t), "rateAt()", name_);
    PoseRate out;
    std::copy(at.rotation, at.rotation + 9, out.rotation);
    std::copy(at.translation, at.translation + 3, out.translation);
    return out;
  }
  const SineCosine at = turn_.angle == 0 ? SineCosine{0, 0} : sineCosine(turn_.angle * t);
  const double sine = turn_.angle * at.sine, cosine = turn_.angle * at.cosine;
  PoseRate out;
  for (int i = 0; i < 9; ++i)
    out.rotation[i] = cosine * turn_.sine_rotation[i] + sine * turn_.cosine_rotation[i] +
                      turn_.linear_rotation[i];
  for (int k = 0; k < 3; ++k)
    out.translation[k] = cosine * turn_.sine_translation[k] +
                         sine * turn_.cosine_translation[k] + turn_.linear_translation[k];
  return out;
}

// Columns of C and D, P and Q are products with the axis, which round by a few u, and w^2
// is at most 10. What is left of (R x)'' is 2 E x'.
double MotionPath::axisAcceleration(double displacement) const {
  return 2 * frobenius(turn_.linear_rotation) * displacement * kUpward;
}

PoseRate MotionPath::turnAccelerationAt(double t) const {
  const SineCosine at = turn_.angle == 0 ? SineCosine{0, 0} : sineCosine(turn_.angle * t);
  const double square = turn_.angle * turn_.angle, sine = -square * at.sine,
               cosine = square * at.cosine;
  PoseRate out;
  for (int i = 0; i < 9; ++i)
    out.rotation[i] = sine * turn_.sine_rotation[i] + cosine * turn_.cosine_rotation[i];
  for (int k = 0; k < 3; ++k)
    out.translation[k] =
        sine * turn_.sine_translation[k] + cosine * turn_.cosine_translation[k];
  return out;
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
  return out;
}

// p'' = w^2 (cos (D x + Q) - sin (C x + P)). The two vectors are perpendicular and have
// the same length, up to a rounding of at most 16 u (|x| + |P| + |Q|). This adds no more
// than twice as much to the length of the result.
AccelerationBound MotionPath::turnAcceleration() const {
  AccelerationBound bound{};
  if (turn_.angle == 0) {
    bound.per_displacement = 2 * frobenius(turn_.linear_rotation) * kUpward;
    return bound;
  }
  const double square = turn_.angle * turn_.angle, rounding = 64 * kUnit * square;
  for (int i = 0; i < 9; ++i) bound.turn[i] = square * turn_.sine_rotation[i];
  for (int k = 0; k < 3; ++k) bound.offset[k] = square * turn_.sine_translation[k];
  if (hasTurningRotation()) {
    bound.per_radius = (square * stretch_ + rounding) * kUpward;
    bound.per_distance = rounding * stretch_;
  }
  bound.constant = rounding * (norm(vecOf(turn_.sine_translation)) +
                               norm(vecOf(turn_.cosine_translation)));
  bound.per_displacement = 2 * turn_speed_ * kUpward;
  bound.jerk = turn_.angle * kUpward;
  return bound;
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

AccelerationBound MotionPath::acceleration(double t0, double t1) const {
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
  return (3 * rotation_error_ + 13) * stretch_ * kUnit;
}

double MotionPath::positionError(double radius) const {
  return rotationError() * radius + 35 * translation_size_ * kUnit;
}

double MotionPath::rateError(double radius) const {
  return (80 + 4 * (rotation_error_ - 24)) * kUnit * speed(radius);
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
