// SPDX-License-Identifier: BSD-3-Clause
//
// Motions by a constant velocity and angular velocity, against the exponential of the
// twist in Real. FCL_CCD_TEST_PATHS makes the series so many times as long:
//   FCL_CCD_TEST_PATHS=10 build/release/test/unit/test_fcl_twist_motion
#include "fcl/math/motion/twist_motion.h"

#include <gtest/gtest.h>

#include <cfenv>
#include <cmath>

#include "fcl/geometry/shape/sphere.h"
#include "fcl/math/motion/interp_motion.h"
#include "fcl/math/motion/screw_motion.h"
#include "fcl/math/motion/translation_motion.h"
#include "fcl/narrowphase/continuous_collision.h"
#include "path_checks.h"
#include "sanitizer.h"
#include "test_models.h"

namespace fcl {
namespace test {
namespace {

using Vector = Vector3<double>;
using Tf = Transform3<double>;
using Real4 = Eigen::Matrix<Real, 4, 4>;

/// The exponential, by squaring that of a 2^-n part.
Real4 exponential(Real4 x) {
  int halvings = 0;
  for (; x.norm() > 1; ++halvings) x /= 2;
  Real4 sum = Real4::Identity(), term = Real4::Identity();
  for (int k = 1; k < 24; ++k) sum += term = (term * x / Real(k)).eval();
  for (int i = 0; i < halvings; ++i) sum = (sum * sum).eval();
  return sum;
}

RealMatrix crossOf(const RealVector& w) {
  RealMatrix m;
  m << 0, -w[2], w[1], w[2], 0, -w[0], -w[1], w[0], 0;
  return m;
}

struct Twist {
  Tf pose{Tf::Identity()};
  Vector linear{Vector::Zero()}, angular{Vector::Zero()}, reference{Vector::Zero()};
  ReferencePath path{ReferencePath::kScrew};

  TwistMotion<double> motion() const {
    return TwistMotion<double>(pose, linear, angular, path, reference);
  }

