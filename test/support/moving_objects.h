// SPDX-License-Identifier: BSD-3-Clause
//
// Random objects that move, for the tests of the continuous manager.
#ifndef FCL_TEST_SUPPORT_MOVING_OBJECTS_H
#define FCL_TEST_SUPPORT_MOVING_OBJECTS_H

#include <memory>
#include <vector>

#include "fcl/math/motion/bounded_motion.h"
#include "fcl/math/motion/interp_motion.h"
#include "fcl/math/motion/screw_motion.h"
#include "fcl/math/motion/spline_motion.h"
#include "fcl/math/motion/translation_motion.h"
#include "fcl/narrowphase/continuous_collision_object.h"
#include "reference_motion.h"

namespace fcl {
namespace test {

/// @brief A throw from `from` with a velocity and an acceleration: a motion class of a
/// program, with what FCL wants of it.
class Throw : public MotionBase<double> {
 public:
  Throw(const Vector3<double>& from, const Vector3<double>& velocity,
        const Vector3<double>& acceleration)
      : from_(from), velocity_(velocity), acceleration_(acceleration) {}

  Vector3<double> at(double t) const {
    return from_ + t * velocity_ + .5 * t * t * acceleration_;
  }
  bool integrate(double t) const override {
    t_ = t;
    return true;
  }
  double computeMotionBound(const BVMotionBoundVisitor<double>&) const override {
    return velocity_.norm() + acceleration_.norm();
  }
  double computeMotionBound(const TriangleMotionBoundVisitor<double>&) const override {
    return velocity_.norm() + acceleration_.norm();
  }
  void getCurrentTransform(Transform3<double>& tf) const override {
    tf = Transform3<double>::Identity();
    tf.translation() = at(t_);
  }
  void getTaylorModel(TMatrix3<double>&, TVector3<double>&) const override {}

 protected:
  Vector3<double> from_, velocity_, acceleration_;

 private:
  mutable double t_{0};
};

/// @brief The same with bounds.
class BoundedThrow : public Throw, public BoundedMotion {
 public:
  using Throw::Throw;
  Placement placementAt(double t) const override {
    const Vector3<double> p = at(t);
    return {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {p[0], p[1], p[2]}};
  }
  Placement rateAt(double t) const override {
    const Vector3<double> v = velocity_ + t * acceleration_;
    return {{0, 0, 0, 0, 0, 0, 0, 0, 0}, {v[0], v[1], v[2]}};
  }
  double accelerationBound(const double (&)[3], double, double, double) const override {
    return acceleration_.norm() * (1 + 1e-15);
  }
  double angularSpeedBound(double, double) const override { return 0; }
};

inline std::shared_ptr<MotionBase<double>> toFcl(const ReferenceMotion& motion) {
  using Kind = ReferenceMotion::Kind;
  const Transform3<double>&beg = motion.beginning, &end = motion.end;
  if (motion.kind == Kind::kScrew) return std::make_shared<ScrewMotion<double>>(beg, end);
  if (motion.kind == Kind::kInterpolation)
    return std::make_shared<InterpMotion<double>>(beg.linear(), beg.translation(),
                                                  end.linear(), end.translation(),
                                                  motion.reference);
  const auto& t = motion.translation_points;
  const auto& r = motion.rotation_points;
  return std::make_shared<SplineMotion<double>>(t[0], t[1], t[2], t[3], r[0], r[1], r[2],
                                                r[3]);
}

inline std::shared_ptr<MotionBase<double>> translation(const Vector3<double>& from,
                                                       const Vector3<double>& to) {
  return std::make_shared<TranslationMotion<double>>(Matrix3<double>::Identity(), from,
                                                     to);
}

/// @brief An object with the owner of its motion. FCL's object keeps its user data
/// unset.
inline std::unique_ptr<ContinuousCollisionObject<double>> makeObject(
    const std::shared_ptr<CollisionGeometry<double>>& geometry,
    const std::shared_ptr<MotionBase<double>>& motion) {
  auto object = std::make_unique<ContinuousCollisionObject<double>>(geometry, motion);
  object->setUserData(nullptr);
  return object;
}

}  // namespace test
}  // namespace fcl

#endif
