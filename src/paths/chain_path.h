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

/// @brief The frame of a joint at a time, with its derivatives by t, in the world.
struct JointState {
  double rotation[9];
  Vec translation;
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
  const JointBounds& bounds(int joint) const {
    assert(joint < static_cast<int>(bounds_.size()));
    return joint < 0 ? base_bounds_ : bounds_[static_cast<std::size_t>(joint)];
  }

  /// @brief The values of the joints at t in [0, 1].
  std::vector<double> valuesAt(double t) const;

  /// @brief The frame of a joint at t. Those before it are computed too, and the thread
  /// keeps them: other links ask for the same times. Valid until it is asked again.
  const JointState& stateAt(int joint, double t) const;

 private:
  /// The joint's value and derivatives, as polynomials.
  struct Value {
    Coefficients at, rate, acceleration;
  };

  /// The frames of the first joints at a time.
  struct Kept {
    std::vector<JointState> states;
    std::size_t count{0};
  };

  /// Computes frames until there are `count`.
  void computeStates(double t, std::size_t count, Kept& kept) const;
  static void move(const JointTree::Joint& joint, const JointState& before,
                   const Value& value, double t, JointState& out);
  JointBounds boundsOf(const JointTree::Joint& joint, const Coefficients& value) const;

  std::shared_ptr<const JointTree> tree_;
  Pose base_;
  std::vector<Value> values_;
  JointState base_state_{};
  JointBounds base_bounds_{};
  std::vector<JointBounds> bounds_;
  /// Of this path: no other one of the process has it.
  std::uint64_t number_;
};

/// @brief The motion of a link.
class LinkPath : public BoundedMotion {
 public:
  /// @param link  a link of the tree, or another frame that a joint of it carries
  LinkPath(std::shared_ptr<const ChainPath> chain, const JointTree::Link& link);

  Placement placementAt(double t) const override;
  Placement rateAt(double t) const override;
  double accelerationBound(const double (&center)[3], double radius, double t0,
                           double t1) const override;
  double angularSpeedBound(double t0, double t1) const override;
  Rounding moreRounding() const override;

  /// @brief The bounds of a span, for many points.
  AccelerationBound accelerationIn(double t0, double t1) const;
  /// @brief That of the points within `radius` of a center.
  /// @param in  what accelerationIn() gave
  double boundOf(const AccelerationBound& in, const Vec& center, double radius) const;

  /// @brief Keeps what a path of this motion has at its beginning, for the many queries
  /// of an edge. The motion must not be moved after that.
  void keepPath() { kept_ = std::make_shared<MotionPath>(MotionPath::bounded(*this)); }
  /// @brief Null: it is not kept.
  const MotionPath* keptPath() const { return kept_.get(); }

 private:
  double turnSpeedIn(double t0, double t1, const JointState& middle) const;
  const JointBounds& bounds() const { return chain_->bounds(joint_); }
  bool isRevolute() const;
  DerivativeBounds boundsOfBall(const Vec& center, double radius) const;

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