  /// By the series.
  RealPose atBySeries(Real t) const {
    const RealMatrix r = pose.linear().cast<Real>();
    const RealVector o = reference.cast<Real>(), v = linear.cast<Real>(),
                     there = r * o + pose.translation().cast<Real>();
    Real4 xi = Real4::Zero();
    xi.topLeftCorner<3, 3>() = crossOf(angular.cast<Real>());
    // In coordinates from the reference point, whose velocity is v.
    if (path == ReferencePath::kScrew) xi.topRightCorner<3, 1>() = v;
    const Real4 moved = exponential(xi * t);
    const RealMatrix turned = moved.topLeftCorner<3, 3>() * r;
    const RealVector way = path == ReferencePath::kScrew
                               ? RealVector(moved.topRightCorner<3, 1>())
                               : RealVector(v * t);
    return {turned, there + way - turned * o};
  }
  /// The same in closed form, which takes less time.
  RealPose at(Real t) const {
    const RealMatrix r = pose.linear().cast<Real>();
    const RealVector o = reference.cast<Real>(), v = linear.cast<Real>(),
                     there = r * o + pose.translation().cast<Real>(),
                     w = angular.cast<Real>();
    const Real angle = w.norm();
    if (angle == 0) return {r, there + v * t - r * o};
    const RealVector a = w / angle, along = a * a.dot(v), across = v - along;
    const RealMatrix turned = rotationAbout(a, angle * t) * r;
    const Real half = sin(angle * t / 2);
    const RealVector way =
        path == ReferencePath::kStraight
            ? RealVector(v * t)
            : RealVector(along * t + across * (sin(angle * t) / angle) +
                         a.cross(across) * (2 * half * half / angle));
    return {turned, there + way - turned * o};
  }
  /// The derivative by t.
  RealPose rateAt(Real t) const {
    const RealVector o = reference.cast<Real>(), v = linear.cast<Real>(),
                     w = angular.cast<Real>();
    const RealMatrix turning = crossOf(w) * at(t).rotation;
    const Real angle = w.norm();
    const RealVector speed = path == ReferencePath::kStraight || angle == 0
                                 ? v
                                 : RealVector(rotationAbout(w / angle, angle * t) * v);
    return {turning, speed - turning * o};
  }
  ExactPath exact() const {
    return [this](Real t) { return at(t); };
  }
};

Twist randomTwist(Random& random) {
  constexpr double kAngles[] = {0, 1e-300, 1e-12, 1e-5, .3, 1, 3.1, 7, 20};
  Twist twist;
  twist.pose.linear() = randomRotation(random);
  twist.pose.translation() = random.point(1);
  twist.linear = random.point(random.index(3) ? 1 : 5);
  twist.angular = randomDirection(random) * kAngles[random.index(9)];
  if (random.index(2)) twist.reference = random.point(.7);
  if (random.index(2)) twist.path = ReferencePath::kStraight;
  return twist;
}

/// The closed form in which the tests compute the exact path.
TEST(FCL_TWIST_MOTION, formulaIsTheExponential) {
  Random random(6);
  for (int i = 0; i < rounds(1000); ++i) {
    const Twist twist = randomTwist(random);
    const double t = random.uniform(0, 1);
    const RealPose series = twist.atBySeries(t), closed = twist.at(t);
    ASSERT_LE((series.rotation - closed.rotation).norm(), 1e-16L);
    ASSERT_LE((series.translation - closed.translation).norm(), 1e-16L);
  }
}

TEST(FCL_TWIST_MOTION, beginsAtItsPose) {
  Random random(1);
  for (int i = 0; i < 100; ++i) {
    const Twist twist = randomTwist(random);
    const auto begin = twist.motion().placementAt(0);
    for (int k = 0; k < 3; ++k)
      EXPECT_EQ(begin.translation[k], twist.pose.translation()[k]);
    for (int k = 0; k < 9; ++k)
      EXPECT_NEAR(begin.rotation[k], twist.pose.linear()(k / 3, k % 3), 0x1p-49);
  }
}

/// All of the rounding is in moreRounding(): of many turns, of lengths of 1e6 and 1e-6,
/// and of points far from the reference point too.
TEST(FCL_TWIST_MOTION, saysItsRounding) {
  Random random(7);
  for (const double most_angle : {1e-9, 1., 30., 1e3, 0x1p20}) {
    RoundingParts worst{};
    for (int i = 0; i < rounds(3000); ++i) {
      Twist twist = randomTwist(random);
      twist.angular = randomDirection(random) * most_angle * random.uniform(.5, 1);
      const auto size = [&] { return std::pow(10, 6 * random.uniform(-1, 1)); };
      twist.pose.translation() *= size();
      twist.linear *= size();
      twist.reference *= size();
      const double t = i % 4 ? random.uniform(0, 1) : 1;
      worst =
          greatest(worst, ownRoundingParts(twist.motion(), twist.at(t), twist.rateAt(t),
                                           randomDirection(random), t));
    }
    EXPECT_LE(worst.pose, 1) << most_angle;
    EXPECT_LE(worst.rate, 1) << most_angle;
    EXPECT_GE(worst.pose, .02) << most_angle;
    EXPECT_GE(worst.rate, .02) << most_angle;
  }
}

/// The bounds are the accelerations themselves, at the outermost point of the ball.
TEST(FCL_TWIST_MOTION, boundsAreExact) {
  Random random(2);
  for (int i = 0; i < rounds(100); ++i) {
    const Twist twist = randomTwist(random);
    if (twist.angular.norm() < .1) continue;
    const double t0 = random.uniform(0, .9);
    const BoundParts of = boundParts(twist.motion(), twist.exact(), random.point(1), 0,
                                     t0, t0 + .1, random);
    EXPECT_LE(of.acceleration, 1);
    EXPECT_GE(of.acceleration, 1 - 1e-7);
    EXPECT_LE(of.turn, 1);
    EXPECT_LE(boundParts(twist.motion(), twist.exact(), random.point(1), .5, t0, t0 + .1,
                         random)
                  .acceleration,
              1);
  }
}

constexpr char kNothing[] = "";

TEST(FCL_TWIST_MOTION, ballsMeetAtTheTimeOfSamples) {
  Random random(3);
  PathTally tally;
  for (int i = 0; i < pathCases(500); ++i) {
    const Twist twist = randomTwist(random);
    ASSERT_EQ(ballDisagreement(twist.motion(), twist.exact(), random, tally), kNothing)
        << "case " << i;
  }
  EXPECT_GE(tally.contacts, rounds(50U));
  EXPECT_GE(tally.misses, rounds(50U));
  EXPECT_GE(tally.grazes, rounds(100U));
}

TEST(FCL_TWIST_MOTION, trianglesMeetAtTheTimeOfSamples) {
  Random random(4);
  PathTally tally;
  for (int i = 0; i < pathCases(120); ++i) {
    const Twist twist = randomTwist(random);
    ASSERT_EQ(triangleDisagreement(twist.motion(), twist.exact(), random, tally),
              kNothing)
        << "case " << i;
  }
  EXPECT_GE(tally.contacts, rounds(10U));
  EXPECT_GE(tally.misses, rounds(10U));
}

/// Below half a turn they are FCL's motions between the poses at the ends.
TEST(FCL_TWIST_MOTION, areFclsMotionsBelowHalfATurn) {
  Random random(5);
  for (int i = 0; i < 200; ++i) {
    Twist twist = randomTwist(random);
    twist.angular = randomDirection(random) * random.uniform(.1, 3);
    const RealPose last = twist.at(1);
    Tf end = Tf::Identity();
    end.linear() = last.rotation.cast<double>();
    end.translation() = last.translation.cast<double>();
    const auto motion = twist.motion();
    const auto at = motion.placementAt(.3);
    const ScrewMotion<double> screw(twist.pose, end);
    const InterpMotion<double> interpolation(twist.pose.linear(),
                                             twist.pose.translation(), end.linear(),
                                             end.translation(), twist.reference);
    Tf tf;
    if (twist.path == ReferencePath::kScrew) {
      screw.integrate(.3);
      screw.getCurrentTransform(tf);
    } else {
      interpolation.integrate(.3);
      interpolation.getCurrentTransform(tf);
    }
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(at.translation[k], tf.translation()[k], 1e-7);
    for (int k = 0; k < 9; ++k)
      EXPECT_NEAR(at.rotation[k], tf.linear()(k / 3, k % 3), 1e-7);
  }
}

/// A ball that circles 3 times about the origin at the distance 1, and a ball at rest
/// that it meets in its third turn only, since it rises. In float too.
template <typename S>
S meet() {
  Transform3<S> pose = Transform3<S>::Identity();
  pose.translation() = Vector3<S>(1, 0, 0);
  // The velocity of a point on the circle: the screw keeps it there.
  const S turn = S(6 * M_PI);
  const TwistMotion<S> motion(pose, Vector3<S>(0, turn, 3), Vector3<S>(0, 0, turn));
  const Sphere<S> ball(S(.25));
  const Vector3<S> at(1, 0, 2);
  const TranslationMotion<S> still(Matrix3<S>::Identity(), at, at);
  ContinuousCollisionRequest<S> request;
  request.toc_err = S(1e-9);
  ContinuousCollisionResult<S> result;
  return continuousCollide(&ball, &motion, &ball, &still, request, result);
}

TEST(FCL_TWIST_MOTION, turnsMoreThanOnce) {
  const auto distance = [](double t) {
    return std::hypot(std::cos(6 * M_PI * t) - 1, std::sin(6 * M_PI * t), 3 * t - 2);
  };
  double before = .6, after = 2. / 3;
  for (int i = 0; i < 60; ++i) {
    const double middle = (before + after) / 2;
    (distance(middle) > .5 ? before : after) = middle;
  }
  EXPECT_LE(meet<double>(), after);
  EXPECT_NEAR(meet<double>(), after, 2e-9);
  EXPECT_NEAR(meet<float>(), after, 1e-6);
}

/// A body whose velocities are zero rests exactly.
TEST(FCL_TWIST_MOTION, rests) {
  Random random(8);
  Twist twist = randomTwist(random);
  twist.linear = twist.angular = Vector::Zero();
  const auto motion = twist.motion();
  EXPECT_EQ(motion.accelerationBound({1, 2, 3}, 1, 0, 1), 0);
  EXPECT_EQ(motion.angularSpeedBound(0, 1), 0);
  const auto begin = motion.placementAt(0), end = motion.placementAt(1);
  for (int k = 0; k < 9; ++k) EXPECT_EQ(begin.rotation[k], end.rotation[k]);
  for (int k = 0; k < 3; ++k) EXPECT_EQ(begin.translation[k], end.translation[k]);
}

TEST(FCL_TWIST_MOTION, isTheSameInAllRoundingModes) {
  Random random(9);
  for (int i = 0; i < 100; ++i) {
    const auto motion = randomTwist(random).motion();
    const auto expected = motion.placementAt(.3), rate = motion.rateAt(.3);
    for (const int mode : {FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO}) {
      std::fesetround(mode);
      const auto at = motion.placementAt(.3), rate_at = motion.rateAt(.3);
      std::fesetround(FE_TONEAREST);
      for (int k = 0; k < 9; ++k) EXPECT_EQ(at.rotation[k], expected.rotation[k]);
      for (int k = 0; k < 3; ++k) EXPECT_EQ(at.translation[k], expected.translation[k]);
      for (int k = 0; k < 9; ++k) EXPECT_EQ(rate_at.rotation[k], rate.rotation[k]);
    }
  }
}

TEST(FCL_TWIST_MOTION, refusesWhatIsNoTwist) {
  const double nan = std::nan("");
  const Tf here = Tf::Identity();
  const Vector zero = Vector::Zero(), bad(0, nan, 0);
  using Motion = TwistMotion<double>;
  expectRefused([&] { Motion(here, bad, zero); }, "the linear velocity");
  expectRefused([&] { Motion(here, zero, bad); }, "the angular velocity");
  expectRefused([&] { Motion(here, zero, Vector(2e6, 0, 0)); }, "2^20 radians");
  expectRefused([&] { Motion(here, zero, zero, ReferencePath::kScrew, bad); },
                "reference");
  expectRefused([&] { Motion(here, Vector(1e300, 0, 0), zero); }, "beyond 2^160");
  expectRefused([&] { Motion(here, zero, Vector(1e300, 0, 0)); }, "2^20 radians");
  Tf wide = here;
  wide.linear() *= 2;
  expectRefused([&] { Motion(wide, zero, zero); }, "the pose");
}

}  // namespace
}  // namespace test
}  // namespace fcl
