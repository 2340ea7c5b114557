// SPDX-License-Identifier: BSD-3-Clause
//
// Edges of a planner, against FCL's discrete queries of many states on the way, and
// against all pairs of bodies. FCL_CCD_TEST_EDGES sets the number of edges:
//   FCL_CCD_TEST_EDGES=10000 build/release/test/unit/test_fcl_collision_robot
#include "fcl/broadphase/collision_robot.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>
#include <thread>
#include <tuple>
#include <utility>
#include <vector>

#include "arm_scenes.h"
#include "fcl/common/exception.h"
#include "fcl/geometry/shape/box.h"
#include "fcl/geometry/shape/plane.h"
#include "fcl/geometry/shape/sphere.h"
#include "fcl/math/bv/OBBRSS.h"
#include "fcl/math/motion/translation_motion.h"
#include "test_models.h"

namespace fcl {
namespace test {
namespace {

using Vector = Vector3<double>;
using Tf = Transform3<double>;
using Robot = CollisionRobot<double>;
using Manager = ContinuousCollisionManager<double>;
using Object = ContinuousCollisionObject<double>;
using Request = ContinuousContactRequest<double>;
using Result = RobotEdgeResult<double>;

Tf at(double x, double y, double z) { return Tf(Translation3<double>(x, y, z)); }

Request requestOf(ContinuousQuery query) {
  Request request;
  request.query = query;
  return request;
}

int numEdges(int usual) {
  const char* wanted = std::getenv("FCL_CCD_TEST_EDGES");
  return wanted ? std::atoi(wanted) : usual;
}

/// Calls visit(scene, from, to) for edges of random arms, four for each arm. As planners
/// do, most begin where nothing touches.
template <typename Visit>
void visitEdges(std::uint64_t seed, int count, Visit&& visit) {
  Random random(seed);
  for (int i = 0; i < count; i += 4) {
    ArmScene scene;
    makeRandomArm(random, scene);
    for (int k = 0; k < 4; ++k) {
      JointValues from = randomValues(random, scene.numJoints());
      for (int tries = 0; tries < 20 && k > 0 && scene.touching(from).exist(); ++tries)
        from = randomValues(random, scene.numJoints());
      const double most[] = {.1, .3, 1, 2};
      visit(scene, from, nearValues(random, from, most[random.index(4)]));
      if (testing::Test::HasFatalFailure()) return;
    }
  }
}

/// The bodies of a pair that is in contact.
ArmBodies bodiesOf(const ArmScene& scene, const RobotPairResult<double>& pair) {
  if (!pair.object) return {pair.part1, pair.part2, -1};
  return {pair.part1, -1, scene.numberOf(pair.object)};
}

TEST(CollisionRobot, NoStateOnAFreeEdgeTouches) {
  constexpr double kStep = .001;
  int num_free = 0, num_hit = 0, num_between = 0;
  visitEdges(1, numEdges(200),
             [&](const ArmScene& scene, const JointValues& from, const JointValues& to) {
               const Robot robot = scene.robot();
               Result any, first;
               const bool is_free = robot.checkEdge(
                   from, to, &scene.manager(), requestOf(ContinuousQuery::kAny), any);
               robot.checkEdge(from, to, &scene.manager(),
                               requestOf(ContinuousQuery::kFirst), first);
               ASSERT_EQ(first.is_free, is_free);
               const SampledContact sampled = sampledContact(scene, from, to, kStep);
               if (is_free) {
                 ++num_free;
                 ASSERT_FALSE(sampled.bodies.exist()) << "missed at t = " << sampled.t;
                 ASSERT_EQ(first.time_of_contact, 1);
                 ASSERT_TRUE(first.pairs.empty() && any.pairs.empty());
                 return;
               }
               ++num_hit;
               if (sampled.bodies.exist()) {
                 ASSERT_LE(first.time_of_contact, sampled.t);
               } else {
                 ++num_between;
               }
               // It is a contact: within toc_err of the step bodies come no nearer than
               // this.
               ASSERT_LE(scene.distance(bodiesOf(scene, first.pairs.at(0)),
                                        valuesBetween(from, to, first.time_of_contact)),
                         1e-2);
               ASSERT_LE(scene.distance(bodiesOf(scene, any.pairs.at(0)),
                                        valuesBetween(from, to, any.time_of_contact)),
                         1e-2);
               // Each is early by up to toc_err.
               ASSERT_LE(first.time_of_contact, any.time_of_contact + Request().toc_err);
             });
  EXPECT_GT(num_free, 0);
  EXPECT_GT(num_hit, num_between);
}

/// What continuousCollide() says of all pairs, without any culling.
struct AllPairs {
  /// part 1, part 2, obstacle, time
  std::vector<std::tuple<int, int, int, double>> in_contact;
  std::size_t count{0};
  double first{1};
};

AllPairs allPairs(const ArmScene& scene, const JointValues& from, const JointValues& to,
                  const Request& request) {
  JointChain chain = scene.chain();
  std::vector<int> frames;
  for (const ArmScene::Part& part : scene.parts())
    frames.push_back(chain.addFixed(part.origin, part.link));
  const ChainMotion motion(chain, from, to);
  AllPairs all;
  const auto add = [&](const ArmBodies& bodies, const CollisionGeometry<double>& o2,
                       const MotionBase<double>& motion2) {
    const std::size_t i = std::size_t(bodies.part1);
    ContinuousContactResult<double> result;
    continuousCollide(scene.parts()[i].geometry.get(), motion.link(frames[i]).get(), &o2,
                      &motion2, request, result);
    ++all.count;
    if (!result.is_collide) return;
    all.in_contact.emplace_back(bodies.part1, bodies.part2, bodies.obstacle,
                                result.time_of_contact);
    all.first = std::min(all.first, result.time_of_contact);
  };
  for (std::size_t i = 0; i < scene.numParts(); ++i) {
    for (std::size_t k = 0; k < scene.numObstacles(); ++k)
      add({int(i), -1, int(k)}, *scene.obstacle(k)->collisionGeometry(),
          *scene.obstacle(k)->getMotion());
    for (std::size_t k = i + 1; k < scene.numParts(); ++k)
      if (scene.areTested(i, k))
        add({int(i), int(k), -1}, *scene.parts()[k].geometry, *motion.link(frames[k]));
  }
  std::sort(all.in_contact.begin(), all.in_contact.end());
  return all;
}

TEST(CollisionRobot, CullingChangesNoAnswer) {
  std::size_t num_pairs = 0, num_box_pairs = 0, num_tested_any = 0, num_tested_first = 0,
              num_tested_all = 0;
  Random random(3);
  visitEdges(2, numEdges(200),
             [&](const ArmScene& scene, const JointValues& from, const JointValues& to) {
               const Robot robot = scene.robot();
               Request request = requestOf(ContinuousQuery::kAll);
               request.t_max = random.index(3) == 0 ? random.uniform(0, 1) : 1;
               request.min_distance = random.index(3) == 0 ? random.uniform(0, .05) : 0;
               const AllPairs expected = allPairs(scene, from, to, request);
               Result all, first, any;
               robot.checkEdge(from, to, &scene.manager(), request, all);
               std::vector<std::tuple<int, int, int, double>> in_contact;
               for (const auto& pair : all.pairs) {
                 const ArmBodies bodies = bodiesOf(scene, pair);
                 in_contact.emplace_back(bodies.part1, bodies.part2, bodies.obstacle,
                                         pair.result.time_of_contact);
               }
               std::sort(in_contact.begin(), in_contact.end());
               ASSERT_EQ(in_contact, expected.in_contact);
               ASSERT_EQ(all.time_of_contact, expected.first);
               request.query = ContinuousQuery::kAny;
               robot.checkEdge(from, to, &scene.manager(), request, any);
               ASSERT_EQ(any.is_free, expected.in_contact.empty());
               request.query = ContinuousQuery::kFirst;
               robot.checkEdge(from, to, &scene.manager(), request, first);
               ASSERT_EQ(first.is_free, expected.in_contact.empty());
               ASSERT_NEAR(first.time_of_contact, expected.first, request.toc_err);
               ASSERT_EQ(all.num_tested, all.num_box_pairs);
               num_pairs += expected.count;
               num_box_pairs += all.num_box_pairs;
               num_tested_all += all.num_tested;
               num_tested_first += first.num_tested;
               num_tested_any += any.num_tested;
             });
  // Each stage has left something out.
  EXPECT_LT(num_box_pairs, num_pairs);
  EXPECT_LT(num_tested_first, num_tested_all);
  EXPECT_LT(num_tested_any, num_tested_first);
}

/// Two links of the length 1 that turn about z: 0 from the origin, 1 from its end. A ball
/// of the radius .1 is in the end of each.
struct TwoLinks {
  JointChain chain;
  std::shared_ptr<Sphere<double>> ball{std::make_shared<Sphere<double>>(.1)};
  TwoLinks() {
    chain.addRevolute(Tf::Identity(), Vector::UnitZ());
    chain.addRevolute(at(1, 0, 0), Vector::UnitZ());
  }
};

/// An obstacle at rest in a manager.
struct AtRest {
  Object object;
  Manager manager;
  AtRest(const std::shared_ptr<CollisionGeometry<double>>& geometry, const Tf& pose)
      : object(geometry, std::make_shared<TranslationMotion<double>>(pose, pose)) {
    manager.registerObject(&object);
  }
};

TEST(CollisionRobot, NamesTheBodiesTheTimeAndTheState) {
  const TwoLinks links;
  Robot robot(links.chain, {"upper arm", "lower arm"});
  robot.attach(0, links.ball, at(.9, 0, 0));
  robot.attach(1, links.ball, at(.5, 0, 0));
  const int tip = robot.attach(1, links.ball, at(1, 0, 0));
  // The tip is at (1, 0) + (cos q, sin q), and reaches x = 1.1 + .1 + .1 with sin q = 1.
  const AtRest wall(std::make_shared<Box<double>>(2, .2, 1), at(1, 1.15, 0));
  Result result;
  EXPECT_FALSE(robot.checkEdge({0, 0}, {0, 2}, &wall.manager,
                               requestOf(ContinuousQuery::kFirst), result));
  EXPECT_FALSE(result.is_free);
  const double angle = std::asin(.95);
  EXPECT_NEAR(result.time_of_contact, angle / 2, 1e-4);
  EXPECT_LE(result.time_of_contact, angle / 2);
  ASSERT_EQ(result.joint_values.size(), 2u);
  EXPECT_EQ(result.joint_values[0], 0);
  EXPECT_NEAR(result.joint_values[1], angle, 2e-4);
  ASSERT_EQ(result.pairs.size(), 1u);
  const auto& pair = result.pairs[0];
  EXPECT_EQ(pair.part1, tip);
  EXPECT_EQ(pair.link1, 1);
  EXPECT_EQ(robot.nameOf(pair.link1), "link 1 (lower arm)");
  EXPECT_EQ(pair.object, &wall.object);
  EXPECT_EQ(pair.part2, -1);
  ASSERT_EQ(pair.result.contacts.size(), 1u);
  EXPECT_NEAR(pair.result.contacts[0].pos.y(), 1.05, 1e-3);
  EXPECT_GT(pair.result.contacts[0].normal.y(), .99);
  // Up to the contact it is free, and the state is that of the end.
  Request early = requestOf(ContinuousQuery::kAny);
  early.t_max = .6;
  EXPECT_TRUE(robot.checkEdge({0, 0}, {0, 2}, &wall.manager, early, result));
  EXPECT_EQ(result.joint_values, JointValues({0, 2}));
}

TEST(CollisionRobot, FindsContactsWithItself) {
  JointChain chain;
  for (int i = 0; i < 3; ++i) chain.addRevolute(at(i > 0, 0, 0), Vector::UnitZ());
  const auto ball = std::make_shared<Sphere<double>>(.1);
  Robot robot(chain);
  const int first = robot.attach(0, ball), last = robot.attach(2, ball, at(1, 0, 0));
  // An equilateral triangle is closed at 2 pi / 3; the balls meet before.
  const double close = 2 * std::acos(-1.) / 3;
  Result result;
  const Request request = requestOf(ContinuousQuery::kFirst);
  EXPECT_FALSE(robot.checkEdge({0, 0, 0}, {0, close, close}, nullptr, request, result));
  ASSERT_EQ(result.pairs.size(), 1u);
  EXPECT_EQ(result.pairs[0].part1, first);
  EXPECT_EQ(result.pairs[0].part2, last);
  EXPECT_EQ(result.pairs[0].link1, 0);
  EXPECT_EQ(result.pairs[0].link2, 2);
  EXPECT_EQ(result.pairs[0].object, nullptr);
  const double q = result.joint_values[1];
  const Vector tip = Vector(1, 0, 0) + Vector(std::cos(q), std::sin(q), 0) +
                     Vector(std::cos(2 * q), std::sin(2 * q), 0);
  EXPECT_NEAR(tip.norm(), .2, 1e-3);
  EXPECT_GE(tip.norm(), .2 - 1e-12);
  robot.allow(2, 0);
  EXPECT_TRUE(robot.checkEdge({0, 0, 0}, {0, close, close}, nullptr, request, result));
}

TEST(CollisionRobot, NeighboursMayTouch) {
  JointChain chain;
  const int shoulder = chain.addRevolute(Tf::Identity(), Vector::UnitZ()),
            elbow = chain.addRevolute(at(1, 0, 0), Vector::UnitZ()),
            cover = chain.addFixed(at(.1, 0, 0), elbow),
            wrist = chain.addRevolute(at(1, 0, 0), Vector::UnitZ(), elbow);
  const auto large = std::make_shared<Sphere<double>>(2);
  const auto numTested = [&](const Robot& robot) {
    Result result;
    const JointValues still{0, 0, 0};
    robot.checkEdge(still, still, nullptr, requestOf(ContinuousQuery::kAll), result);
    return result.pairs.size();
  };
  Robot robot(chain);
  for (const int link : {JointChain::kBase, shoulder, elbow, cover, wrist})
    robot.attach(link, large);
  // The elbow and its cover do not move relative to each other.
  EXPECT_EQ(numTested(robot), 9u);
  Robot without = robot;
  without.allowNeighbours();
  // What is left: base to elbow, cover and wrist; shoulder to cover and wrist; cover to
  // wrist. No joint connects the cover with the shoulder or the wrist.
  EXPECT_EQ(numTested(without), 6u);
  EXPECT_EQ(numTested(robot), 9u);
  // Parts that are attached later, too: beside the base, the shoulder and the wrist.
  const int later = without.attach(cover, large);
  EXPECT_EQ(numTested(without), 9u);
  // Numbers of the others do not change when one goes.
  without.detach(0);
  EXPECT_EQ(numTested(without), 5u);
  without.detach(later);
  EXPECT_EQ(numTested(without), 3u);
}

TEST(CollisionRobot, HoldsObjects) {
  const TwoLinks links;
  Robot robot(links.chain);
  robot.allowNeighbours();
  robot.attach(0, links.ball, at(.5, 0, 0));
  const int finger = robot.attach(1, links.ball, at(.5, 0, 0));
  const AtRest wall(std::make_shared<Box<double>>(4, .2, 1), at(1, 1.3, 0));
  const Request request = requestOf(ContinuousQuery::kFirst);
  Result result;
  const JointValues from{0, 0}, to{0, 1.5};
  EXPECT_TRUE(robot.checkEdge(from, to, &wall.manager, request, result));
  const int rod =
      robot.attach(1, std::make_shared<Box<double>>(1.6, .02, .02), at(.5, 0, 0));
  EXPECT_NE(rod, finger);
  EXPECT_FALSE(robot.checkEdge(from, to, &wall.manager, request, result));
  EXPECT_EQ(result.pairs.at(0).part1, rod);
  EXPECT_NEAR(1.3 * std::sin(result.joint_values[1]), 1.2, .02);
  robot.detach(rod);
  EXPECT_TRUE(robot.checkEdge(from, to, &wall.manager, request, result));
  EXPECT_THROW(robot.detach(rod), Exception);
  // Its number is not used again.
  EXPECT_GT(robot.attach(1, links.ball), rod);
}

TEST(CollisionRobot, WhatIsHeldMayTouchLinks) {
  JointChain chain;
  for (int i = 0; i < 3; ++i) chain.addRevolute(at(i > 0, 0, 0), Vector::UnitZ());
  const auto large = std::make_shared<Sphere<double>>(2),
             small = std::make_shared<Sphere<double>>(.1);
  Robot robot(chain);
  robot.attach(0, small);
  const JointValues still{0, 0, 0};
  const Request request = requestOf(ContinuousQuery::kAny);
  Result result;
  const int held = robot.attach(2, large);
  EXPECT_FALSE(robot.checkEdge(still, still, nullptr, request, result));
  robot.detach(held);
  robot.attach(2, large, Tf::Identity(), {0});
  EXPECT_TRUE(robot.checkEdge(still, still, nullptr, request, result));
  // Other parts of the link may not.
  robot.attach(2, large, Tf::Identity(), {1});
  EXPECT_FALSE(robot.checkEdge(still, still, nullptr, request, result));
}

TEST(CollisionRobot, FiltersOfLinksAndObstacles) {
  const TwoLinks links;
  Robot robot(links.chain);
  robot.attach(0, links.ball, at(.5, 0, 0));
  AtRest wall(std::make_shared<Box<double>>(1, 1, 1), at(.5, 0, 0));
  const Request request = requestOf(ContinuousQuery::kAny);
  Result result;
  const auto isFree = [&] {
    return robot.checkEdge({0, 0}, {.1, 0}, &wall.manager, request, result);
  };
  EXPECT_FALSE(isFree());
  robot.setFilter(0, 2, ~4u);
  EXPECT_FALSE(isFree());
  wall.manager.setFilter(&wall.object, {4, ~0u, {}, {}});
  EXPECT_TRUE(isFree());
  wall.manager.setFilter(&wall.object, {8, 2, {}, {}});
  EXPECT_FALSE(isFree());
  // Those of the base and of parts that come later.
  robot.setFilter(JointChain::kBase, 1, ~8u);
  robot.setFilter(0, 2, ~8u);
  robot.allowNeighbours();
  robot.attach(JointChain::kBase, links.ball, at(.5, 0, 0));
  EXPECT_TRUE(isFree());
}

/// Groups of triangles decide in the query of a pair: one half of a sheet is no obstacle.
TEST(CollisionRobot, GroupsOfTrianglesOfAnObstacle) {
  const TwoLinks links;
  Robot robot(links.chain);
  robot.attach(0, links.ball, at(.5, 0, 0));
  robot.setFilter(0, 1, 2);
  TestMesh sheet;
  for (const double x : {0., 1.})
    for (const double y : {.3, .6}) sheet.vertices.emplace_back(x, y, 0);
  sheet.triangles = {{0, 2, 1}, {1, 2, 3}};
  AtRest obstacle(makeModel<BVHModel<OBBRSS<double>>>(sheet), Tf::Identity());
  Result result;
  const auto isFree = [&](std::uint32_t first, std::uint32_t second) {
    obstacle.manager.setFilter(&obstacle.object, {2, 1, {first, second}, {}});
    return robot.checkEdge({0, 0}, {.6, 0}, &obstacle.manager,
                           requestOf(ContinuousQuery::kAny), result);
  };
  EXPECT_FALSE(isFree(2, 4));
  EXPECT_TRUE(isFree(4, 4));
  // The boxes accept the obstacle, whose second triangle is not reached.
  EXPECT_TRUE(isFree(4, 2));
}

TEST(CollisionRobot, ObstaclesMayMove) {
  const TwoLinks links;
  Robot robot(links.chain);
  robot.attach(0, links.ball, at(1, 0, 0));
  // The ball comes to the resting arm: from (3, 0) to (1, 0), they meet at 1.2.
  Object moving(links.ball,
                std::make_shared<TranslationMotion<double>>(at(3, 0, 0), at(1, 0, 0)));
  Manager manager;
  manager.registerObject(&moving);
  Result result;
  const Request request = requestOf(ContinuousQuery::kFirst);
  EXPECT_FALSE(robot.checkEdge({0, 0}, {0, 0}, &manager, request, result));
  EXPECT_NEAR(result.time_of_contact, .9, 1e-4);
  // The arm moves away before.
  EXPECT_TRUE(robot.checkEdge({0, 0}, {3, 0}, &manager, request, result));
  // The base is elsewhere.
  robot.setBase(at(0, 5, 0));
  EXPECT_TRUE(robot.checkEdge({0, 0}, {0, 0}, &manager, request, result));
  robot.setBase(at(1, 0, 0));
  EXPECT_FALSE(robot.checkEdge({0, 0}, {0, 0}, &manager, request, result));
  EXPECT_NEAR(result.time_of_contact, .4, 1e-4);
}

TEST(CollisionRobot, FollowsPolynomials) {
  const TwoLinks links;
  Robot robot(links.chain);
  robot.attach(0, links.ball, at(1, 0, 0));
  const AtRest wall(std::make_shared<Box<double>>(4, .2, 1), at(0, 1, 0));
  const double angle = std::asin(.8);
  Result result;
  const Request request = requestOf(ContinuousQuery::kFirst);
  // q = 2 t^2 reaches the angle at its root.
  const auto motion = ChainMotion::polynomial(robot.chain(), {{0, 0, 2}, {.5}});
  EXPECT_FALSE(robot.checkMotion(motion, &wall.manager, request, result));
  EXPECT_NEAR(result.time_of_contact, std::sqrt(angle / 2), 1e-4);
  EXPECT_NEAR(result.joint_values[0], angle, 1e-3);
  EXPECT_EQ(result.joint_values[1], .5);
  // It has a base of its own.
  const auto elsewhere =
      ChainMotion::polynomial(robot.chain(), {{0, 0, 2}, {.5}}, at(0, -2, 0));
  EXPECT_TRUE(robot.checkMotion(elsewhere, &wall.manager, request, result));
}

TEST(CollisionRobot, ReadsGeometriesAgain) {
  const TwoLinks links;
  TestMesh small = makeIcosphere(1, .1), large = makeIcosphere(1, 1);
  const auto mesh = makeModel<DeformableBVHModel<>>(small);
  Robot robot(links.chain);
  robot.attach(0, mesh, at(.5, 0, 0));
  const AtRest wall(std::make_shared<Box<double>>(4, .2, 1), at(0, 1, 0));
  Result result;
  const Request request = requestOf(ContinuousQuery::kAny);
  EXPECT_TRUE(robot.checkEdge({0, 0}, {.1, 0}, &wall.manager, request, result));
  ASSERT_EQ(update(*mesh, large), BVH_OK);
  robot.update();
  EXPECT_FALSE(robot.checkEdge({0, 0}, {.1, 0}, &wall.manager, request, result));
}

/// A flat is compared with the boxes of all obstacles.
TEST(CollisionRobot, APartMayBeAPlane) {
  const TwoLinks links;
  Robot robot(links.chain);
  robot.attach(0, std::make_shared<Plane<double>>(Vector::UnitY(), .5));
  const AtRest ball(links.ball, at(1, 2, 0));
  Result result;
  const Request request = requestOf(ContinuousQuery::kFirst);
  EXPECT_TRUE(robot.checkEdge({0, 0}, {-.5, 0}, &ball.manager, request, result));
  EXPECT_FALSE(robot.checkEdge({0, 0}, {-2, 0}, &ball.manager, request, result));
}

TEST(CollisionRobot, IsTheSameInAllThreads) {
  Random random(5);
  ArmScene scene;
  makeRandomArm(random, scene);
  const Robot robot = scene.robot();
  std::vector<std::pair<JointValues, JointValues>> edges;
  for (int i = 0; i < 40; ++i) {
    const JointValues from = randomValues(random, scene.numJoints());
    edges.emplace_back(from, nearValues(random, from, 1));
  }
  const auto answers = [&] {
    std::vector<std::tuple<bool, double, JointValues>> out;
    for (const auto& edge : edges) {
      Result result;
      robot.checkEdge(edge.first, edge.second, &scene.manager(),
                      requestOf(ContinuousQuery::kFirst), result);
      out.emplace_back(result.is_free, result.time_of_contact, result.joint_values);
    }
    return out;
  };
  const auto expected = answers();
  std::vector<decltype(answers())> found(4);
  std::vector<std::thread> threads;
  for (auto& one : found) threads.emplace_back([&] { one = answers(); });
  for (std::thread& thread : threads) thread.join();
  for (const auto& one : found) EXPECT_EQ(one, expected);
}

TEST(CollisionRobot, Float) {
  const TwoLinks links;
  CollisionRobot<float> robot(links.chain);
  const auto ball = std::make_shared<Sphere<float>>(.1f);
  const int part = robot.attach(0, ball, at(1, 0, 0));
  const Vector3<float> place(0, 1, 0);
  const Matrix3<float> unturned = Matrix3<float>::Identity();
  ContinuousCollisionObject<float> wall(
      std::make_shared<Box<float>>(4.f, .2f, 1.f),
      std::make_shared<TranslationMotion<float>>(unturned, place, place));
  ContinuousCollisionManager<float> manager;
  manager.registerObject(&wall);
  ContinuousContactRequest<float> request;
  request.query = ContinuousQuery::kFirst;
  RobotEdgeResult<float> result;
  EXPECT_FALSE(robot.checkEdge({0, 0}, {2, 0}, &manager, request, result));
  EXPECT_NEAR(result.joint_values[0], std::asin(.8), 1e-3);
  EXPECT_EQ(result.pairs.at(0).part1, part);
}

TEST(CollisionRobot, RefusesWhatItCannotAnswer) {
  const TwoLinks links;
  expectRefused([] { Robot empty{JointChain()}; }, "no joints");
  expectRefused([&] { Robot named(links.chain, {"arm"}); }, "names");
  Robot robot(links.chain, {"upper", "lower"});
  const auto unbuilt = std::make_shared<BVHModel<OBBRSS<double>>>();
  expectRefused([&] { robot.attach(0, nullptr); }, "part 0 of link 0 (upper)");
  expectRefused([&] { robot.attach(1, unbuilt); }, "part 0 of link 1 (lower)");
  expectRefused([&] { robot.attach(2, links.ball); }, "no link 2");
  expectRefused([&] { robot.attach(-2, links.ball); }, "no link -2");
  expectRefused([&] { robot.attach(0, links.ball, Tf::Identity(), {7}); }, "touch_links");
  expectRefused([&] { robot.attach(0, links.ball, at(NAN, 0, 0)); }, "not finite");
  expectRefused([&] { robot.attach(0, std::make_shared<Sphere<double>>(NAN)); },
                "part 0");
  Tf mirrored = Tf::Identity();
  mirrored.linear()(0, 0) = -1;
  expectRefused([&] { robot.attach(0, links.ball, mirrored); }, "its origin");
  expectRefused([&] { robot.setBase(mirrored); }, "the base");
  expectRefused([&] { robot.allow(0, 9); }, "no link 9");
  expectRefused([&] { robot.setFilter(9, 1, 1); }, "no link 9");
  expectRefused([&] { robot.detach(0); }, "no part 0");
  // Nothing has changed.
  EXPECT_EQ(robot.attach(0, links.ball), 0);
  const AtRest wall(links.ball, Tf::Identity());
  const auto check = [&](const JointValues& from, const JointValues& to,
                         const Request& request = Request()) {
    Result result;
    robot.checkEdge(from, to, &wall.manager, request, result);
  };
  expectRefused([&] { check({0}, {0, 0}); }, "begin has 1 values");
  expectRefused([&] { check({0, 0}, {0, 0, 0}); }, "end has 3 values");
  expectRefused([&] { check({0, 0}, {0, NAN}); }, "value 1");
  expectRefused([&] { check({0, 0}, {0, 1e9}); }, "2^20");
  Result result;
  Request wrong;
  wrong.t_max = 2;
  expectRefused([&] { check({0, 0}, {0, 0}, wrong); }, "t_max");
  wrong = Request();
  wrong.num_threads = -1;
  // Also where no boxes meet.
  expectRefused(
      [&] {
        robot.checkEdge({0, 0}, {0, 0}, nullptr, wrong, result);
      },
      "num_threads");
  wrong = Request();
  wrong.min_approach_speed = 1;
  expectRefused(
      [&] {
        check({0, 0}, {0, 0}, wrong);
      },
      "o1 is part 0 of link 0 (upper), o2 is object 0");
  const ChainMotion stranger(TwoLinks().chain, {0, 0}, {1, 1});
  expectRefused([&] { robot.checkMotion(stranger, nullptr, Request(), result); },
                "not one of this robot's chain");
}

}  // namespace
}  // namespace test
}  // namespace fcl
