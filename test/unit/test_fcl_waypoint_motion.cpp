// SPDX-License-Identifier: BSD-3-Clause
//
// Motions that pass through poses, against the formulas of doc/curved_paths.md in long
// double. FCL_CCD_TEST_PATHS makes the series so many times as long:
//   FCL_CCD_TEST_PATHS=10 build/release/test/unit/test_fcl_waypoint_motion
#include "fcl/math/motion/waypoint_motion.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cfenv>
#include <cmath>
#include <vector>

#include "fcl/geometry/shape/sphere.h"
#include "fcl/math/motion/interp_motion.h"
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
using Poses = aligned_vector<Tf>;

/// The rotation vector of the shorter way.
RealVector logarithm(const RealMatrix& rotation) {
  const Eigen::AngleAxis<Real> turn{Eigen::Quaternion<Real>(rotation).normalized()};
  return turn.angle() * turn.axis();
}

RealMatrix exponential(const RealVector& w) {
  const Real angle = w.norm();
  return angle == 0 ? RealMatrix::Identity() : rotationAbout(w / angle, angle);
}

RealMatrix crossOf(const RealVector& w) {
  RealMatrix m;
  m << 0, -w[2], w[1], w[2], 0, -w[0], -w[1], w[0], 0;
  return m;
}

/// The velocities at the poses, from those of the pieces.
std::vector<RealVector> meanVelocities(const std::vector<RealVector>& of,
                                       const std::vector<Real>& h) {
  std::vector<RealVector> out{of.front()};
  for (std::size_t i = 1; i < of.size(); ++i) {
    RealVector mean = RealVector::Zero();
    const Real w0 = h[i - 1] + 2 * h[i], w1 = 2 * h[i - 1] + h[i];
    for (int k = 0; k < 3; ++k)
      if (of[i - 1][k] * of[i][k] > 0)
        mean[k] = (w0 + w1) / (w0 / of[i - 1][k] + w1 / of[i][k]);
    out.push_back(mean);
  }
  out.push_back(of.back());
  return out;
}

/// The exact path.
class Waypoints {
 public:
  Poses poses;
  std::vector<double> times;

  Waypoints() = default;
  Waypoints(const Poses& at_poses, const std::vector<double>& at_times)
      : poses(at_poses), times(at_times) {
    std::vector<RealVector> ways, turns;
    std::vector<Real> h;
    for (std::size_t i = 0; i < poses.size(); ++i) {
      rotations_.push_back(
          Eigen::Quaternion<Real>(RealMatrix(poses[i].linear().cast<Real>()))
              .normalized()
              .toRotationMatrix());
      positions_.push_back(poses[i].translation().cast<Real>());
      if (i == 0) continue;
      h.push_back(Real{times[i]} - Real{times[i - 1]});
      ways.push_back((positions_[i] - positions_[i - 1]) / h.back());
      turns.push_back(logarithm(rotations_[i - 1].transpose() * rotations_[i]) /
                      h.back());
    }
    velocities_ = meanVelocities(ways, h);
    angular_ = meanVelocities(turns, h);
  }

  WaypointMotion<double> motion() const { return WaypointMotion<double>(poses, times); }

  std::size_t pieceAt(Real t) const {
    std::size_t i = 0;
    while (i + 2 < times.size() && times[i + 1] <= t) ++i;
    return i;
  }

  RealPose at(Real t) const { return evaluated(t, false); }
  /// The derivative by t.
  RealPose rateAt(Real t) const { return evaluated(t, true); }
  ExactPath exact() const {
    return [this](Real t) { return at(t); };
  }

