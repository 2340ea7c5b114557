// SPDX-License-Identifier: BSD-3-Clause
//
// Vectors under the rotations and poses of bodies.
#ifndef FCL_CCD_PATHS_POSED_VECTOR_H
#define FCL_CCD_PATHS_POSED_VECTOR_H

#include <cmath>

#include "mesh/vertex_frames.h"
#include "numerics/moving_vector.h"

namespace fcl {
namespace detail {
namespace deformable {

inline Vec vecOf(const double (&v)[3]) { return {v[0], v[1], v[2]}; }

inline double norm(const Vec& v) { return std::sqrt(dot(v, v)); }
inline double norm(const double (&v)[3]) { return norm(vecOf(v)); }

/// @brief The matrix times the vector; the matrix is a rotation or its derivative.
inline Vec rotated(const double (&m)[9], const Vec& v) {
  return {m[0] * v.x + m[1] * v.y + m[2] * v.z, m[3] * v.x + m[4] * v.y + m[5] * v.z,
          m[6] * v.x + m[7] * v.y + m[8] * v.z};
}

/// @brief The transposed matrix times the vector.
inline Vec rotatedBack(const double (&m)[9], const Vec& v) {
  return {m[0] * v.x + m[3] * v.y + m[6] * v.z, m[1] * v.x + m[4] * v.y + m[7] * v.z,
          m[2] * v.x + m[5] * v.y + m[8] * v.z};
}

/// @brief A point of a body, in the world.
inline Vec posed(const Pose& pose, const Vec& x) {
  return rotated(pose.rotation, x) + vecOf(pose.translation);
}

/// @brief The first or second derivative of a pose by t.
struct PoseRate {
  double rotation[9];
  double translation[3];
};

/// @brief The point between two points.
inline Vec lerp(const Vec& x, const Vec& y, double t) { return (1 - t) * x + t * y; }

/// @brief Where a vertex is at a time, in the world, and its velocity.
struct MovingPoint {
  Vec position, velocity;
};

/// @brief A vertex that goes straight from x0 to x1 in the frame of its body.
/// @param pose, rate  of the body, at time t
inline MovingPoint posedVertex(const Pose& pose, const PoseRate& rate, const Vec& x0,
                               const Vec& x1, double t) {
  const Vec x = lerp(x0, x1, t);
  return {posed(pose, x), rotated(rate.rotation, x) + rotated(pose.rotation, x1 - x0) +
                              vecOf(rate.translation)};
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
