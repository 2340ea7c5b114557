// SPDX-License-Identifier: BSD-3-Clause
//
// Rounding (u = 2^-53) of a turn: the angle w t < 3.2 is rounded once. So its sine and
// cosine are within 4 + 3.2 u, and 1 - cos(w t) within 8.2 u (for w t < 1 it is computed
// from half of the angle: within 11 u of itself). An entry of C and D is at most 1 in
// size (times what R1 stretches): 7.2 + 8.2 u, and 3 products and sums of sizes up to 4,
// 13 u: below 32 u an entry, 96 u for the matrix (Frobenius norm). A product of three and
// a sum of four add 4 u of their size an entry, 13 u in all. A coordinate of the
// translation: below 16 u of the size of its terms, 28 u for the vector, and 7 u in that
// sum.
#include "paths/motion_path.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <iterator>

#include "numerics/error_bounds.h"
#include "paths/path_matrix.h"
#include "paths/posed_vector.h"
#include "paths/quaternion.h"
#include "paths/sine.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

/// From this angle on, a turn may go either way round. Poses that are rotations up to
/// rounding need a few u below pi. But FCL's axis and this one may be computed from
/// matrices that differ as a matrix and its nearest rotation, by 0.047 in the sine of the
/// angle (poses that deviate by 2^-6 in each entry of R^T R). The other way round is
/// shorter than 3.2, as the bounds on rounding above assume.
constexpr double kLeastHalfTurn = 3.09;

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

/// The rotation from one pose to the other.
Turning turningBetween(const Pose& from, const Pose& to) {
  double m[9];
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      m[3 * i + j] = to.rotation[3 * i] * from.rotation[3 * j] +
                     to.rotation[3 * i + 1] * from.rotation[3 * j + 1] +
                     to.rotation[3 * i + 2] * from.rotation[3 * j + 2];
  return turningOf(multipleOfQuaternion(m));
}

}  // namespace

MotionPath MotionPath::still(const Pose& pose) {
  MotionPath path = turnFrom(pose, pose, {0, 0, 0});
  path.setTurnBounds();
  return path;
}

MotionPath MotionPath::turnFrom(const Pose& beginning, const Pose& end,
                                const Vec& half_turn_axis) {
  MotionPath path;
  path.turn_.beginning = beginning;
  const Turning turning = turningBetween(beginning, end);
  path.turn_.axis = turning.axis;
  path.turn_.angle = turning.angle;
  if (path.turn_.angle > kLeastHalfTurn && dot(path.turn_.axis, half_turn_axis) < 0) {
    path.turn_.axis = -1. * path.turn_.axis;
    path.turn_.angle = 2 * M_PI - path.turn_.angle;
  }
  assert(isUnit(path.turn_.axis) && 0 <= path.turn_.angle && path.turn_.angle < 3.2);
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
  assert(!(longestColumn(end.rotation) > stretch_ * kUpward));
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
    assert(half.sine > 0);
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
  assert(kind_ == Kind::kTurn);
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
  assert(kind_ == Kind::kTurn);
  MotionPath path = *this;
  for (auto* vector : {&path.turn_.sine_translation, &path.turn_.cosine_translation})
    std::fill(std::begin(*vector), std::end(*vector), 0.);
  path.reference_size_ = 0;
  return path.withFixedRotation();
}

