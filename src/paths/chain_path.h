// SPDX-License-Identifier: BSD-3-Clause
//
// The motion of a robot's links while its joints follow polynomials.
//
// A joint j turns or moves its frame in that of the joint before it, p: with the origin
// (x, B), the axis a in the frame of p and the value q(t),
//
//   revolute:   R = R_p B exp(q [a]),  T = T_p + R_p x
//   prismatic:  R = R_p B,             T = T_p + R_p (x + q a)
//
// The bounds are of two kinds, of which the lesser one holds. The rule of products bounds
// the derivatives of R and T during the whole step. With a bound J on |p'''| and the
// acceleration in the middle m of a span of the length h,
//
//   |p''(t)| <= |p''(m)| + J h / 2.
#ifndef FCL_CCD_PATHS_CHAIN_PATH_H
#define FCL_CCD_PATHS_CHAIN_PATH_H

#include <cassert>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "fcl/math/motion/bounded_motion.h"
#include "paths/joint_tree.h"
#include "paths/motion_path.h"
#include "paths/turning_bounds.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief The derivatives by t of the frame of a joint at a time, in the world.
struct JointRates {
  /// T', T''.
  Vec speed, acceleration;
  /// The angular velocity and its derivative.
  Vec turn, turn_rate;
};

/// @brief What holds for the frame of a joint during the whole step.
struct JointBounds {
  /// Of R, T, and of the rotation of the joint before it.
  DerivativeBounds rotation, translation, rotation_before;
  /// Bound on the sum of the lengths from the origin of the world to that of the frame.
  double reach;
  /// Of R and T (spectral norm, length), of the angular velocity and of T'.
  double rotation_error, translation_error, turn_error, speed_error;
};

class ChainPath {
 public:
  /// @param tree  lives as long as the path and does not change
  /// @param values  of each joint that moves, in radians or units of length, for t in
  /// [0, 1]
  /// @throws fcl::Exception  a value is not finite, or an angle beyond kMostAngle
  /// (linear: at an end; else the sum of the sizes of the coefficients)
  ChainPath(std::shared_ptr<const JointTree> tree, const Pose& base,
            std::vector<Coefficients> values);

  const JointTree& tree() const { return *tree_; }
  const std::shared_ptr<const JointTree>& sharedTree() const { return tree_; }
  const Pose& base() const { return base_; }
  /// @brief Whether all joints move at constant speed.
  bool isSteady() const { return is_steady_; }
  const JointBounds& bounds(int joint) const {
    assert(joint < static_cast<int>(bounds_.size()));
    return joint < 0 ? base_bounds_ : bounds_[static_cast<std::size_t>(joint)];
  }

  /// @brief The values of the joints at t in [0, 1].
  std::vector<double> valuesAt(double t) const;

  /// @brief The frame of a joint at t. Those before it are computed too, and the thread
  /// keeps them: other links ask for the same times. Valid until it is asked again.
  const Pose& poseAt(int joint, double t) const;

  /// @brief A frame and its derivatives.
  struct State {
    const Pose& pose;
    const JointRates& rates;
  };
  /// @brief The same for the derivatives. Many times are asked for the frame alone.
  State stateAt(int joint, double t) const;

 private:
  /// The joint's value and derivatives, as polynomials.
  struct Value {
    Coefficients at, rate, acceleration;
  };

  /// The frames of the first joints at a time, and the derivatives of some.
  struct Kept {
    std::vector<Pose> poses;
    std::vector<JointRates> rates;
    std::size_t num_poses{0}, num_rates{0};
  };

  Kept& keptAt(double t) const;
  void computePoses(double t, std::size_t count, Kept& kept) const;
  void computeRates(double t, std::size_t count, Kept& kept) const;
  static Vec wayOf(const JointTree::Joint& joint, const Pose& before, const Value& value,
                   double t);
  static void move(const JointTree::Joint& joint, const Pose& before, const Value& value,
                   double t, Pose& out);
  static void rates(const JointTree::Joint& joint, const Pose& before,
                    const JointRates& rates_before, const Value& value, double t,
                    JointRates& out);
  JointBounds boundsOf(const JointTree::Joint& joint, const Coefficients& value) const;

  std::shared_ptr<const JointTree> tree_;
  Pose base_;
  std::vector<Value> values_;
  JointRates base_rates_{};
  JointBounds base_bounds_{};
  std::vector<JointBounds> bounds_;
  bool is_steady_{true};
  /// Of this path: no other one of the process has it.
  std::uint64_t number_;
};

/// @brief A bound that is linear in the radius of a ball and the distance of its center
/// from the origin of the body.
struct LinearBound {
  double per_radius, per_distance, constant;
};

/// @brief The motion of a link.
class LinkPath : public BoundedMotion {
 public:
  /// @param link  a link of the tree, or another frame that a joint of it carries
  LinkPath(std::shared_ptr<const ChainPath> chain, const JointTree::Link& link);

  Placement placementAt(double t) const override;
  /// @brief The same for the library, whose floating-point mode is the default one.
  Pose poseAt(double t) const;
  Placement rateAt(double t) const override;
  double accelerationBound(const double (&center)[3], double radius, double t0,
                           double t1) const override;
  double angularSpeedBound(double t0, double t1) const override;
  Rounding moreRounding() const override;

  /// @brief The bound of the rule of products for the whole step.
  AccelerationBound accelerationInStep() const;
  /// @brief A bound for a span: that, or the one from the middle of the span.
  AccelerationBound accelerationIn(double t0, double t1) const;

  /// @brief Bounds on the speed of the link's origin, and on how far it goes from where
  /// it begins.
  double speedBound() const;
  double extentBound() const;

  /// @brief Whether all joints move at constant speed. Then the bound for the whole step
  /// is nearly as good as those of spans.
  bool isSteady() const { return chain_->isSteady(); }

  /// @brief Keeps what a path of this motion has at its beginning, for the many queries
  /// of an edge. The motion must not be moved after that.
  void keepPath() { kept_ = std::make_shared<MotionPath>(MotionPath::bounded(*this)); }
  /// @brief Null: it is not kept.
  const MotionPath* keptPath() const { return kept_.get(); }

 private:
  double turnSpeedIn(double t0, double t1, const JointRates& middle) const;
  const JointBounds& bounds() const { return chain_->bounds(joint_); }
  /// The radius of a ball of the link in the frame of the joint, and how far its points
  /// are from the origin there.
  LinearBound radiusInJoint() const;
  LinearBound reachInJoint() const;
  AccelerationBound accelerationFromMiddle(double t0, double t1) const;

  std::shared_ptr<const ChainPath> chain_;
  int joint_;
  /// The link in the frame of the joint.
  RoundedPose pose_;
  std::shared_ptr<const MotionPath> kept_;
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
