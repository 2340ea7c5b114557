// SPDX-License-Identifier: BSD-3-Clause
//
// Motions of the links of a chain of joints, against products of textbook rotations in
// Real. FCL_CCD_TEST_PATHS makes the series so many times as long:
//   FCL_CCD_TEST_PATHS=10 build/release/test/unit/test_fcl_joint_chain
#include "fcl/math/motion/joint_chain.h"

#include <gtest/gtest.h>

#include <cfenv>
#include <cmath>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "fcl/common/exception.h"
#include "fcl/geometry/shape/sphere.h"
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

Tf tfOf(const Matrix3<double>& rotation, const Vector& translation) {
  Tf tf = Tf::Identity();
  tf.linear() = rotation;
  tf.translation() = translation;
  return tf;
}

RealPose operator*(const RealPose& x, const RealPose& y) {
  return {x.rotation * y.rotation, x.rotation * y.translation + x.translation};
}

RealPose realPose(const Tf& tf) {
  return {tf.linear().cast<Real>(), tf.translation().cast<Real>()};
}

/// A robot with its motion, in the library's form and as numbers.
struct Robot {
  enum class Kind { kFixed, kRevolute, kPrismatic };
  struct Joint {
    Kind kind;
    Tf origin;
    Vector axis;
    int parent;
    std::size_t value;
  };
  std::vector<Joint> joints;
  std::vector<std::vector<double>> values;
  Tf base{Tf::Identity()};

  void add(Kind kind, const Tf& origin, const Vector& axis, int parent) {
    joints.push_back({kind, origin, axis, parent, values.size()});
    if (kind != Kind::kFixed) values.emplace_back();
  }

  JointChain chain() const {
    JointChain out;
    for (const Joint& j : joints) {
      if (j.kind == Kind::kRevolute) out.addRevolute(j.origin, j.axis, j.parent);
      if (j.kind == Kind::kPrismatic) out.addPrismatic(j.origin, j.axis, j.parent);
      if (j.kind == Kind::kFixed) out.addFixed(j.origin, j.parent);
    }
    return out;
  }
  ChainMotion motion() const { return ChainMotion::polynomial(chain(), values, base); }

  /// A pose and its derivative by t.
  struct State {
    RealPose pose, rate;
  };

  State own(const Joint& j, Real t) const {
    State out{{RealMatrix::Identity(), RealVector::Zero()},
              {RealMatrix::Zero(), RealVector::Zero()}};
    if (j.kind == Kind::kFixed) return out;
    Real q = 0, rate = 0;
    for (std::size_t k = values[j.value].size(); k-- > 0;) {
      rate = rate * t + q;
      q = q * t + values[j.value][k];
    }
    const RealVector axis = j.axis.cast<Real>().normalized();
    if (j.kind == Kind::kRevolute) {
      out.pose.rotation = rotationAbout(axis, q);
      for (int k = 0; k < 3; ++k)
        out.rate.rotation.col(k) = rate * axis.cross(out.pose.rotation.col(k));
    } else {
      out.pose.translation = q * axis;
      out.rate.translation = rate * axis;
    }
    return out;
  }

  State stateAt(int link, Real t) const {
    if (link < 0) return {realPose(base), {RealMatrix::Zero(), RealVector::Zero()}};
    const Joint& j = joints[static_cast<std::size_t>(link)];
    const State before = stateAt(j.parent, t), moves = own(j, t);
    const RealPose origin = realPose(j.origin), here = origin * moves.pose;
    const RealMatrix to_world = before.pose.rotation * origin.rotation;
    return {before.pose * here,
            {before.rate.rotation * here.rotation + to_world * moves.rate.rotation,
             before.rate.rotation * here.translation + to_world * moves.rate.translation +
                 before.rate.translation}};
  }

  RealPose at(int link, Real t) const { return stateAt(link, t).pose; }
  ExactPath path(int link) const {
    return [this, link](Real t) { return at(link, t); };
  }
};

enum class Values { kLinear, kPolynomial };