// p(t) of the point R_o y + t_o: each matrix M of the turn becomes M R_o, and each vector
// v becomes M t_o + v. A product of matrices rounds by 9 u, and the sum of the four, of
// sizes up to 1, 1, 2 and a rounding, by 36 u. M t_o rounds by 6 u of |t_o|, the sum by u
// of its size.
MotionPath MotionPath::placed(const Pose& offset) const {
  assert(kind_ == Kind::kTurn && isRotation(offset.rotation, 0x1p-44));
  MotionPath path = *this;
  Turn& turn = path.turn_;
  const Vec shift = vecOf(offset.translation);
  const auto move = [&](const double(&from)[9], double(&matrix)[9], double(&vector)[3]) {
    set(vector, rotated(from, shift) + vecOf(vector));
    multiply(from, offset.rotation, matrix);
  };
  move(turn_.beginning.rotation, turn.beginning.rotation, turn.beginning.translation);
  move(turn_.sine_rotation, turn.sine_rotation, turn.sine_translation);
  move(turn_.cosine_rotation, turn.cosine_rotation, turn.cosine_translation);
  move(turn_.linear_rotation, turn.linear_rotation, turn.linear_translation);
  const double distance = norm(shift);
  path.stretch_ *= spectralBound(offset.rotation) * kUpward;
  path.reference_size_ += path.stretch_ * distance;
  path.setTurnBounds();
  path.more_rounding_.rotation += 64 * kUnit * path.stretch_;
  path.more_rounding_.rotation_rate += 64 * kUnit * path.turn_speed_;
  path.more_rounding_.translation +=
      32 * kUnit * path.stretch_ * distance + 4 * kUnit * path.translation_size_;
  path.more_rounding_.translation_rate +=
      32 * kUnit * path.turn_speed_ * distance + 4 * kUnit * path.translation_speed_;
  return path;
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

Pose MotionPath::turnPose(double t) const {
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
  assert(!isTimeOfStep(t) ||
         !(norm(vecOf(out.translation)) > largest_translation_ * kUpward + 0x1p-500));
  return out;
}

PoseRate MotionPath::turnRate(double t) const {
  const SineCosine at = turn_.angle == 0 ? SineCosine{0, 0} : sineCosine(turn_.angle * t);
  const double sine = turn_.angle * at.sine, cosine = turn_.angle * at.cosine;
  PoseRate out;
  for (int i = 0; i < 9; ++i)
    out.rotation[i] = cosine * turn_.sine_rotation[i] + sine * turn_.cosine_rotation[i] +
                      turn_.linear_rotation[i];
  for (int k = 0; k < 3; ++k)
    out.translation[k] = cosine * turn_.sine_translation[k] +
                         sine * turn_.cosine_translation[k] + turn_.linear_translation[k];
  assert(!(longestColumn(out.rotation) >
           turn_speed_ * kUpward + rotationRateError() + 0x1p-500));
  assert(!(norm(vecOf(out.translation)) >
           translation_speed_ * kUpward + rateError(0) + 0x1p-500));
  return out;
}

// Columns of C and D, P and Q are products with the axis, which round by a few u, and w^2
// is at most 10. What is left of (R x)'' is 2 E x'.
double MotionPath::axisAcceleration(double displacement) const {
  return 2 * frobenius(turn_.linear_rotation) * displacement * kUpward;
}

PoseRate MotionPath::turnAccelerationAt(double t) const {
  assert(kind_ == Kind::kTurn);
  const SineCosine at = turn_.angle == 0 ? SineCosine{0, 0} : sineCosine(turn_.angle * t);
  const double square = turn_.angle * turn_.angle, sine = -square * at.sine,
               cosine = square * at.cosine;
  PoseRate out;
  for (int i = 0; i < 9; ++i)
    out.rotation[i] = sine * turn_.sine_rotation[i] + cosine * turn_.cosine_rotation[i];
  for (int k = 0; k < 3; ++k)
    out.translation[k] =
        sine * turn_.sine_translation[k] + cosine * turn_.cosine_translation[k];
  // P and Q round by a few u of the reference point, of which they may be a small part.
  assert(!(norm(vecOf(out.translation)) > turnAcceleration().of({0, 0, 0}, 0) * kUpward +
                                              16 * kUnit * square * reference_size_ +
                                              0x1p-500));
  return out;
}

// p'' = w^2 (cos (D x + Q) - sin (C x + P)). The two vectors are perpendicular and have
// the same length, up to a rounding of at most 16 u (|x| + |P| + |Q|), and of a frame on
// the body by what more_rounding_ has for it. This adds no more than twice as much to the
// length of the result. That P and Q also round by 2 u of the reference point is part of
// positionError(): over a step it moves no point by more than w^2 / 2 times this, which
// is below 10 u of it.
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
    const double more = 2 * square * more_rounding_.rotation;
    bound.per_radius = (square * stretch_ + rounding + more) * kUpward;
    bound.per_distance = rounding * stretch_ + more;
  }
  bound.constant = rounding * (norm(vecOf(turn_.sine_translation)) +
                               norm(vecOf(turn_.cosine_translation))) +
                   2 * square * more_rounding_.translation;
  bound.per_displacement = 2 * turn_speed_ * kUpward;
  bound.jerk = turn_.angle * kUpward;
  return bound;
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