 private:
  RealPose evaluated(Real t, bool is_rate) const {
    const std::size_t i = pieceAt(t);
    const Real h = Real{times[i + 1]} - Real{times[i]}, s = (t - times[i]) / h, r = 1 - s;
    const RealVector w1 = h / 3 * angular_[i], w3 = h / 3 * angular_[i + 1],
                     w2 = logarithm(exponential(-w1) * rotations_[i].transpose() *
                                    rotations_[i + 1] * exponential(-w3));
    const RealMatrix e1 = exponential((1 - r * r * r) * w1),
                     e2 = exponential(s * s * (3 - 2 * s) * w2),
                     e3 = exponential(s * s * s * w3);
    const RealVector &x = positions_[i], &y = positions_[i + 1];
    if (!is_rate)
      return {rotations_[i] * e1 * e2 * e3,
              r * r * (1 + 2 * s) * x + s * s * (3 - 2 * s) * y +
                  h * r * s * (r * velocities_[i] - s * velocities_[i + 1])};
    const RealMatrix turning = e1 * crossOf(3 * r * r * w1) * e2 * e3 +
                               e1 * e2 * crossOf(6 * s * r * w2) * e3 +
                               e1 * e2 * e3 * crossOf(3 * s * s * w3);
    return {rotations_[i] * turning / h, 6 * s * r / h * (y - x) +
                                             r * (1 - 3 * s) * velocities_[i] +
                                             s * (1 - 3 * r) * velocities_[i + 1]};
  }

  std::vector<RealMatrix> rotations_;
  std::vector<RealVector> positions_, velocities_, angular_;
};

Tf turnedBy(const Tf& tf, const Vector& w) {
  Tf out = tf;
  if (w.norm() > 0)
    out.linear() =
        tf.linear() * AngleAxis<double>(w.norm(), w.normalized()).toRotationMatrix();
  return out;
}

/// 2 to 7 poses. Some are as the one before, in position, in rotation or in both.
Waypoints randomWaypoints(Random& random, double most_turn = 3) {
  const std::size_t count = 2 + random.index(6);
  std::vector<double> times{0};
  for (std::size_t i = 1; i < count; ++i)
    times.push_back(times.back() + random.uniform(.05, 1));
  const double end = times.back();
  for (double& t : times) t /= end;
  Tf pose = Tf::Identity();
  pose.linear() = randomRotation(random);
  pose.translation() = random.point(1);
  Poses poses;
  const Vector axis = randomDirection(random);
  for (std::size_t i = 0; i < count; ++i) {
    poses.push_back(pose);
    if (random.index(5))
      pose = turnedBy(pose, (random.index(3) ? randomDirection(random) : axis) *
                                random.uniform(0, most_turn));
    if (random.index(5)) pose.translation() += random.point(.8);
  }
  return {poses, times};
}

Vector translationOf(const BoundedMotion::Placement& at) {
  return Vector(at.translation[0], at.translation[1], at.translation[2]);
}

double deviation(const BoundedMotion::Placement& at, const Tf& pose) {
  double most = (translationOf(at) - pose.translation()).cwiseAbs().maxCoeff();
  for (int k = 0; k < 9; ++k)
    most = std::max(most, std::abs(at.rotation[k] - pose.linear()(k / 3, k % 3)));
  return most;
}

void expectEqual(const BoundedMotion::Placement& x, const BoundedMotion::Placement& y) {
  for (int k = 0; k < 9; ++k) EXPECT_EQ(x.rotation[k], y.rotation[k]);
  for (int k = 0; k < 3; ++k) EXPECT_EQ(x.translation[k], y.translation[k]);
}

TEST(FCL_WAYPOINT_MOTION, passesThroughItsPoses) {
  Random random(1);
  for (int i = 0; i < rounds(1000); ++i) {
    const Waypoints waypoints = randomWaypoints(random);
    const auto motion = waypoints.motion();
    for (std::size_t k = 0; k < waypoints.times.size(); ++k) {
      const double t = waypoints.times[k];
      ASSERT_LE(deviation(motion.placementAt(t), waypoints.poses[k]), 4e-15);
      if (k == 0) continue;
      const double before = std::nextafter(t, 0);
      ASSERT_LE(deviation(motion.placementAt(before), waypoints.poses[k]), 2e-13);
    }
  }
}