/// 1 to 8 joints of all kinds, some of which branch, with links of up to 0.5.
Robot randomRobot(Random& random, Values values, double most_turn) {
  Robot robot;
  if (random.index(2)) robot.base = tfOf(randomRotation(random), random.point(1));
  const int count = 1 + static_cast<int>(random.index(8));
  for (int i = 0; i < count; ++i) {
    const std::size_t which = random.index(8);
    const auto kind = which == 0   ? Robot::Kind::kFixed
                      : which == 1 ? Robot::Kind::kPrismatic
                                   : Robot::Kind::kRevolute;
    const int parent =
        random.index(4) ? i - 1 : static_cast<int>(random.index(std::size_t(i) + 1)) - 1;
    robot.add(kind,
              tfOf(random.index(3) ? randomRotation(random) : Matrix3<double>::Identity(),
                   random.point(.5)),
              randomDirection(random) * std::pow(10, random.uniform(-3, 3)), parent);
    if (kind == Robot::Kind::kFixed) continue;
    auto& q = robot.values.back();
    const double size = kind == Robot::Kind::kRevolute ? most_turn : .5;
    q = {random.uniform(-3, 3), random.uniform(-size, size)};
    if (values == Values::kPolynomial)
      for (std::size_t k = random.index(5); k > 0; --k)
        q.push_back(random.uniform(-size, size) / 4);
  }
  return robot;
}

int lastLink(const Robot& robot) { return static_cast<int>(robot.joints.size()) - 1; }

TEST(FCL_JOINT_CHAIN, followsTheExactChain) {
  Random random(1);
  RoundingParts worst{};
  for (int i = 0; i < rounds(4000); ++i) {
    const Robot robot = randomRobot(random, i % 2 ? Values::kLinear : Values::kPolynomial,
                                    i % 3 ? 3 : 20);
    const ChainMotion motion = robot.motion();
    for (int link = 0; link <= lastLink(robot); ++link) {
      const RoundingParts parts =
          roundingParts(*motion.link(link), robot.path(link), random.point(1),
                        i % 5 ? random.uniform(0, 1) : static_cast<double>(i % 2));
      worst.pose = std::max(worst.pose, parts.pose);
      worst.rate = std::max(worst.rate, parts.rate);
    }
  }
  EXPECT_LE(worst.pose, 1);
  EXPECT_LE(worst.rate, 1);
  // They are worst cases of sums of hundreds of roundings.
  EXPECT_GE(worst.pose, 0.02);
}

/// At both ends and at two other times.
RoundingParts ownRounding(const Robot& robot, int link, Random& random) {
  const auto motion = robot.motion().link(link);
  RoundingParts worst{};
  for (int i = 0; i < 4; ++i) {
    const double t = i < 2 ? i : random.uniform(0, 1);
    const Robot::State exact = robot.stateAt(link, t);
    worst = greatest(worst, ownRoundingParts(*motion, exact.pose, exact.rate,
                                             randomDirection(random), t));
  }
  return worst;
}

TEST(FCL_JOINT_CHAIN, saysItsRounding) {
  Random random(7);
  RoundingParts worst{};
  for (int i = 0; i < manyRounds(4000); ++i) {
    const Robot robot = randomRobot(random, i % 2 ? Values::kLinear : Values::kPolynomial,
                                    i % 3 ? 3 : 20);
    worst = greatest(worst, ownRounding(robot, lastLink(robot), random));
  }
  EXPECT_LE(worst.pose, 1);
  EXPECT_LE(worst.rate, 1);
  EXPECT_GE(worst.pose, .05);
  EXPECT_GE(worst.rate, .05);
}

/// Turned by 1000 radians and moved by 1e6 at the beginning.
TEST(FCL_JOINT_CHAIN, saysTheRoundingOfLargeValues) {
  Random random(8);
  RoundingParts worst{};
  for (int i = 0; i < rounds(1000); ++i) {
    Robot robot = randomRobot(random, Values::kLinear, 3);
    for (const Robot::Joint& j : robot.joints)
      if (j.kind != Robot::Kind::kFixed)
        robot.values[j.value][0] *= j.kind == Robot::Kind::kRevolute ? 300 : 3e5;
    worst = greatest(worst, ownRounding(robot, lastLink(robot), random));
  }
  EXPECT_LE(worst.pose, 1);
  EXPECT_LE(worst.rate, 1);
  EXPECT_GE(worst.pose, .05);
}

