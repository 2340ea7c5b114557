// SPDX-License-Identifier: BSD-3-Clause
#include "bodies/calm_bodies.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "numerics/error_bounds.h"
#include "paths/posed_vector.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

/// Entries of the matrices of a turn and of its translation round by less than this.
constexpr double kRounding = 128 * kUnit;

/// Bound on the distance of a matrix R from a rotation: that of its singular values from
/// 1 is at most that of their squares, which is R^T R - 1.
double defectOf(const double (&r)[9]) {
  double square = 0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const double product = r[i] * r[j] + r[3 + i] * r[3 + j] + r[6 + i] * r[6 + j];
      square += (product - (i == j)) * (product - (i == j));
    }
  return std::sqrt(square) + kRounding;
}

double frobenius(const double (&m)[9]) {
  double square = 0;
  for (const double x : m) square += x * x;
  return std::sqrt(square);
}

Vec column(const double (&r)[9], int k) { return {r[k], r[3 + k], r[6 + k]}; }

/// How far a unit vector is from another one, or from its opposite.
double missOf(const Vec& axis, const Vec& other) {
  return std::min(norm(axis - other), norm(axis + other));
}

/// Bound on the distance of the points of a shape's core from the origin of its frame.
double coreRadiusOf(const ConvexShape& shape) {
  return (norm(shape.center()) + shape.box().radius + shape.box().pad) * kUpward;
}

}  // namespace

CalmBodies::CalmBodies(const MovingBody& a, const MovingBody& b) : body_{a, b} {
  for (auto k : {0, 1})
    if (body_[k].shape()) are_calmer_ |= dropSpin(k);
  for (auto k : {0, 1})
    if (body_[1 - k].shape()) are_calmer_ |= dropCommonTurn(k);
  assert(are_calmer_ ? !(deviation_ < 0) : deviation_ == 0);
}

/// Keeps a path if little may be nearer than it shows. Where the deviation is larger the
/// pads of boxes grow, and the true path may tell more.
bool CalmBodies::keep(int k, const MotionPath& path, double deviation) {
  constexpr double kMost = 0x1p-20;
  assert(!(deviation < 0));
  double size = 0;
  for (const MovingBody& body : body_)
    size +=
        body.shapeRadius() + (body.shape() ? coreRadiusOf(*body.shape()) : body.radius());
  if (!(deviation <= kMost * size)) return false;
  body_[k].path() = path;
  deviation_ += deviation * kUpward;
  return true;
}

// The rotation is R(t) = exp(w t [a]) R1 + t E, up to rounding. Let B be the rotation
// next to R1, d their distance, and v = B e the axis of the shape, or its opposite. With
// exp(w t [a]) next to exp(w t [v]), within w |a - v|, R(t) x is next to B Z x: Z is a
// turn about e, so that Z x is a point of the shape too. R1 Z x is next to B Z x, within
// d |x|. All in all: w (|a - v| + d) + |E| + 2 d. A ball has an axis along every a.
bool CalmBodies::dropSpin(int k) {
  const ConvexShape& shape = *body_[k].shape();
  const MotionPath& path = body_[k].path();
  const Turn* turn = path.turn();
  if (!turn || turn->angle == 0 || !shape.isRound()) return false;
  const double(&r)[9] = turn->beginning.rotation;
  const double defect = defectOf(r),
               miss =
                   shape.isBall()
                       ? 0
                       : missOf(turn->axis, column(r, shape.axisOfRevolution())) + defect;
  return keep(
      k, path.withFixedRotation(),
      coreRadiusOf(shape) * (turn->angle * miss + frobenius(turn->linear_rotation) +
                             2 * defect + kRounding));
}

// Let c(t) be the center of the shape, which goes straight and does not turn, and y = T1
// - c(0). A point x of the other body is at exp(w t [a]) (R1 x + y) + t s from c(t), if P
// = a x y and Q = a x P, with the difference s of the straight parts. The turn by -w t
// about the line along a through c(t) changes no distance. It takes the shape to itself,
// within w (|a - v| + d) + 2 d as above, and the point to R1 x + y + t s, if s is along
// a: otherwise within min(2, w) of what is across. So without the turn the bodies are
// nearer, or less near, by no more than all deviations from this.
bool CalmBodies::dropCommonTurn(int k) {
  const MovingBody& other = body_[1 - k];
  const ConvexShape& shape = *other.shape();
  const Turn* const turn = body_[k].path().turn();
  const Turn* const calm = other.path().turn();
  if (!turn || turn->angle == 0 || !shape.isRound()) return false;
  if (!calm || !other.path().isTranslation()) return false;
  const Vec &a = turn->axis,
            y = vecOf(turn->beginning.translation) - vecOf(calm->beginning.translation),
            sine = cross(a, y),
            slip = vecOf(turn->linear_translation) - vecOf(calm->linear_translation);
  const double w = turn->angle, defect = defectOf(calm->beginning.rotation),
               miss = shape.isBall() ? 0
                                     : missOf(a, column(calm->beginning.rotation,
                                                        shape.axisOfRevolution())) +
                                           defect,
               size = body_[k].path().stretch() * body_[k].radius() + norm(y) +
                      body_[k].path().largestTranslation();
  return keep(
      k, body_[k].path().withoutTurn(),
      coreRadiusOf(shape) * (w * miss + 2 * defect) +
          frobenius(turn->linear_rotation) * body_[k].radius() +
          std::min(1., w) * norm(vecOf(turn->sine_translation) - sine) +
          std::min(2., w * w) * norm(vecOf(turn->cosine_translation) - cross(a, sine)) +
          std::min(2., w) * norm(slip - dot(slip, a) * a) + kRounding * size);
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
