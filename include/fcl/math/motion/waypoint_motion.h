// SPDX-License-Identifier: BSD-3-Clause
//
// Bodies that pass through poses at given times.
#ifndef FCL_MATH_MOTION_WAYPOINT_MOTION_H
#define FCL_MATH_MOTION_WAYPOINT_MOTION_H

#include <memory>
#include <vector>

#include "fcl/common/types.h"
#include "fcl/export.h"
#include "fcl/math/motion/detail/followed_motion.h"

namespace fcl {

namespace detail {

FCL_EXPORT std::shared_ptr<const BoundedMotion> makeWaypointPath(
    const std::vector<BoundedMotion::Placement>& poses, const std::vector<double>& times);

/// @brief Transforms of the program as numbers.
template <typename S, typename Poses>
std::vector<BoundedMotion::Placement> placementsOf(const Poses& poses) {
  std::vector<BoundedMotion::Placement> out;
  for (const Transform3<S>& pose : poses) out.push_back(detail::placementOf(pose));
  return out;
}

}  // namespace detail

/// @brief The motion of a body that passes through poses at given times, with a
/// continuous velocity. FCL's SplineMotion passes through none of its control points.
///
/// (1) At times[i] the body has the pose poses[i], up to rounding.
/// (2) Between two poses the origin of the body follows a cubic. Each coordinate in the
///     axes of the world stays between its values at both poses.
/// (3) Between two poses the body turns the shorter way round, by at most 180 degrees. If
///     both poses beside a pose are reached by turns about the same axis, the body turns
///     about this axis, and not beyond the angles at the poses.
/// (4) The velocity at a pose is a harmonic mean of the mean velocities before and after
///     it, for each coordinate, and 0 if they have opposite signs. The angular velocity
///     is such a mean too, in the axes of the body. At the first and the last pose they
///     are the mean velocities of the piece there: two poses are joined at constant
///     speed.
/// (5) Between two equal poses the body rests exactly.
///
/// The formulas are in doc/curved_paths.md. Queries follow this path itself.
///
/// @tparam S  double or float, as of the geometries. The path is computed in double.
///
/// Thread-safety: queries of this library may share it. FCL's integrate() changes it.
template <typename S>
class WaypointMotion : public detail::FollowedMotion<S> {
 public:
  /// @param poses  two or more transforms of the type S in any container, such as
  /// aligned_vector (fcl/common/types.h). A rotation up to 2^-6 is replaced by the
  /// nearest one.
  /// @param times  one for each pose: they ascend from 0 to 1, at least 2^-16 apart
  /// @throws fcl::Exception  a wrong number of poses or times, times that are not as
  /// above, a number that is not finite, a length beyond 2^160, or a pose that is no
  /// rotation and translation
  template <typename Poses>
  WaypointMotion(const Poses& poses, const std::vector<double>& times)
      : detail::FollowedMotion<S>(
            detail::makeWaypointPath(detail::placementsOf<S>(poses), times)) {}
};

}  // namespace fcl

#endif
