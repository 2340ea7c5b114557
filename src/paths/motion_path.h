// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_PATHS_MOTION_PATH_H
#define FCL_CCD_PATHS_MOTION_PATH_H

#include <algorithm>
#include <iterator>

#include "fcl/math/motion/bounded_motion.h"
#include "mesh/vertex_frames.h"
#include "numerics/moving_vector.h"
#include "paths/posed_vector.h"

namespace fcl {
namespace detail {
namespace deformable {

class LinkPath;

/// @brief Bounds on the acceleration |p''(t)| during a span of time, of all points within
/// `radius` of a center (body frame): |turn center + offset| + per_radius radius +
/// per_distance |center| + constant, or what a motion of the program says. If a point
/// moves straight in the body frame from x0 to x1 during the step,
/// per_displacement |x1 - x0| is added.
struct AccelerationBound {
  double turn[9];
  double offset[3];
  double per_radius;
  double per_distance;
  double constant;
  double per_displacement;
  /// |p'''(t)| of a point at rest in the body is at most this factor times the bound.
  /// Infinite: unknown.
  double jerk;
  /// A motion of the program, its name in errors, and the span. Null: the numbers above
  /// are the bound.
  const BoundedMotion* motion;
  const char* name;
  double t0, t1;

  double of(const Vec& center, double radius) const;
  /// @brief The bound for all points within `radius` of a center that is anywhere on the
  /// line between two places.
  double between(const Vec& begin, const Vec& end, double radius) const;
  /// @brief Whether all points at rest in the body frame go straight.
  bool isZero() const;

 private:
  /// What the motion of the program says.
  double ofProgram(const Vec& center, double radius) const;
};

/// @brief A turn at constant speed,
///
///   p(t) = (R1 x + T1) + t (E x + L) + sin(w t) (C x + P) + (1 - cos(w t)) (D x + Q),
///
/// with C = [a] R1, D = [a]^2 R1 for an axis a. R1 and T1 are the pose at the beginning.
/// E and L are such that t = 1 gives the pose at the end: E corrects rounding and
/// matrices that are not exactly rotations, L is the straight part of the motion.
/// Interpolation turns about a reference point that goes straight, a screw about a fixed
/// axis. P and Q are zero if the reference point is the origin of the body. Without a
/// turn w, C, D, P and Q are zero.
struct Turn {
  /// w and a.
  double angle{0};
  Vec axis{1, 0, 0};
  /// R1, T1.
  Pose beginning;
  /// C, D, E.
  double sine_rotation[9]{};
  double cosine_rotation[9]{};
  double linear_rotation[9]{};
  /// P, Q, L.
  double sine_translation[3]{};
  double cosine_translation[3]{};
  double linear_translation[3]{};
};

/// @brief The motion of a rigid body, or of the frame in which a mesh deforms, for t in
/// [0, 1]: the real-number evaluation of parameters that are doubles. It is a turn, or a
/// uniform cubic B-spline of translations and of rotation vectors, as FCL's SplineMotion.
/// Or it is a motion of the program.
class MotionPath {
 public:
  /// @brief At rest.
  static MotionPath still(const Pose& pose);

  /// @brief Turns about a reference point (body frame) that goes straight.
  /// @param half_turn_axis  a turn goes the shorter way round. Both ways of a half turn
  /// are as long, up to rounding: it goes about this vector, not about its negative.
  static MotionPath interpolation(const Pose& beginning, const Pose& end,
                                  const double (&reference)[3],
                                  const Vec& half_turn_axis = {0, 0, 0});

  /// @brief Turns about an axis and slides along it, both at constant speed.
  /// @param half_turn_axis  as for interpolation()
  static MotionPath screw(const Pose& beginning, const Pose& end,
                          const Vec& half_turn_axis = {0, 0, 0});

  /// @brief The control points of the translation and of the rotation vector.
  /// @param name  the name of the object in errors
  /// @throws fcl::Exception  when a rotation vector is longer than kMostAngle
  static MotionPath spline(const double (&translation)[4][3],
                           const double (&rotation)[4][3],
                           const char* name = "the object");

  /// @brief A motion of the program. It must live as long as the path.
  /// @param name  the name of the object in errors; must live as long, too
  /// @throws fcl::Exception  when a placement or a bound is not finite
  static MotionPath bounded(const BoundedMotion& motion, const char* name = "the object");

  /// @brief The same path, but with the rotation of the beginning at all times.
  /// @pre it is a turn
  MotionPath withFixedRotation() const;

  /// @brief The beginning of the same path and its straight part only.
  /// @pre it is a turn
  MotionPath withoutTurn() const;

