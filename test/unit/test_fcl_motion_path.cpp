// SPDX-License-Identifier: BSD-3-Clause
//
// Paths of motions against their formulas, and the bounds on which queries rely.
#include "paths/motion_path.h"

#include <gtest/gtest.h>

#include <cmath>

#include "curved/chord_pairs.h"
#include "fcl/common/exception.h"
#include "paths/sine.h"
#include "reference_motion.h"
#include "sanitizer.h"

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
    const Real s = sin(Real{x}), c = cos(Real{x});
    worst = std::max({worst, abs(at.sine - s), abs(at.cosine - c)});
    if (std::abs(x) < 0.785)
      worst_relative = std::max(worst_relative, abs((at.sine - s) / s));
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
  for (int i = 0; i < rounds(20000); ++i) {
    const ReferenceMotion motion = randomMotion(random, 1);
    const MotionPath path = motion.path();
    const Vector3<double> x = random.point(1);
    const double t = random.uniform(0, 1);
    const RealVector expected = motion.at(t) * x;
    const double error =
        static_cast<double>((applied(path.pose(t), x).cast<Real>() - expected).norm());
    worst = std::max(worst, error / path.positionError(x.norm()));
    // In Real a difference quotient of third order has an error of 1e-9.
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

// Points that move straight in the frame of a turn, whose end need not be a rotation.
// Second differences along the axis, and along other directions, against their bounds.
TEST(FCL_MOTION_PATH, isCalmAlongItsAxis) {
  Random random(4);
  double worst_along = 0, worst_across = 0;
  int num_turns = 0;
  for (int i = 0; i < 20000; ++i) {
    ReferenceMotion motion = randomMotion(random, 1);
    if (i % 2) motion.end.linear() *= random.uniform(0.9, 1.1);
    const MotionPath path = motion.path();
    if (!path.axis()) continue;
    ++num_turns;
    const Vector3<double> axis(path.axis()->x, path.axis()->y, path.axis()->z),
        x0 = random.point(1), x1 = i % 3 ? x0 : random.point(1),
        n = randomDirection(random);
    const double t0 = random.uniform(0, 0.5), half = random.uniform(0.05, 0.25);
    const auto at = [&](double t) {
      return applied(path.pose(t), (1 - t) * x0 + t * x1);
    };
    const Vector3<double> bend = at(t0) - 2 * at(t0 + half) + at(t0 + 2 * half);
    const AccelerationBound bound = path.acceleration(t0, t0 + 2 * half);
    const auto vec = [](const Vector3<double>& v) { return Vec{v[0], v[1], v[2]}; };
    const double displacement = (x1 - x0).norm(), square = half * half,
                 along = square * path.axisAcceleration(displacement),
                 whole = square * (bound.between(vec(x0), vec(x1), 0) +
                                   bound.per_displacement * displacement),
                 across = n.cross(axis).norm() * whole;
    EXPECT_LE(std::abs(bend.dot(axis)), along + 1e-13);
    EXPECT_LE(std::abs(bend.dot(n)), across + along + 1e-13);
    if (along > 1e-6)
      worst_along = std::max(worst_along, std::abs(bend.dot(axis)) / along);
    worst_across = std::max(worst_across, std::abs(bend.dot(n)) / (across + along));
  }
  EXPECT_GT(num_turns, 5000);
  // The bounds are nearly reached.
  EXPECT_GE(worst_along, 0.4);
  EXPECT_GE(worst_across, 0.9);
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

/// Points of turns stay within the error of their bent chords, and nearly reach it.
TEST(FCL_MOTION_PATH, bentChords) {
  Random random(14);
  double worst = 0;
  for (int i = 0; i < rounds(4000); ++i) {
    const ReferenceMotion motion = randomMotion(random, 1);
    const MotionPath path = motion.path();
    if (!path.axis()) continue;
    const double dt = std::ldexp(1., -static_cast<int>(random.index(7))),
                 t0 = dt * static_cast<double>(random.index(std::size_t(1 / dt))),
                 t1 = t0 + dt, radius = std::pow(10, random.uniform(-3, 1));
    const double most = 0.125 * dt * dt * path.acceleration(t0, t1).of({0, 0, 0}, radius);
    const ChordBend found = bendOf(path, radius, t0, t1, most);
    const Eigen::Map<const Matrix3<double>> matrix(found.bend.matrix);
    const Eigen::Map<const Vector3<double>> offset(found.bend.offset);
    for (int k = 0; k < 20; ++k) {
      const Vector3<double> x = radius * random.point(1).normalized();
      const RealVector from = motion.at(t0) * x, to = motion.at(t1) * x;
      const RealVector bend = matrix.cast<Real>() * (from + to) / 2 + offset.cast<Real>();
      const Real s = k % 2 ? Real{0.5} : Real{random.uniform(0, 1)};
      const RealVector chord = (1 - s) * from + s * to + 4 * s * (1 - s) * bend,
                       at = motion.at(t0 + static_cast<double>(s) * dt) * x;
      const auto error = static_cast<double>((at - chord).norm());
      ASSERT_LE(error, found.error + 3 * path.positionError(radius))
          << t0 << " to " << t1 << " at " << static_cast<double>(s);
      if (found.error > 1e-9) worst = std::max(worst, error / found.error);
    }
  }
  EXPECT_GT(worst, 0.1);
}

}  // namespace
}  // namespace test
}  // namespace fcl
