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

/// @brief A vector that moves linearly from l to h for s from 0 to 1.
struct Segment {
  Vec l, h;
};

/// @brief Cross product of two moving vectors over an interval, c0 (1-s)^2 + c1 s (1-s) +
/// c2 s^2.
struct CrossCoefficients {
  Vec c0, c1, c2;
};

inline CrossCoefficients cross(const Segment& a, const Segment& b) {
  return {cross(a.l, b.l), cross(a.l, b.h) + cross(a.h, b.l), cross(a.h, b.h)};
}

/// @brief The same with one bound on all coefficients. Each component of c0, c1 / 2 and
/// c2 is at most `size`, and its error is at most `error`.
struct MovingCross : CrossCoefficients {
  double size;
  double error;
};

/// @brief The volume of three moving vectors over an interval: b[0] (1-s)^3 + b[1] s
/// (1-s)^2 + b[2] s^2 (1-s) + b[3] s^3. These are Bernstein coefficients, the inner ones
/// times 3.
struct VolumeCubic {
  double b[4];

  /// @param u, n  the volume is u . n
  static VolumeCubic of(const Segment& u, const CrossCoefficients& n) {
    return {{dot(u.l, n.c0), dot(u.h, n.c0) + dot(u.l, n.c1),
             dot(u.h, n.c1) + dot(u.l, n.c2), dot(u.h, n.c2)}};
  }

  double operator()(double s) const { return mix(b, s); }
  static double mix(const double (&c)[4], double s) {
    const double r = 1 - s;
    return r * r * (c[0] * r + c[1] * s) + s * s * (c[2] * r + c[3] * s);
  }
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