/// The velocities before and after a pose are equal.
TEST(FCL_WAYPOINT_MOTION, hasContinuousVelocities) {
  Random random(2);
  for (int i = 0; i < rounds(1000); ++i) {
    const Waypoints waypoints = randomWaypoints(random);
    const auto motion = waypoints.motion();
    for (std::size_t k = 1; k + 1 < waypoints.times.size(); ++k) {
      const double t = waypoints.times[k];
      const auto before = motion.rateAt(std::nextafter(t, 0)), after = motion.rateAt(t);
      const double tolerance =
          1e-15 * motion.accelerationBound({0, 0, 0}, 1, 0, 1) + 1e-11;
      for (int j = 0; j < 9; ++j)
        ASSERT_NEAR(before.rotation[j], after.rotation[j], tolerance);
      for (int j = 0; j < 3; ++j)
        ASSERT_NEAR(before.translation[j], after.translation[j], tolerance);
    }
  }
}

TEST(FCL_WAYPOINT_MOTION, staysBetweenCoordinates) {
  Random random(3);
  for (int i = 0; i < rounds(400); ++i) {
    const Waypoints waypoints = randomWaypoints(random);
    const auto motion = waypoints.motion();
    for (int k = 0; k <= 100; ++k) {
      const double t = k / 100.;
      const std::size_t piece = waypoints.pieceAt(t);
      const Vector at = translationOf(motion.placementAt(t)),
                   x = waypoints.poses[piece].translation(),
                   y = waypoints.poses[piece + 1].translation();
      for (int j = 0; j < 3; ++j) {
        ASSERT_GE(at[j], std::min(x[j], y[j]) - 1e-15);
        ASSERT_LE(at[j], std::max(x[j], y[j]) + 1e-15);
      }
    }
  }
}

TEST(FCL_WAYPOINT_MOTION, restsBetweenEqualPoses) {
  Random random(4);
  for (int i = 0; i < rounds(200); ++i) {
    const Waypoints other = randomWaypoints(random);
    const Tf first = other.poses[0];
    Tf middle = other.poses[1];
    middle.translation().x() += 2;
    const Waypoints waypoints({first, middle, middle, first}, {0, .3, .6, 1});
    const auto motion = waypoints.motion();
    const auto parked = motion.placementAt(.3);
    for (const double t : {.31, .5, .59, .6}) expectEqual(motion.placementAt(t), parked);
    EXPECT_EQ(motion.accelerationBound({1, 2, 3}, 1, .3, .6), 0);
    EXPECT_EQ(motion.angularSpeedBound(.3, .6), 0);
    EXPECT_GT(motion.accelerationBound({1, 2, 3}, 1, .3, .7), 0);
  }
}

/// Turns about one axis by angles that ascend: the angle does too.
TEST(FCL_WAYPOINT_MOTION, turnsAboutACommonAxis) {
  Random random(5);
  for (int i = 0; i < rounds(100); ++i) {
    const Vector axis = randomDirection(random);
    Tf begin = Tf::Identity();
    begin.linear() = randomRotation(random);
    const std::vector<double> angles{0, .2, 2.9, 3, 3, 5.5};
    Poses poses;
    for (const double angle : angles) poses.push_back(turnedBy(begin, angle * axis));
    const WaypointMotion<double> motion(poses, {0, .1, .5, .6, .8, 1});
    double last = 0;
    for (int k = 1; k <= 200; ++k) {
      const auto at = motion.placementAt(k / 200.);
      RealMatrix rotation;
      for (int j = 0; j < 9; ++j) rotation(j / 3, j % 3) = at.rotation[j];
      const RealVector w = logarithm(begin.linear().cast<Real>().transpose() * rotation);
      ASSERT_LE(w.cross(axis.cast<Real>()).norm(), 1e-13);
      double angle = static_cast<double>(w.dot(axis.cast<Real>()));
      while (angle < last - 1) angle += 2 * M_PI;
      ASSERT_GE(angle, last - 1e-14);
      last = angle;
    }
    EXPECT_NEAR(last, 5.5, 1e-14);
  }
}

TEST(FCL_WAYPOINT_MOTION, joinsTwoPosesAsAnInterpMotion) {
  Random random(6);
  for (int i = 0; i < 100; ++i) {
    Tf begin = Tf::Identity();
    begin.linear() = randomRotation(random);
    begin.translation() = random.point(1);
    Tf end = turnedBy(begin, randomDirection(random) * random.uniform(.1, 3));
    end.translation() += random.point(1);
    const WaypointMotion<double> motion(Poses{begin, end}, {0, 1});
    const InterpMotion<double> expected(begin.linear(), begin.translation(), end.linear(),
                                        end.translation(), Vector::Zero());
    for (const double t : {.1, .5, .9}) {
      Tf tf;
      expected.integrate(t);
      expected.getCurrentTransform(tf);
      EXPECT_LE(deviation(motion.placementAt(t), tf), 1e-7);
    }
  }
}

