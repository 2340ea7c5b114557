// SPDX-License-Identifier: BSD-3-Clause
//
// A body with a constant angular velocity w a, by any angle. A point x of it is at
//
//   R1 x + T1 + sin(w t) C (x - o) + (1 - cos(w t)) D (x - o) + q(t)
//
// with C = [a] R1 and D = [a] C, where o is the reference point. Its way q(t) is
// straight, v t, or with the screw,
//
//   q(t) = t v_a + sin(w t) / w v_p + (1 - cos(w t)) / w a x v_p,
//
// for the parts v_a of the velocity v along the axis and v_p at right angles to it.
#ifndef FCL_CCD_PATHS_TWIST_PATH_H
#define FCL_CCD_PATHS_TWIST_PATH_H

#include "fcl/math/motion/bounded_motion.h"
#include "mesh/vertex_frames.h"
#include "numerics/moving_vector.h"

namespace fcl {
namespace detail {
namespace deformable {

class TwistPath : public BoundedMotion {
 public:
  /// @param linear, angular  of the reference point and of the body, in the world, for a
  /// step
  /// @param reference  in the frame of the body
  /// @param is_screw  the reference point follows the screw; else it goes straight
  /// @pre the pose is a rotation up to 2^-47; the angle is at most kMostAngle
  TwistPath(const Pose& pose, const Vec& linear, const Vec& angular, const Vec& reference,
            bool is_screw);

  Placement placementAt(double t) const override;
  Placement rateAt(double t) const override;
  double accelerationBound(const double (&center)[3], double radius, double t0,
                           double t1) const override;
  double angularSpeedBound(double t0, double t1) const override;
  Rounding moreRounding() const override;

 private:
  Pose pose_;
  /// w.
  double angle_;
  /// C and D; C o and D o.
  double sine_rotation_[9]{}, cosine_rotation_[9]{};
  Vec sine_reference_{0, 0, 0}, cosine_reference_{0, 0, 0};
  /// The factor of t in q; v_p and a x v_p, which are 0 on the straight way.
  Vec straight_, sine_way_{0, 0, 0}, cosine_way_{0, 0, 0};
  /// |o|, |v|.
  double reference_size_, speed_;
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
