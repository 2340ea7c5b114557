// SPDX-License-Identifier: BSD-3-Clause
//
// Paths of motions against their formulas, and the bounds on which queries rely.
#include "motion/motion_path.h"

#include <gtest/gtest.h>

#include <cmath>

#include "fcl/common/exception.h"
#include "motion/sine.h"
#include "reference_motion.h"

namespace fcl {
namespace test {
namespace {

using namespace detail::deformable;

constexpr double kUnitRounding = 0x1p-53;

Vector3<double> applied(const Pose& pose, const Vector3<double>& x) {
  Vector3<double> out;
  for (int k = 0; k < 3; ++k)
    out[k] = pose.rotation[3 * k] * x[0] + pose.rotation[3 * k + 1] * x[1] +
             pose.rotation[3 * k + 2] * x[2] + pose.translation[k];
  return out;
}

Vector3<double> applied(const PoseRate& rate, const Vector3<double>& x) {
  Pose pose;
  std::copy(rate.rotation, rate.rotation + 9, pose.rotation);
  std::copy(rate.translation, rate.translation + 3, pose.translation);
  return applied(pose, x);
}

TEST(FCL_MOTION_PATH, sineAndCosine) {
  Random random(1);
  Real worst = 0, worst_relative = 0;
  for (int i = 0; i < 200000; ++i) {
    const double range = i % 2 ? 0x1p20 : std::ldexp(1., static_cast<int>(i % 50) - 40);
    const double x = random.uniform(-range, range);
    const SineCosine at = sineCosine(x);
    const Real s = std::sin(Real{x}), c = std::cos(Real{x});
    worst = std::max({worst, std::abs(at.sine - s), std::abs(at.cosine - c)});
    if (std::abs(x) < 0.785)
      worst_relative = std::max(worst_relative, std::abs((at.sine - s) / s));
    // An angle in the first quarter.
    const double angle = std::abs(std::remainder(x, 1.5));
    const SineCosine of = sineCosine(angle);
    ASSERT_NEAR(angleOf(of.cosine, of.sine), angle, 8 * kUnitRounding);
  }
  EXPECT_LE(worst, 4 * kUnitRounding);
  EXPECT_LE(worst_relative, 4 * kUnitRounding);
}

// Expects that positions and velocities are those of the formula within the bounds.
TEST(FCL_MOTION_PATH, staysNearItsFormula) {
  Random random(2);
  double worst = 0, worst_rate = 0;
  for (int i = 0; i < 20000; ++i) {
    const ReferenceMotion motion = randomMotion(random, 1);
    const MotionPath path = motion.path();
    const Vector3<double> x = random.point(1);
    const double t = random.uniform(0, 1);
    const RealVector expected = motion.at(t) * x;
    const double error =
        static_cast<double>((applied(path.pose(t), x).cast<Real>() - expected).norm());
    worst = std::max(worst, error / path.positionError(x.norm()));
    // In long double a difference quotient of third order has an error of 1e-9.
    const Real h = 1e-5L;
    const RealVector rate = (8 * (motion.at(t + h) * x - motion.at(t - h) * x) -
                             (motion.at(t + 2 * h) * x - motion.at(t - 2 * h) * x)) /
                            (12 * h);
    worst_rate = std::max(
        worst_rate,
        static_cast<double>((applied(path.rate(t), x).cast<Real>() - rate).norm()));
    ASSERT_LE(applied(path.rate(t), x).norm(), path.speed(x.norm()));
  }
  EXPECT_LE(worst, 1);
  EXPECT_GE(worst, 0.01) << "a bound far too wide";
  EXPECT_LE(worst_rate, 1e-11);
}

TEST(FCL_MOTION_PATH, reachesItsEnds) {
  Random random(3);
  for (int i = 0; i < 20000; ++i) {
    ReferenceMotion motion = randomMotion(random, 1);
    if (motion.kind == ReferenceMotion::Kind::kSpline) continue;
    if (i % 5 == 0) motion.turn(randomDirection(random), i % 2 ? M_PI : 3.1415926);
    const MotionPath path = motion.path();
    const Vector3<double> x = random.point(1);
    const double error = path.positionError(x.norm());
    EXPECT_LE((applied(path.pose(0), x) - motion.beginning * x).norm(), error);
    EXPECT_LE((applied(path.pose(1), x) - motion.end * x).norm(), error);
    EXPECT_LT(error, 1e-13);
  }
}

TEST(FCL_MOTION_PATH, farFromTheOrigin) {
  Random random(5);
  for (int i = 0; i < 2000; ++i) {
    ReferenceMotion motion = randomMotion(random, 1);
    const Vector3<double> origin(1e6, -3e5, 7e5);
    motion.move(origin);
    motion.origin = origin;
    MotionPath path = motion.path();
    path.shift({origin[0], origin[1], origin[2]});
    const Vector3<double> x = random.point(1);
    const double t = random.uniform(0, 1);
    EXPECT_LE((applied(path.pose(t), x).cast<Real>() - motion.at(t) * x).norm(),
              path.positionError(x.norm()));
    EXPECT_LT(path.positionError(x.norm()), 1e-13);
  }
}

TEST(FCL_MOTION_PATH, refusesWildSplines) {
  double points[4][3] = {}, wild[4][3] = {};
  wild[2][1] = 2e6;
  EXPECT_THROW(MotionPath::spline(points, wild), Exception);
  wild[2][1] = std::nan("");
  EXPECT_THROW(MotionPath::spline(points, wild), Exception);
}

}  // namespace
}  // namespace test
}  // namespace fcl