/// All of the rounding is in moreRounding(), far from the origin and for small and short
/// pieces too.
TEST(FCL_WAYPOINT_MOTION, saysItsRounding) {
  Random random(7);
  for (const double most_turn : {1e-9, 1e-3, 1., 3.}) {
    RoundingParts worst{};
    for (int i = 0; i < manyRounds(2000); ++i) {
      Waypoints waypoints = randomWaypoints(random, most_turn);
      Poses poses = waypoints.poses;
      std::vector<double> times = waypoints.times;
      const double size = std::pow(10, 6 * random.uniform(-1, 1));
      for (Tf& pose : poses) pose.translation() *= size;
      if (i % 2 && times.size() > 2) times[1] = i % 4 == 1 ? 2e-5 : times[2] - 2e-5;
      waypoints = Waypoints(poses, times);
      const double t = i % 3 ? random.uniform(0, 1) : times[random.index(times.size())];
      worst = greatest(worst,
                       ownRoundingParts(waypoints.motion(), waypoints.at(t),
                                        waypoints.rateAt(t), randomDirection(random), t));
    }
    EXPECT_LE(worst.pose, 1) << most_turn;
    EXPECT_LE(worst.rate, 1) << most_turn;
    EXPECT_GE(worst.pose, .005) << most_turn;
  }
}

/// Bounds are never exceeded, and near what is reached in short spans.
TEST(FCL_WAYPOINT_MOTION, boundsAreReached) {
  Random random(8);
  const auto meanOf = [&random](int num_spans) {
    BoundParts sum{};
    int count = 0;
    for (int i = 0; i < rounds(64); ++i) {
      const Waypoints waypoints = randomWaypoints(random, 1);
      const auto motion = waypoints.motion();
      const std::size_t piece = random.index(waypoints.times.size() - 1);
      const double begin = waypoints.times[piece], h = waypoints.times[piece + 1] - begin,
                   part = static_cast<double>(
                       random.index(static_cast<std::size_t>(num_spans))),
                   t0 = begin + h * part / num_spans, t1 = t0 + h / num_spans;
      const Vector center = random.point(.5);
      const BoundParts of =
          boundParts(motion, waypoints.exact(), center, .1, t0, t1, random);
      EXPECT_LE(of.acceleration, 1);
      EXPECT_LE(of.turn, 1);
      if (of.acceleration == 0) continue;
      const double c[3] = {center[0], center[1], center[2]};
      const double reached = of.acceleration * motion.accelerationBound(c, .1, t0, t1);
      EXPECT_LE(reached, motion.accelerationBound(c, .1, t0 / 2, (1 + t1) / 2));
      EXPECT_LE(reached, motion.accelerationBound(c, .1, 0, 1));
      sum = {sum.acceleration + of.acceleration, sum.turn + of.turn};
      ++count;
    }
    return BoundParts{sum.acceleration / count, sum.turn / count};
  };
  EXPECT_GE(meanOf(1).acceleration, .2);
  EXPECT_GE(meanOf(64).acceleration, .6);
  EXPECT_GE(meanOf(64).turn, .6);
}

constexpr char kNothing[] = "";

TEST(FCL_WAYPOINT_MOTION, ballsMeetAtTheTimeOfSamples) {
  Random random(9);
  PathTally tally;
  for (int i = 0; i < pathCases(400); ++i) {
    const Waypoints waypoints = randomWaypoints(random);
    ASSERT_EQ(ballDisagreement(waypoints.motion(), waypoints.exact(), random, tally),
              kNothing)
        << "case " << i;
  }
  EXPECT_GE(tally.contacts, rounds(60U));
  EXPECT_GE(tally.misses, rounds(60U));
  EXPECT_GE(tally.grazes, rounds(100U));
}