/// Coefficients of up to 1e8 that cancel at t = 1: the values there are rounding.
TEST(FCL_JOINT_CHAIN, saysTheRoundingOfValuesThatCancel) {
  Random random(9);
  RoundingParts worst{};
  for (int i = 0; i < rounds(1000); ++i) {
    Robot robot = randomRobot(random, Values::kLinear, 3);
    for (const Robot::Joint& j : robot.joints) {
      if (j.kind == Robot::Kind::kFixed) continue;
      const double size =
          std::pow(10, random.uniform(0, j.kind == Robot::Kind::kRevolute ? 2 : 8));
      std::vector<double> q{0};
      for (std::size_t k = 1 + random.index(14); k > 0; --k) {
        q.push_back(random.uniform(-size, size));
        q[0] -= q.back();
      }
      robot.values[j.value] = q;
    }
    worst = greatest(worst, ownRounding(robot, lastLink(robot), random));
  }
  EXPECT_LE(worst.pose, 1);
  EXPECT_LE(worst.rate, 1);
  EXPECT_GE(worst.pose, .01);
}

/// A joint that slides far, after so many fixed ones that their rounding is the largest.
/// They are alike, so that it adds up.
TEST(FCL_JOINT_CHAIN, saysTheRoundingOfManyFixedJoints) {
  Random random(10);
  RoundingParts worst{};
  for (int i = 0; i < 8; ++i) {
    Robot robot;
    if (i % 2) {
      robot.add(Robot::Kind::kRevolute, Tf::Identity(), randomDirection(random), -1);
      robot.values.back() = {0, 1};
    }
    const Matrix3<double> rotation = randomRotation(random);
    for (int k = 0; k < 1000; ++k)
      robot.add(Robot::Kind::kFixed, tfOf(rotation, random.point(1e-3)), Vector::UnitX(),
                lastLink(robot));
    robot.add(Robot::Kind::kPrismatic, Tf::Identity(), randomDirection(random),
              lastLink(robot));
    robot.values.back() = {1e6, 1};
    worst = greatest(worst, ownRounding(robot, lastLink(robot), random));
  }
  EXPECT_LE(worst.pose, 1);
  EXPECT_LE(worst.rate, 1);
}

/// A ball far out on the axis of its joint, which turns away from the axes of the world.
/// The acceleration of its center is only rounding, and the bound is one for it.
TEST(FCL_JOINT_CHAIN, boundsPointsFarOutOnTheAxis) {
  Random random(11);
  for (int i = 0; i < 200; ++i) {
    const Vector axis = randomDirection(random), origin(1, 2, 3);
    Robot robot;
    robot.add(Robot::Kind::kRevolute, tfOf(randomRotation(random), origin), axis, -1);
    robot.values.back() = {random.uniform(-3, 3), random.uniform(1, 3),
                           random.uniform(-3, 3)};
    const auto motion = robot.motion().link(0);
    const Vector x = 1e6 * axis.normalized();
    // Exactly, in the middle of the step: w' [a] x + w^2 [a]^2 x with the normalized
    // axis.
    const RealVector a = axis.cast<Real>().normalized(), y = a.cross(x.cast<Real>());
    const auto& q = robot.values.back();
    const Real w = Real{q[1]} + Real{q[2]}, rate = 2 * Real{q[2]};
    const Real exact = (rate * y + w * w * a.cross(y)).norm();
    const double t[2] = {.5, std::nextafter(.5, 1)};
    EXPECT_GE(motion->accelerationBound({x[0], x[1], x[2]}, 0, t[0], t[1]), exact);
  }
}

