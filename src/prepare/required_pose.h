// SPDX-License-Identifier: BSD-3-Clause
//
// Checks of the poses of a robot.
#ifndef FCL_CCD_PREPARE_REQUIRED_POSE_H
#define FCL_CCD_PREPARE_REQUIRED_POSE_H

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>

#include "fcl/common/exception.h"
#include "fcl/math/motion/bounded_motion.h"
#include "prepare/nearest_rotation.h"

namespace fcl {
namespace detail {

template <typename Numbers>
bool areFinite(const Numbers& numbers) {
  return std::all_of(std::begin(numbers), std::end(numbers),
                     [](double x) { return std::isfinite(x); });
}

/// @param name  what the exception calls it
template <typename Numbers>
void requireFinite(const Numbers& numbers, const std::string& name) {
  if (!areFinite(numbers))
    throw Exception(name + " has a number that is not finite. Correct it");
}

/// @brief The same of lengths, which queries take up to 2^160 (query_range.cpp).
inline void requireLengths(const double (&numbers)[3], const std::string& name) {
  requireFinite(numbers, name);
  const bool is_large = std::any_of(std::begin(numbers), std::end(numbers),
                                    [](double x) { return std::abs(x) > 0x1p160; });
  if (is_large)
    throw Exception(name + " has a length beyond 2^160. Use a larger unit of length");
}

/// @brief A rotation, or the nearest one, and a translation.
/// @param name  what the exception calls it
inline deformable::Pose requirePose(const BoundedMotion::Placement& placement,
                                    const std::string& name) {
  requireFinite(placement.rotation, name);
  requireLengths(placement.translation, name);
  deformable::Pose pose;
  std::copy(placement.rotation, placement.rotation + 9, pose.rotation);
  std::copy(placement.translation, placement.translation + 3, pose.translation);
  if (!deformable::toNearestRotation(pose.rotation))
    throw Exception(
        name +
        " scales, mirrors or shears, by more than 2^-6. Give a rotation and a "
        "translation: normalise the rotation");
  return pose;
}

}  // namespace detail
}  // namespace fcl

#endif
