// SPDX-License-Identifier: BSD-3-Clause
//
// Vertices under the poses of bodies that move.
#ifndef FCL_CCD_PATHS_POSED_VECTOR_H
#define FCL_CCD_PATHS_POSED_VECTOR_H

#include <cmath>

#include "mesh/vertex_frames.h"
#include "numerics/moving_vector.h"

namespace fcl {
namespace detail {
namespace deformable {

inline double norm(const Vec& v) { return std::sqrt(dot(v, v)); }
inline double norm(const double (&v)[3]) { return norm(vecOf(v)); }
inline Vec unit(const Vec& v) { return (1 / norm(v)) * v; }

/// @brief Whether the length is 1, up to rounding; also of NaN. For assertions.
inline bool isUnit(const Vec& v) { return !(std::abs(dot(v, v) - 1) > 0x1p-46); }

/// @brief Whether a time is one of the step, and whether a span is a part of it. For
/// assertions.
inline bool isTimeOfStep(double t) { return 0 <= t && t <= 1; }
inline bool isPartOfStep(double t0, double t1) { return 0 <= t0 && t0 <= t1 && t1 <= 1; }

/// @brief The first or second derivative of a pose by t.
struct PoseRate {
  double rotation[9];
  double translation[3];
};

/// @brief The point between two points.
inline Vec lerp(const Vec& x, const Vec& y, double t) { return (1 - t) * x + t * y; }

/// @brief A vertex that goes straight from x0 to x1 in the frame of its body, in the
/// world.
/// @param pose  of the body, at time t
inline Vec posed(const Pose& pose, const Vec& x0, const Vec& x1, double t) {
  return posed(pose, lerp(x0, x1, t));
}

/// @brief Where a vertex is at a time, in the world, and its velocity.
struct MovingPoint {
  Vec position, velocity;
};

/// @brief A point that is fixed in its body, with its velocity.
/// @param rate  the derivative of the pose
inline MovingPoint posedPoint(const Pose& pose, const PoseRate& rate, const Vec& x) {
  return {posed(pose, x), rotated(rate.rotation, x) + vecOf(rate.translation)};
}

/// @brief A vertex that goes straight from x0 to x1 in the frame of its body.
/// @param rate  the derivative of the pose
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