  /// @brief The path of a frame that is fixed to the body. What it rounds more is in the
  /// bounds.
  /// @param offset  the frame in that of the body; a rotation up to 2^-47
  /// @pre it is a turn
  MotionPath placed(const Pose& offset) const;

  /// @brief The name of the object in errors. It must live as long as the path.
  const char* name() const { return name_; }
  void setName(const char* name) { name_ = name; }

  /// @brief Moves the path by -origin. Rounds by 2^-53 of the new coordinates.
  void shift(const double (&origin)[3]);

  /// @brief The pose at a time in [0, 1].
  Pose pose(double t) const;
  PoseRate rate(double t) const;
  /// @brief The second derivative of a turn, within 2^-46 of the bound on it. Not for
  /// other paths.
  PoseRate turnAccelerationAt(double t) const;

  /// @brief Bound on the acceleration during [t0, t1].
  AccelerationBound acceleration(double t0, double t1) const;

  /// @brief Null: another path.
  const Turn* turn() const { return kind_ == Kind::kTurn ? &turn_ : nullptr; }

  /// @brief The axis of a turn, a unit vector of the world; null: another path. Points
  /// are hardly accelerated along it.
  const Vec* axis() const {
    return kind_ == Kind::kTurn && turn_.angle > 0 ? &turn_.axis : nullptr;
  }

  /// @brief Bound on the acceleration along the axis, up to 256 u of the size of the path
  /// and the point.
  /// @param displacement  how far the point moves in the body frame
  double axisAcceleration(double displacement) const;

  /// @brief Whether that bound is the same for all spans.
  bool hasConstantAcceleration() const { return kind_ == Kind::kTurn; }

  /// @brief Whether the bound for the whole step is the same as those of spans, or nearly
  /// as good. Boxes take it then.
  bool hasSteadyAcceleration() const;

  /// @brief Whether the rotation is the same at all times.
  bool isTranslation() const {
    return kind_ == Kind::kTurn && turn_.angle == 0 &&
           std::all_of(std::begin(turn_.linear_rotation), std::end(turn_.linear_rotation),
                       [](double x) { return x == 0; });
  }

  /// @brief Bound on |T(t)|.
  double largestTranslation() const { return largest_translation_; }

  /// @brief The largest factor by which a rotation makes a vector longer.
  double stretch() const { return stretch_; }

  /// @brief Bound on the rounding of a unit vector that pose(t) rotates.
  double rotationError() const;

  /// @brief Bound on the rounding, along any unit direction, of pose(t) applied to a
  /// point with |x| <= radius. It includes the sum of three products and the translation.
  double positionError(double radius) const;

  /// @brief Bound on the velocity of a point with |x| <= radius that rests in the body.
  double speed(double radius) const { return turn_speed_ * radius + translation_speed_; }

  /// @brief Bound on the factor by which the derivative of the rotation makes a vector
  /// longer.
  double turnSpeed() const { return turn_speed_; }

  /// @brief The same as rotationError(), but for rate(t).
  double rotationRateError() const;

  /// @brief The same as positionError(), but for rate(t).
  double rateError(double radius) const;

 private:
  enum class Kind { kTurn, kSpline, kBounded };

  static MotionPath turnFrom(const Pose& beginning, const Pose& end,
                             const Vec& half_turn_axis);
  void reachEnd(const Pose& end);
  bool hasTurningRotation() const;
  void setTurnBounds();
  Pose turnPose(double t) const;
  PoseRate turnRate(double t) const;
  AccelerationBound turnAcceleration() const;
  void setSplineSize();
  Pose splinePose(double t) const;
  PoseRate splineRate(double t) const;
  AccelerationBound splineAcceleration(double t0, double t1) const;
  void setBoundedSpeed();
  void setBoundedSize();
  Pose boundedPose(double t) const;
  PoseRate boundedRate(double t) const;
  AccelerationBound boundedAcceleration(double t0, double t1) const;

  const char* name_{"the object"};
  Kind kind_{Kind::kTurn};
  // Members of a turn.
  Turn turn_;
  /// Distance of the reference point from the origin of the body.
  double reference_size_{0};
  // Members of a spline.
  double translation_points_[4][3]{};
  double rotation_points_[4][3]{};
  // Members of a motion of the program.
  const BoundedMotion* motion_{nullptr};
  /// The same, if it is the motion of a link of a chain.
  const LinkPath* link_{nullptr};
  double origin_[3]{};
  BoundedMotion::Rounding more_rounding_{};
  /// Bound on |T(t) - T(0)|.
  double extent_{0};

  double stretch_{1};
  double largest_translation_{0};
  /// Size of the terms whose sum is a translation.
  double translation_size_{0};
  double turn_speed_{0};
  double translation_speed_{0};
  /// Rounding of an entry of the rotation, in u.
  double rotation_error_{0};
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
