// SPDX-License-Identifier: BSD-3-Clause
//
// Rotations as quaternions (v, s): s = cos(w / 2) and v = sin(w / 2) a for the angle w
// about the axis a. What is said of a rotation holds for multiples of a quaternion too.
#ifndef FCL_CCD_PATHS_QUATERNION_H
#define FCL_CCD_PATHS_QUATERNION_H

#include <cassert>
#include <cmath>

#include "numerics/moving_vector.h"
#include "paths/posed_vector.h"
#include "paths/sine.h"

namespace fcl {
namespace detail {
namespace deformable {

struct Quaternion {
  Vec v;
  double s;
};

/// @brief A smaller rotation is only the rounding of the poses from which it was made.
constexpr double kLeastTurn = 0x1p-50;

/// @brief The rotation y, then x. Rounds by 8 u of the lengths.
inline Quaternion operator*(const Quaternion& x, const Quaternion& y) {
  return {x.s * y.v + y.s * x.v + cross(x.v, y.v), x.s * y.s - dot(x.v, y.v)};
}

inline Quaternion inverse(const Quaternion& q) { return {-1. * q.v, q.s}; }

inline double norm(const Quaternion& q) { return std::sqrt(dot(q.v, q.v) + q.s * q.s); }

/// @brief Four times the quaternion of a rotation, times its largest component (Shepperd
/// 1978).
inline Quaternion multipleOfQuaternion(const double (&m)[9]) {
  double v[3];
  const double trace = m[0] + m[4] + m[8];
  if (trace > 0) return {{m[7] - m[5], m[2] - m[6], m[3] - m[1]}, 1 + trace};
  int i = m[4] > m[0] ? 1 : 0;
  if (m[8] > m[4 * i]) i = 2;
  const int j = (i + 1) % 3, k = (i + 2) % 3;
  v[i] = 1 + m[4 * i] - m[4 * j] - m[4 * k];
  v[j] = m[3 * j + i] + m[3 * i + j];
  v[k] = m[3 * k + i] + m[3 * i + k];
  return {{v[0], v[1], v[2]}, m[3 * k + j] - m[3 * j + k]};
}

/// @brief A turn about a unit vector by an angle in [0, pi].
struct Turning {
  Vec axis{1, 0, 0};
  double angle{0};
};

/// @brief The rotation the shorter way round; the angle 0 if it is below kLeastTurn.
/// Within 6 u in the axis and 8 u in the angle.
inline Turning turningOf(Quaternion q) {
  if (q.s < 0) q = {-1. * q.v, -q.s};
  const double length = norm(q.v), whole = norm(q);
  if (!(length > 0.5 * kLeastTurn * whole)) return {};
  const Vec axis = (1 / length) * q.v;
  const Turning out{(1 / norm(axis)) * axis, 2 * angleOf(q.s / whole, length / whole)};
  assert(isUnit(out.axis) && !(out.angle < 0 || out.angle > 3.1416));
  return out;
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
