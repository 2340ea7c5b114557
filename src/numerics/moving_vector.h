// SPDX-License-Identifier: BSD-3-Clause
//
// Vectors and their cross products over the step, in floating point with error bounds.
#ifndef FCL_CCD_NUMERICS_MOVING_VECTOR_H
#define FCL_CCD_NUMERICS_MOVING_VECTOR_H

#include <algorithm>
#include <cmath>

namespace fcl {
namespace detail {
namespace deformable {

struct Vec {
  double x, y, z;
};

inline Vec operator+(const Vec& a, const Vec& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
inline Vec operator-(const Vec& a, const Vec& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline Vec operator*(double s, const Vec& a) { return {s * a.x, s * a.y, s * a.z}; }
inline double dot(const Vec& a, const Vec& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline Vec cross(const Vec& a, const Vec& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline double maxNorm(const Vec& a) {
  return std::max(std::max(std::abs(a.x), std::abs(a.y)), std::abs(a.z));
}

/// @brief Cross product of two moving vectors over an interval, c0 (1-s)^2 + c1 s (1-s) +
/// c2 s^2. Each component of c0, c1 / 2 and c2 is at most `size`, and its error is at
/// most `error`.
struct MovingCross {
  Vec c0, c1, c2;
  double size;
  double error;
};

/// @brief Three vectors move linearly from l to h for s from 0 to 1. This is the s at
/// which they are shortest together, and the change of s in which they move by their
/// length there. It is computed in floating point, and is not finite if there is no such
/// place.
struct ClosestApproach {
  double s;
  double duration;

  ClosestApproach(const Vec (&l)[3], const Vec (&h)[3]) {
    double along = 0, speed = 0, length = 0;
    for (int i = 0; i < 3; ++i) {
      const Vec change = h[i] - l[i];
      along -= dot(l[i], change);
      speed += dot(change, change);
    }
    s = along / speed;
    for (int i = 0; i < 3; ++i) {
      const Vec there = (1 - s) * l[i] + s * h[i];
      length += dot(there, there);
    }
    duration = std::sqrt(length / speed);
  }
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