/// Bounds are never exceeded, and are near what is reached: nearer in short spans, and
/// for values that are linear.
TEST(FCL_JOINT_CHAIN, boundsAreReached) {
  Random random(2);
  const auto meanOf = [&random](Values values, double most_turn, int num_spans) {
    BoundParts worst{}, sum{};
    int count = 0;
    for (int i = 0; i < manyRounds(64); ++i) {
      const Robot robot = randomRobot(random, values, most_turn);
      const int link = lastLink(robot);
      const double t0 =
          static_cast<double>(random.index(static_cast<std::size_t>(num_spans))) /
          num_spans;
      const BoundParts of =
          boundParts(*robot.motion().link(link), robot.path(link), random.point(.5), .1,
                     t0, t0 + 1. / num_spans, random);
      worst = {std::max(worst.acceleration, of.acceleration),
               std::max(worst.turn, of.turn)};
      if (of.acceleration == 0) continue;
      sum = {sum.acceleration + of.acceleration, sum.turn + of.turn};
      ++count;
    }
    EXPECT_LE(worst.acceleration, 1);
    EXPECT_LE(worst.turn, 1);
    return BoundParts{sum.acceleration / count, sum.turn / count};
  };
  EXPECT_GE(meanOf(Values::kLinear, .5, 1).acceleration, .5);
  EXPECT_GE(meanOf(Values::kLinear, .5, 64).acceleration, .9);
  EXPECT_GE(meanOf(Values::kLinear, .5, 64).turn, .9);
  EXPECT_GE(meanOf(Values::kLinear, 20, 1).acceleration, .3);
  EXPECT_GE(meanOf(Values::kLinear, 20, 64).acceleration, .5);
  EXPECT_GE(meanOf(Values::kPolynomial, .5, 1).acceleration, .3);
  EXPECT_GE(meanOf(Values::kPolynomial, .5, 64).acceleration, .6);
}

/// The first link turns about a fixed axis: the bound is the acceleration itself.
TEST(FCL_JOINT_CHAIN, boundOfATurnIsExact) {
  JointChain chain;
  chain.addRevolute(tfOf(Matrix3<double>::Identity(), {1, 2, 3}), Vector(0, 0, 5));
  const auto motion = ChainMotion(chain, {1}, {4}).link(0);
  EXPECT_NEAR(motion->accelerationBound({3, 4, 7}, .5, 0, 1), 9 * 5.5, 1e-9);
  EXPECT_NEAR(motion->angularSpeedBound(0, 1), 3, 1e-11);
}

constexpr char kNothing[] = "";

/// Turns by more than 360 degrees, and grazes, are in these series.
TEST(FCL_JOINT_CHAIN, ballsMeetAtTheTimeOfSamples) {
  Random random(3);
  PathTally tally;
  for (int i = 0; i < pathCases(600); ++i) {
    const Robot robot = randomRobot(random, i % 2 ? Values::kLinear : Values::kPolynomial,
                                    i % 3 ? 2 : 20);
    const int link = lastLink(robot);
    ASSERT_EQ(
        ballDisagreement(*robot.motion().link(link), robot.path(link), random, tally),
        kNothing)
        << "case " << i;
  }
  EXPECT_GE(tally.contacts, rounds(100U));
  EXPECT_GE(tally.misses, rounds(100U));
  EXPECT_GE(tally.grazes, rounds(200U));
}

TEST(FCL_JOINT_CHAIN, trianglesMeetAtTheTimeOfSamples) {
  Random random(4);
  PathTally tally;
  for (int i = 0; i < pathCases(120); ++i) {
    const Robot robot = randomRobot(random, i % 2 ? Values::kLinear : Values::kPolynomial,
                                    i % 3 ? 2 : 20);
    const int link = lastLink(robot);
    ASSERT_EQ(
        triangleDisagreement(*robot.motion().link(link), robot.path(link), random, tally),
        kNothing)
        << "case " << i;
  }
  EXPECT_GE(tally.contacts, rounds(24U));
  EXPECT_GE(tally.misses, rounds(24U));
}

