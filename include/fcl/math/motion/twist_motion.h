// SPDX-License-Identifier: BSD-3-Clause
//
// Bodies that move by a constant velocity and a constant angular velocity.
#ifndef FCL_MATH_MOTION_TWIST_MOTION_H
#define FCL_MATH_MOTION_TWIST_MOTION_H

#include <memory>

#include "fcl/common/types.h"
#include "fcl/export.h"
#include "fcl/math/motion/detail/followed_motion.h"

namespace fcl {

/// @brief How the reference point of a TwistMotion goes.
enum class ReferencePath {
  /// It turns about the axis of the twist and slides along it, as all points of the body
  /// do: the body follows exp(t xi) for the twist xi. Each velocity is constant seen from
  /// the body. Engines with joints integrate a free joint in this way.
  kScrew,
  /// It goes straight, and the body turns about it. Rigid-body engines integrate the
  /// velocity of the center of mass and the angular velocity in this way.
  kStraight
};

namespace detail {

FCL_EXPORT std::shared_ptr<const BoundedMotion> makeTwistPath(
    const BoundedMotion::Placement& pose, const double (&linear)[3],
    const double (&angular)[3], const double (&reference)[3], ReferencePath path);

/// @brief A vector of the program as numbers.
template <typename S>
struct ThreeNumbers {
  double x[3];
  explicit ThreeNumbers(const Vector3<S>& v)
      : x{static_cast<double>(v[0]), static_cast<double>(v[1]),
          static_cast<double>(v[2])} {}
};

}  // namespace detail

/// @brief The motion of a body whose velocity and angular velocity are constant during
/// the step, by any angle: more than half a turn, and more than a turn.
///
/// Velocities are those at t = 0, in the axes of the world, for a step: multiply those of
/// a second by the length of the step. pose.linear() turns velocities in the axes of the
/// body into the world. Queries follow this path itself, and their bound on its
/// acceleration is the largest one that is reached (doc/curved_paths.md).
///
/// @tparam S  double or float, as of the geometries. The path is computed in double.
///
/// Thread-safety: queries of this library may share it. FCL's integrate() changes it.
template <typename S>
class TwistMotion : public detail::FollowedMotion<S> {
 public:
  /// @param pose  at t = 0. A rotation up to 2^-6 is replaced by the nearest one.
  /// @param linear  the velocity of the reference point, in units of length a step
  /// @param angular  the angular velocity, in radians a step: its length is the angle
  /// @param reference  the point that has the velocity `linear`, such as the center of
  /// mass; in the frame of the body
  /// @throws fcl::Exception  a number is not finite, a length is beyond 2^160, the pose
  /// is no rotation and translation, or the angle is beyond 2^20 radians
  TwistMotion(const Transform3<S>& pose, const Vector3<S>& linear,
              const Vector3<S>& angular, ReferencePath path = ReferencePath::kScrew,
              const Vector3<S>& reference = Vector3<S>::Zero())
      : detail::FollowedMotion<S>(detail::makeTwistPath(
            detail::placementOf(pose), detail::ThreeNumbers<S>(linear).x,
            detail::ThreeNumbers<S>(angular).x, detail::ThreeNumbers<S>(reference).x,
            path)) {}
};

}  // namespace fcl

#endif
