// SPDX-License-Identifier: BSD-3-Clause
//
// What the motion classes of this library have in common. The library computes them from
// numbers; FCL's types are converted by code that is compiled with the program.
#ifndef FCL_MATH_MOTION_DETAIL_FOLLOWED_MOTION_H
#define FCL_MATH_MOTION_DETAIL_FOLLOWED_MOTION_H

#include <cassert>
#include <memory>
#include <utility>

#include "fcl/common/exception.h"
#include "fcl/math/motion/bounded_motion.h"
#include "fcl/math/motion/motion_base.h"
#include "fcl/narrowphase/detail/query_numbers.h"

namespace fcl {
namespace detail {

/// @brief A transform as the library takes it.
template <typename S>
BoundedMotion::Placement placementOf(const Transform3<S>& tf) {
  const PoseNumbers<S> numbers = detail::toNumbers(tf);
  BoundedMotion::Placement out;
  for (int i = 0; i < 9; ++i) out.rotation[i] = static_cast<double>(numbers.rotation[i]);
  for (int k = 0; k < 3; ++k)
    out.translation[k] = static_cast<double>(numbers.translation[k]);
  return out;
}

/// @brief The rotation and the translation as a transform of the program.
template <typename S>
void setTransform(const BoundedMotion::Placement& placement, Transform3<S>& tf) {
  PoseNumbers<S> numbers;
  for (int i = 0; i < 9; ++i) numbers.rotation[i] = static_cast<S>(placement.rotation[i]);
  for (int k = 0; k < 3; ++k)
    numbers.translation[k] = static_cast<S>(placement.translation[k]);
  detail::setTransform(numbers, tf);
}

/// @brief A motion of the library as FCL's and this library's queries take it. What a
/// query reads is final: derived classes may not change it.
template <typename S>
class FollowedMotion : public MotionBase<S>, public BoundedMotion {
 public:
  Placement placementAt(double t) const final { return motion_->placementAt(t); }
  Placement rateAt(double t) const final { return motion_->rateAt(t); }
  double accelerationBound(const double (&center)[3], double radius, double t0,
                           double t1) const final {
    return motion_->accelerationBound(center, radius, t0, t1);
  }
  double angularSpeedBound(double t0, double t1) const final {
    return motion_->angularSpeedBound(t0, t1);
  }
  Rounding moreRounding() const final { return motion_->moreRounding(); }

  /// @brief What it follows: the same motion, which queries read at once.
  const BoundedMotion& path() const { return *motion_; }

  /// @brief Sets the time of getCurrentTransform(), as FCL's own motions do. It changes
  /// the motion. Queries of this library do not call it.
  bool integrate(S t) const override {
    t_ = t > 0 ? (t < 1 ? t : S(1)) : S(0);  // NaN: 0
    return true;
  }
  using MotionBase<S>::getCurrentTransform;
  void getCurrentTransform(Transform3<S>& tf) const override {
    detail::setTransform(placementAt(static_cast<double>(t_)), tf);
  }
  S computeMotionBound(const BVMotionBoundVisitor<S>&) const override {
    throw Exception(kNoBound);
  }
  S computeMotionBound(const TriangleMotionBoundVisitor<S>&) const override {
    throw Exception(kNoBound);
  }
  void getTaylorModel(TMatrix3<S>&, TVector3<S>&) const override {
    throw Exception(
        "FCL's Taylor models do not know this motion. For boxes of its objects use "
        "ContinuousCollisionManager or SweptCollisionObject");
  }

 protected:
  explicit FollowedMotion(std::shared_ptr<const BoundedMotion> motion)
      : motion_(std::move(motion)) {
    assert(motion_);
  }

 private:
  static constexpr const char* kNoBound =
      "FCL's conservative advancement does not know this motion. Give both objects "
      "geometries that this library answers, or set ccd_solver_type to CCDC_NAIVE";

  std::shared_ptr<const BoundedMotion> motion_;
  mutable S t_{0};
};

}  // namespace detail
}  // namespace fcl

#endif