/// When two balls of the radius 0.25 meet, of which the second one rests.
template <typename S>
S meet(const MotionBase<S>& motion, const Vector3<S>& at) {
  const Sphere<S> ball(S(.25));
  const TranslationMotion<S> still(Matrix3<S>::Identity(), at, at);
  ContinuousCollisionRequest<S> request;
  request.toc_err = S(1e-9);
  ContinuousCollisionResult<S> result;
  return continuousCollide(&ball, &motion, &ball, &still, request, result);
}

/// The mode of the caller does not matter, also if its thread computes the poses of a
/// motion for the first time.
TEST(FCL_JOINT_CHAIN, isTheSameInAllRoundingModes) {
  Random random(12);
  std::size_t contacts = 0;
  for (int i = 0; i < 100; ++i) {
    const Robot robot = randomRobot(random, Values::kPolynomial, 2);
    const int link = lastLink(robot);
    const Vector at = (robot.at(link, random.uniform(0, 1)).translation.cast<double>()) +
                      random.point(.5);
    const double expected = meet<double>(*robot.motion().link(link), at);
    const auto placement = robot.motion().link(link)->placementAt(.3);
    contacts += expected < 1;
    for (const int mode : {FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO}) {
      // Of a motion of its own: nothing of it is kept.
      const auto motion = robot.motion().link(link), other = robot.motion().link(link);
      std::fesetround(mode);
      const double found = meet<double>(*motion, at);
      const auto placed = other->placementAt(.3);
      std::fesetround(FE_TONEAREST);
      EXPECT_EQ(found, expected);
      for (int k = 0; k < 9; ++k) EXPECT_EQ(placed.rotation[k], placement.rotation[k]);
      for (int k = 0; k < 3; ++k)
        EXPECT_EQ(placed.translation[k], placement.translation[k]);
    }
  }
  EXPECT_GE(contacts, 50U);
}

/// A ball on an arm of length 1 goes round 2.5 times while the arm rises by 5. It comes
/// within 0.5 of a ball that it passes in its second turn.
TEST(FCL_JOINT_CHAIN, turnsMoreThanOnce) {
  JointChain chain;
  chain.addPrismatic(Tf::Identity(), Vector(0, 0, 1));
  chain.addRevolute(Tf::Identity(), Vector(0, 0, 1));
  const int tool = chain.addFixed(tfOf(Matrix3<double>::Identity(), {1, 0, 0}));
  const ChainMotion motion(chain, {0, 0}, {5, 5 * M_PI});
  const auto distance = [](double t) {
    return std::hypot(std::cos(5 * M_PI * t) - 1, std::sin(5 * M_PI * t), 5 * t - 2);
  };
  double before = .3, after = .4;
  for (int i = 0; i < 60; ++i) {
    const double middle = (before + after) / 2;
    (distance(middle) > .5 ? before : after) = middle;
  }
  const double time = meet<double>(*motion.link(tool), {1, 0, 2});
  EXPECT_LE(time, after);
  EXPECT_NEAR(time, after, 2e-9);
  // In float the path is the same.
  EXPECT_NEAR(meet<float>(*motion.link<float>(tool), {1, 0, 2}), after, 1e-6);
}

TEST(FCL_JOINT_CHAIN, rests) {
  JointChain chain;
  chain.addRevolute(
      tfOf(AngleAxis<double>(.3, Vector::UnitX()).toRotationMatrix(), {.1, .2, .3}),
      Vector(1, 2, 3));
  const auto motion = ChainMotion(chain, {.7}, {.7}).link(0);
  EXPECT_EQ(motion->accelerationBound({1, 2, 3}, 1, 0, 1), 0);
  EXPECT_EQ(motion->angularSpeedBound(0, 1), 0);
  const auto begin = motion->placementAt(0), end = motion->placementAt(1);
  for (int i = 0; i < 9; ++i) EXPECT_EQ(begin.rotation[i], end.rotation[i]);
}

