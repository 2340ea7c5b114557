// SPDX-License-Identifier: BSD-3-Clause
#include "bodies/common_motion.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "bodies/body_tolerance.h"
#include "numerics/error_bounds.h"
#include "paths/posed_vector.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

/// A turn as a motion of the whole space. The point that is at X at t = 0 moves by
///   t L + sin(w t) (a x X + sine) + (1 - cos(w t)) (a x (a x X) + cosine),
/// and by what the linear part of the rotation adds, which is rounding of a rotation.
struct SpaceMotion {
  Vec axis, linear, sine, cosine;
  double angle, rest;

  SpaceMotion(const Turn& turn, double size) : axis(turn.axis), angle(turn.angle) {
    const Vec at = vecOf(turn.beginning.translation), across = cross(axis, at);
    linear = vecOf(turn.linear_translation);
    sine = vecOf(turn.sine_translation) - across;
    cosine = vecOf(turn.cosine_translation) - cross(axis, across);
    double square = 0;
    for (const double x : turn.linear_rotation) square += x * x;
    // Entries of C = [a] R round by 3 u, those of D = [a] C by 6 u: 9 u and 18 u as the
    // root of the sum of nine squares.
    rest = (std::sqrt(square) + std::min(1., angle) * 32 * kUnit) * size;
  }
};

}  // namespace

// Of two motions of the space with the same a, w, L and offsets each is the same rigid
// motion, so that all distances stay what they are. The difference of two motions of a
// point no further than `size` from the origin is at most that of L, and of the
// parameters of both turns times the sine and 1 - cosine of the angle. Then a distance of
// points of both bodies changes by no more than this and the rest. What is within the
// distance and the tolerance, three times `position` or more, is in contact at t = 0. All
// else stays further apart than the distance if it changes by less.
bool moveAsOne(const MovingBody& a, const MovingBody& b, double distance) {
  const Turn *turn_a = a.path().turn(), *turn_b = b.path().turn();
  const auto isRigid = [](const MovingBody& body) {
    return !body.isMesh() || body.isRigid();
  };
  if (!turn_a || !turn_b || !isRigid(a) || !isRigid(b)) return false;
  const double size = std::max(a.size(), b.size());
  assert(isUnit(turn_a->axis) && isUnit(turn_b->axis) && !(distance < 0));
  const SpaceMotion x(*turn_a, size), y(*turn_b, size);
  const double angle = std::max(x.angle, y.angle), sine = std::min(1., angle),
               cosine = std::min(2., 0.5 * angle * angle),
               turned = norm(x.axis - y.axis) * size;
  const double moves =
      norm(x.linear - y.linear) + sine * norm(x.sine - y.sine) +
      cosine * norm(x.cosine - y.cosine) + (sine + 2 * cosine) * turned +
      std::abs(x.angle - y.angle) * (2 * size + std::max(norm(x.sine), norm(y.sine)) +
                                     std::max(norm(x.cosine), norm(y.cosine))) +
      x.rest + y.rest;
  return moves * kUpward <= 2 * BodyTolerance(a, b, distance).position;
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
