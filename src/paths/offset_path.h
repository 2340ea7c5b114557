// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_PATHS_OFFSET_PATH_H
#define FCL_CCD_PATHS_OFFSET_PATH_H

#include "fcl/math/motion/bounded_motion.h"
#include "paths/motion_path.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief The motion of a frame that is fixed to a body, whatever the path of the body.
/// For a turn MotionPath::placed() is faster.
class OffsetPath : public BoundedMotion {
 public:
  /// @param body  lives as long as this
  /// @param offset  the frame in that of the body; a rotation up to 2^-47
  OffsetPath(const MotionPath& body, const Pose& offset);

  Placement placementAt(double t) const override;
  Placement rateAt(double t) const override;
  double accelerationBound(const double (&center)[3], double radius, double t0,
                           double t1) const override;
  double angularSpeedBound(double t0, double t1) const override;
  Rounding moreRounding() const override;

 private:
  const MotionPath& body_;
  const Pose offset_;
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