/// Frames of fixed joints, before, between and after the moving ones, are as moving
/// joints at the value 0.
TEST(FCL_JOINT_CHAIN, fixedJointsAreAsMovingOnesAtRest) {
  Random random(5);
  for (int i = 0; i < 200; ++i) {
    Robot with = randomRobot(random, Values::kLinear, 2);
    Robot without = with;
    without.values.clear();
    for (auto& j : without.joints) {
      const bool is_fixed = j.kind == Robot::Kind::kFixed;
      if (is_fixed) j.kind = Robot::Kind::kRevolute;
      without.values.push_back(is_fixed ? std::vector<double>{0, 0}
                                        : with.values[j.value]);
      j.value = without.values.size() - 1;
    }
    const int link = lastLink(with);
    const auto x = with.motion().link(link), y = without.motion().link(link);
    const auto at_x = x->placementAt(.3), at_y = y->placementAt(.3);
    for (int k = 0; k < 9; ++k) EXPECT_NEAR(at_x.rotation[k], at_y.rotation[k], 1e-14);
    for (int k = 0; k < 3; ++k)
      EXPECT_NEAR(at_x.translation[k], at_y.translation[k], 1e-14);
  }
}

TEST(FCL_JOINT_CHAIN, readsOriginsAsUrdf) {
  const Tf tf = urdfOrigin({1, 2, 3}, {.4, -.5, 2});
  const Matrix3<double> expected =
      (AngleAxis<double>(2, Vector::UnitZ()) * AngleAxis<double>(-.5, Vector::UnitY()) *
       AngleAxis<double>(.4, Vector::UnitX()))
          .toRotationMatrix();
  EXPECT_LE((tf.linear() - expected).norm(), 1e-15);
  EXPECT_EQ(tf.translation(), Vector(1, 2, 3));
  expectRefused([] { urdfOrigin({1, std::nan(""), 3}, {0, 0, 0}); }, "xyz");
  expectRefused([] { urdfOrigin({1, 2, 3}, {0, 0, 1e7}); }, "rpy");
}

/// Links branch; a chain that is changed later does not change a motion.
TEST(FCL_JOINT_CHAIN, branches) {
  const Tf along = tfOf(Matrix3<double>::Identity(), {1, 0, 0});
  JointChain chain;
  const int arm = chain.addRevolute(Tf::Identity(), Vector(0, 0, 1));
  const int left = chain.addPrismatic(along, Vector(0, 1, 0)),
            right = chain.addPrismatic(along, Vector(0, -1, 0), arm);
  const ChainMotion motion(chain, {0, 0, 0}, {M_PI / 2, .1, .2});
  chain.addFixed(along, JointChain::kBase);
  EXPECT_EQ(chain.numLinks(), 4);
  EXPECT_EQ(chain.numValues(), 3);
  const auto at = [&](int link) {
    const auto end = motion.link(link)->placementAt(1);
    return Vector(end.translation[0], end.translation[1], end.translation[2]);
  };
  EXPECT_LE((at(left) - Vector(-.1, 1, 0)).norm(), 1e-15);
  EXPECT_LE((at(right) - Vector(.2, 1, 0)).norm(), 1e-15);
  expectRefused([&] { motion.link(3); }, "no link 3");
}

TEST(FCL_JOINT_CHAIN, isEmptyAfterAMove) {
  JointChain chain;
  chain.addRevolute(Tf::Identity(), Vector(0, 0, 1));
  chain.addFixed(Tf::Identity());
  const JointChain moved = std::move(chain);
  EXPECT_EQ(moved.numLinks(), 2);
  EXPECT_EQ(moved.numValues(), 1);
  EXPECT_EQ(chain.numLinks(), 0);
  EXPECT_EQ(chain.numValues(), 0);
  EXPECT_EQ(chain.addPrismatic(Tf::Identity(), Vector(0, 0, 1)), 0);
  EXPECT_NO_THROW(ChainMotion(chain, {0}, {1}));
}