TEST(FCL_WAYPOINT_MOTION, trianglesMeetAtTheTimeOfSamples) {
  Random random(10);
  PathTally tally;
  for (int i = 0; i < pathCases(80); ++i) {
    const Waypoints waypoints = randomWaypoints(random);
    ASSERT_EQ(triangleDisagreement(waypoints.motion(), waypoints.exact(), random, tally),
              kNothing)
        << "case " << i;
  }
  EXPECT_GE(tally.contacts, rounds(10U));
  EXPECT_GE(tally.misses, rounds(10U));
}

/// A ball goes round the corner of a square, at 1 per quarter of the step, and meets one
/// that rests on the second side. In float too.
template <typename S>
S meet() {
  std::vector<Transform3<S>, Eigen::aligned_allocator<Transform3<S>>> poses;
  for (const auto& at : {Vector3<S>(0, 0, 0), Vector3<S>(1, 0, 0), Vector3<S>(1, 1, 0)}) {
    poses.push_back(Transform3<S>::Identity());
    poses.back().translation() = at;
  }
  const WaypointMotion<S> motion(poses, {0, .5, 1});
  const Sphere<S> ball(S(.125));
  const Vector3<S> at(1, S(.75), 0);
  const TranslationMotion<S> still(Matrix3<S>::Identity(), at, at);
  ContinuousCollisionRequest<S> request;
  request.toc_err = S(1e-9);
  ContinuousCollisionResult<S> result;
  return continuousCollide(&ball, &motion, &ball, &still, request, result);
}

/// On the second side y = 2 s^2 - s^3, since it begins at rest in y.
TEST(FCL_WAYPOINT_MOTION, turnsIntoASide) {
  double before = 0, after = 1;
  for (int i = 0; i < 60; ++i) {
    const double s = (before + after) / 2;
    (s * s * (2 - s) < .5 ? before : after) = s;
  }
  const double time = .5 + after / 2;
  EXPECT_LE(meet<double>(), time);
  EXPECT_NEAR(meet<double>(), time, 2e-9);
  EXPECT_NEAR(meet<float>(), time, 1e-6);
}

TEST(FCL_WAYPOINT_MOTION, isTheSameInAllRoundingModes) {
  Random random(11);
  for (int i = 0; i < 100; ++i) {
    const Waypoints waypoints = randomWaypoints(random);
    const auto expected = waypoints.motion().placementAt(.3);
    for (const int mode : {FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO}) {
      std::fesetround(mode);
      const auto at = waypoints.motion().placementAt(.3);
      std::fesetround(FE_TONEAREST);
      expectEqual(at, expected);
    }
  }
}

TEST(FCL_WAYPOINT_MOTION, refusesWhatAreNoWaypoints) {
  const double nan = std::nan("");
  const Tf here = Tf::Identity();
  Tf there = here, wide = here, nowhere = here;
  there.translation() = Vector(1, 0, 0);
  wide.linear() *= 2;
  nowhere.translation() = Vector(0, nan, 0);
  using Motion = WaypointMotion<double>;
  expectRefused([&] { Motion(Poses{}, {}); }, "it has 0 poses");
  expectRefused([&] { Motion(Poses{here}, {0}); }, "it has 1 pose.");
  expectRefused([&] { Motion(Poses{here, there}, {0, .5, 1}); }, "3 times");
  expectRefused([&] { Motion(Poses{here, there, here}, {0, .5, .5}); }, "ascend");
  expectRefused([&] { Motion(Poses{here, there, here}, {0, .5, .4}); }, "ascend");
  expectRefused([&] { Motion(Poses{here, there, here}, {0, 1 - 0x1p-17, 1}); }, "2^-16");
  expectRefused([&] { Motion(Poses{here, there}, {0, nan}); }, "not finite");
  expectRefused([&] { Motion(Poses{here, there}, {.1, 1}); }, "from 0 to 1");
  expectRefused([&] { Motion(Poses{here, there}, {0, 2}); }, "from 0 to 2");
  expectRefused([&] { Motion(Poses{here, wide}, {0, 1}); }, "pose 1 scales");
  expectRefused([&] { Motion(Poses{nowhere, here}, {0, 1}); }, "pose 0");
}

}  // namespace
}  // namespace test
}  // namespace fcl
