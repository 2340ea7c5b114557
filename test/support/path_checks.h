// SPDX-License-Identifier: BSD-3-Clause
//
// Motion classes of the library against their exact paths in Real: rounding,
// bounds, and queries against dense samples.
#ifndef FCL_TEST_SUPPORT_PATH_CHECKS_H
#define FCL_TEST_SUPPORT_PATH_CHECKS_H

#include <functional>
#include <string>

#include "fcl/math/motion/bounded_motion.h"
#include "fcl/math/motion/motion_base.h"
#include "reference_motion.h"

namespace fcl {
namespace test {

/// @brief The pose at t by textbook formulas.
using ExactPath = std::function<RealPose(Real)>;

/// @brief The parts of the bounds on rounding, of the pose and of its rate, that a point
/// reached. Both are at most 1.
struct RoundingParts {
  double pose, rate;
};
RoundingParts roundingParts(const BoundedMotion& motion, const ExactPath& exact,
                            const Vector3<double>& x, double t);

/// @brief The parts of moreRounding() alone that the errors of a pose and of its rate
/// reached, for motions that say all of their rounding there.
/// @param pose, rate  the exact ones at t
/// @param direction  a unit vector
RoundingParts ownRoundingParts(const BoundedMotion& motion, const RealPose& pose,
                               const RealPose& rate, const Vector3<double>& direction,
                               double t);

/// @brief The larger one of each part.
RoundingParts greatest(const RoundingParts& x, const RoundingParts& y);

/// @brief The parts of the bounds on the acceleration and the angular speed that were
/// reached at samples of a span. Both are at most 1.
struct BoundParts {
  double acceleration, turn;
};
BoundParts boundParts(const BoundedMotion& motion, const ExactPath& exact,
                      const Vector3<double>& center, double radius, double t0, double t1,
                      Random& random);

/// @brief What a series of queries consisted of.
struct PathTally {
  std::size_t contacts{0}, misses{0}, grazes{0};
};

/// @brief `count` cases, fewer under the address sanitizer, times FCL_CCD_TEST_PATHS.
int pathCases(int count);

/// @brief A ball that follows the motion, off its origin, against a ball at rest. Dense
/// samples of the distance, with the lowest ones refined, are the reference. Every other
/// case grazes: the balls overlap or miss by 1e-2 to 1e-9 at their nearest.
/// @return what is wrong; empty if nothing
std::string ballDisagreement(const MotionBase<double>& motion, const ExactPath& exact,
                             Random& random, PathTally& tally);

/// @brief The same for two triangles, at distances and crossings in Real.
std::string triangleDisagreement(const MotionBase<double>& motion, const ExactPath& exact,
                                 Random& random, PathTally& tally);

}  // namespace test
}  // namespace fcl

#endif