TEST(FCL_JOINT_CHAIN, refusesWhatIsNoChain) {
  const double nan = std::nan("");
  const Tf here = Tf::Identity();
  JointChain chain;
  expectRefused([&] { ChainMotion(chain, {}, {}); }, "no joints");
  chain.addRevolute(here, Vector(0, 0, 1));
  expectRefused([&] { chain.addRevolute(here, Vector::Zero()); },
                "link 1 of a JointChain: its axis is zero");
  expectRefused([&] { chain.addPrismatic(here, Vector(0, nan, 1)); }, "axis");
  expectRefused([&] { chain.addFixed(here, 1); }, "no link 1");
  expectRefused([&] { chain.addFixed(here, -3); }, "no link -3");
  expectRefused([&] { chain.addFixed(tfOf(here.linear(), {0, HUGE_VAL, 0})); }, "finite");
  expectRefused([&] { chain.addFixed(tfOf(1.1 * here.linear(), {0, 0, 0})); }, "scales");
  expectRefused([&] { chain.addFixed(tfOf(-here.linear(), {0, 0, 0})); }, "mirrors");
  EXPECT_EQ(chain.numLinks(), 1);
  expectRefused([&] { ChainMotion(chain, {1, 2}, {3}); }, "begin has 2 values");
  expectRefused([&] { ChainMotion(chain, {1}, {}); }, "end has 0 values");
  expectRefused([&] { ChainMotion(chain, {1}, {nan}); }, "value 0");
  expectRefused([&] { ChainMotion(chain, {0}, {2e6}); }, "2^20 radians");
  expectRefused([&] { ChainMotion(chain, {-2e6}, {0}); }, "2^20 radians");
  expectRefused(
      [&] {
        ChainMotion::polynomial(chain, {{1e6, -2e6, 1e6}});
      },
      "sizes of the coefficients");
  // The sum of the sizes of a linear one does not matter.
  EXPECT_NO_THROW(ChainMotion(chain, {1e6}, {-1e6}));
  expectRefused([&] { ChainMotion::polynomial(chain, {{}}); }, "0 coefficients");
  expectRefused([&] { ChainMotion::polynomial(chain, {std::vector<double>(17)}); },
                "17 coefficients");
  expectRefused(
      [&] {
        ChainMotion(chain, {1}, {2}, tfOf(2 * here.linear(), {0, 0, 0}));
      },
      "the base");
}

/// FCL's own functions: poses, and refusals in place of wrong bounds.
TEST(FCL_JOINT_CHAIN, givesPosesToFcl) {
  JointChain chain;
  chain.addRevolute(Tf::Identity(), Vector(0, 0, 1));
  const auto motion = ChainMotion(chain, {0}, {M_PI}).link(0);
  motion->integrate(.5);
  Tf tf;
  motion->getCurrentTransform(tf);
  EXPECT_LE((tf * Vector(1, 0, 0) - Vector(0, 1, 0)).norm(), 1e-15);
  TMatrix3<double> matrix;
  TVector3<double> vector;
  expectRefused([&] { motion->getTaylorModel(matrix, vector); }, "Taylor");
}

/// Links of one motion in several threads: the poses of other motions and times that a
/// thread keeps do not change an answer.
TEST(FCL_JOINT_CHAIN, isTheSameInAllThreads) {
  Random random(6);
  std::vector<ChainMotion> motions;
  for (int i = 0; i < 8; ++i)
    motions.push_back(randomRobot(random, Values::kLinear, 3).motion());
  const auto ask = [&motions](std::vector<double>& out) {
    for (int i = 0; i < 4000; ++i) {
      const double t = (i * 37 % 129) / 128.;
      out.push_back(motions[static_cast<std::size_t>(i % 8)]
                        .link(0)
                        ->placementAt(t)
                        .translation[0]);
    }
  };
  std::vector<double> answers[4];
  std::vector<std::thread> threads;
  for (auto& of : answers) threads.emplace_back(ask, std::ref(of));
  for (auto& thread : threads) thread.join();
  for (const auto& of : answers) EXPECT_EQ(of, answers[0]);
}

}  // namespace
}  // namespace test
}  // namespace fcl
