// SPDX-License-Identifier: BSD-3-Clause
//
// New motions of the objects of a manager, and their thickness: what the random scenes do
// not reach.
#include <gtest/gtest.h>

#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "fcl/broadphase/collision_robot.h"
#include "fcl/broadphase/continuous_collision_manager.h"
#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "fcl/geometry/shape/sphere.h"
#include "fcl/math/bv/OBBRSS.h"
#include "fcl/math/motion/joint_chain.h"
#include "fcl/math/motion/twist_motion.h"
#include "moving_objects.h"
#include "test_models.h"

namespace fcl {
namespace test {
namespace {

using Manager = ContinuousCollisionManager<double>;
using Object = ContinuousCollisionObject<double>;
using Request = ContinuousContactRequest<double>;
using Result = ContinuousManagerResult<double>;
using Pose = Transform3<double>;
using V = Vector3<double>;

Pose randomPose(Random& random, bool turns) {
  Pose pose(Translation3<double>(random.point(1)));
  if (turns)
    pose.rotate(AngleAxis<double>(random.uniform(-2, 2), random.point(1).normalized()));
  return pose;
}

std::shared_ptr<MotionBase<double>> between(const Pose& beg, const Pose& end) {
  if (beg.linear() == end.linear())
    return fcl::make_aligned_shared<TranslationMotion<double>>(beg, end);
  return fcl::make_aligned_shared<InterpMotion<double>>(
      beg.linear(), beg.translation(), end.linear(), end.translation(), V::Zero());
}

TEST(FCL_MANAGER_STEPS, equalNewObjectsOnTheSamePaths) {
  Random random(71);
  const auto brick = makeModel<BVHModel<OBBRSS<double>>>(makeBox({.3, .1, .05}));
  const auto ball = std::make_shared<Sphere<double>>(.15);
  int contacts = 0;
  for (int round = 0; round < 20; ++round) {
    Manager manager;
    std::vector<std::unique_ptr<Object>> owned;
    std::vector<Object*> objects;
    std::vector<Pose> poses;
    for (int i = 0; i < 8; ++i) {
      poses.push_back(randomPose(random, true));
      const std::shared_ptr<CollisionGeometry<double>> geometry =
          i % 2 == 0 ? std::shared_ptr<CollisionGeometry<double>>(brick) : ball;
      owned.push_back(makeObject(geometry, between(poses[i], poses[i])));
      objects.push_back(owned.back().get());
    }
    manager.registerObjects(objects);
    for (std::size_t i = 0; i < objects.size(); ++i)
      poses[i] = detail::lastPoseOf(*objects[i]);
    for (int step = 0; step < 4; ++step) {
      std::vector<Pose> next;
      for (const Pose& pose : poses) {
        Pose moved = randomPose(random, random.index(2) == 0);
        if (random.index(2) == 0) moved.linear() = pose.linear();
        next.push_back(moved);
      }
      if (step % 2 == 0)
        manager.step(objects, next);
      else
        for (std::size_t i = 0; i < objects.size(); ++i)
          manager.step(objects[i], next[i]);

      Manager fresh;
      std::vector<std::unique_ptr<Object>> others;
      for (std::size_t i = 0; i < objects.size(); ++i) {
        others.push_back(makeObject(std::const_pointer_cast<CollisionGeometry<double>>(
                                        objects[i]->collisionGeometry()),
                                    between(poses[i], next[i])));
        fresh.registerObject(others.back().get());
        // The next motion begins where this one ends, up to the rounding of FCL's motion.
        const Pose end = detail::lastPoseOf(*objects[i]);
        EXPECT_TRUE(end.isApprox(next[i], 1e-12));
        poses[i] = end;
      }
      Result result, expected;
      manager.collide(Request(), result);
      fresh.collide(Request(), expected);
      ASSERT_EQ(result.pairs.size(), expected.pairs.size());
      for (std::size_t i = 0; i < result.pairs.size(); ++i)
        expectIdentical(result.pairs[i].result, expected.pairs[i].result);
      contacts += static_cast<int>(result.pairs.size());
    }
  }
  EXPECT_GT(contacts, 100);
}

/// A ball at the origin and one that is 3 away from it.
struct TwoBalls {
  Manager manager;
  std::shared_ptr<Sphere<double>> ball{std::make_shared<Sphere<double>>(1)};
  std::unique_ptr<Object> one{makeObject(ball, translation(V(0, 0, 0), V(0, 0, 0)))},
      two{makeObject(ball, translation(V(3, 0, 0), V(3, 0, 0)))};

  TwoBalls() { manager.registerObjects({one.get(), two.get()}); }
  Result ask(const Request& request = Request()) const {
    Result result;
    manager.collide(request, result);
    return result;
  }
};

TEST(FCL_MANAGER_STEPS, motionsOfAllKinds) {
  TwoBalls scene;
  EXPECT_FALSE(scene.ask().is_collide);
  scene.manager.setMotion(scene.two.get(), Pose(Translation3<double>(4, 0, 0)),
                          Pose(Translation3<double>(0, 0, 0)));
  EXPECT_NEAR(scene.ask().time_of_contact, .5, 1e-6);
  // Half a turn about the origin of the other ball, and to it.
  scene.manager.setMotion(
      scene.two.get(), std::make_shared<TwistMotion<double>>(
                           Pose(Translation3<double>(3, 0, 0)), V(-4, 0, 0), V(0, 0, 0)));
  EXPECT_NEAR(scene.ask().time_of_contact, .25, 1e-6);
  // From where that ends, at -1: it overlaps.
  scene.manager.step(scene.two.get(), Pose(Translation3<double>(-5, 0, 0)));
  EXPECT_EQ(scene.ask().time_of_contact, 0);
  scene.manager.step(scene.two.get(), Pose(Translation3<double>(-4, 0, 0)));
  EXPECT_FALSE(scene.ask().is_collide);
}

TEST(FCL_MANAGER_STEPS, objectsThatRestedAndMove) {
  TwoBalls scene;
  scene.manager.step(scene.two.get(), Pose(Translation3<double>(1, 0, 0)));
  scene.manager.step(scene.two.get(), Pose(Translation3<double>(1, 0, 0)));
  EXPECT_EQ(scene.ask().num_box_pairs, 1u);
  scene.manager.step(scene.two.get(), Pose(Translation3<double>(1.5, 0, 0)));
  EXPECT_EQ(scene.ask().num_box_pairs, 1u);
  EXPECT_EQ(scene.ask().pairs.size(), 1u);
  scene.manager.setMotion(scene.two.get(), translation(V(5, 0, 0), V(6, 0, 0)));
  EXPECT_EQ(scene.ask().num_box_pairs, 0u);
}

/// Balls that overlap in a row.
std::vector<std::unique_ptr<Object>> overlappingBalls(int count) {
  const auto ball = std::make_shared<Sphere<double>>(1);
  std::vector<std::unique_ptr<Object>> balls;
  for (int i = 0; i < count; ++i)
    balls.push_back(makeObject(ball, translation(V(i, 0, 0), V(i, .1, 0))));
  return balls;
}

TEST(FCL_MANAGER_STEPS, firstContactAtBeginEndsTheQuery) {
  Manager manager;
  const auto balls = overlappingBalls(50);
  for (const auto& ball : balls) manager.registerObject(ball.get());
  Request request;
  request.query = ContinuousQuery::kFirst;
  Result result;
  manager.collide(request, result);
  EXPECT_GT(result.num_box_pairs, 90u);
  EXPECT_EQ(result.num_tested, 1u);
  ASSERT_EQ(result.pairs.size(), 1u);
  EXPECT_EQ(result.pairs[0].o1, balls[0].get());
}

TEST(FCL_MANAGER_STEPS, errorOfTheFirstPairWithAnyThreads) {
  Manager manager;
  const auto balls = overlappingBalls(40);
  for (const auto& ball : balls) manager.registerObject(ball.get());
  Request request;
  request.min_approach_speed = 1;  // not for shapes
  for (const auto query :
       {ContinuousQuery::kAll, ContinuousQuery::kFirst, ContinuousQuery::kAny})
    for (const int threads : {1, 3}) {
      request.query = query;
      request.num_threads = threads;
      Result result;
      result.num_box_pairs = 7;
      std::string message;
      try {
        manager.collide(request, result);
      } catch (const Exception& error) {
        message = error.what();
      }
      EXPECT_EQ(message.rfind("o1 is object 0, o2 is object 1: ", 0), 0u) << message;
      EXPECT_EQ(result.num_box_pairs, 7u);
    }
}

/// A motion of the program of which nothing is known but its poses.
class OwnMotion : public TranslationMotion<double> {
 public:
  using TranslationMotion<double>::TranslationMotion;
};

TEST(FCL_MANAGER_STEPS, threadsShareAMotionOfTheProgram) {
  Manager manager;
  const TestMesh sheet = makeSheet(8, 8);
  TestMesh bent = sheet;
  for (V& p : bent.vertices) p.z() += .1 * p.x();
  const auto cloth = makeModel<DeformableBVHModel<>>(sheet, bent);
  const auto object = makeObject(
      cloth, fcl::make_aligned_shared<OwnMotion>(Pose(Translation3<double>(0, 0, 1)),
                                                 Pose(Translation3<double>(0, 0, -1))));
  manager.registerObject(object.get());
  Random random(73);
  const auto ball = std::make_shared<Sphere<double>>(.1);
  std::vector<std::unique_ptr<Object>> balls;
  for (int i = 0; i < 60; ++i) {
    const V place = V(.5, .5, 0) + random.point(.5);
    balls.push_back(makeObject(ball, translation(place, place)));
    manager.registerObject(balls.back().get());
  }
  Request request;
  Result one;
  manager.collide(request, one);
  EXPECT_GT(one.pairs.size(), 50u);
  request.num_threads = 3;
  for (int i = 0; i < 20; ++i) {
    Result result;
    manager.collide(request, result);
    ASSERT_EQ(result.pairs.size(), one.pairs.size());
    for (std::size_t k = 0; k < one.pairs.size(); ++k)
      expectIdentical(result.pairs[k].result, one.pairs[k].result);
  }
}

TEST(FCL_MANAGER_STEPS, errorsChangeNothing) {
  TwoBalls scene;
  Manager& manager = scene.manager;
  Object* const two = scene.two.get();
  const MotionBase<double>* const before = two->getMotion();
  Pose bad = Pose::Identity();
  bad.translation().x() = std::numeric_limits<double>::quiet_NaN();
  const auto good = translation(V(0, 0, 0), V(1, 0, 0));
  EXPECT_THROW(manager.step(two, bad), Exception);
  EXPECT_THROW(manager.step({scene.one.get(), two}, {Pose::Identity(), bad}), Exception);
  EXPECT_THROW(manager.step({scene.one.get(), two}, {Pose::Identity()}), Exception);
  EXPECT_THROW(manager.setMotion({two, two, two}, {good, good}), Exception);
  EXPECT_THROW(manager.setMotion(two, nullptr), Exception);
  EXPECT_THROW(manager.setMotion(nullptr, good), Exception);
  Object other(scene.ball, good);
  EXPECT_THROW(manager.setMotion({two, &other}, {good, good}), Exception);
  EXPECT_EQ(two->getMotion(), before);
  EXPECT_FALSE(scene.ask().is_collide);

  EXPECT_THROW(manager.setThickness(&other, 1), Exception);
  EXPECT_THROW(manager.setThickness(nullptr, 1), Exception);
  EXPECT_THROW(manager.setThickness(two, -1), Exception);
  EXPECT_THROW(manager.setThickness(two, std::numeric_limits<double>::infinity()),
               Exception);
  EXPECT_THROW(manager.setPairDistance(two, &other, 1), Exception);
  EXPECT_THROW(manager.setPairDistance(two, scene.one.get(), bad.translation().x()),
               Exception);
  EXPECT_FALSE(scene.ask().is_collide);
}

TEST(FCL_MANAGER_STEPS, turnsInFloat) {
  using Pose = Transform3<float>;
  Random random(72);
  const auto ball = std::make_shared<Sphere<float>>(1.f);
  for (int i = 0; i < 50; ++i) {
    const Pose beg = randomPose(random, true).cast<float>(),
               end = randomPose(random, true).cast<float>();
    ContinuousCollisionObject<float> object(
        ball, std::make_shared<TranslationMotion<float>>(beg, beg));
    ContinuousCollisionManager<float> manager;
    manager.registerObject(&object);
    manager.step(&object, end);
    Pose last;
    object.getMotion()->integrate(1);
    object.getMotion()->getCurrentTransform(last);
    EXPECT_TRUE(last.isApprox(end, 1e-5f));
  }
}

TEST(FCL_MANAGER_STEPS, thicknessAndPairs) {
  TwoBalls scene;
  Manager& manager = scene.manager;
  Object *const one = scene.one.get(), *const two = scene.two.get();
  manager.setThickness(one, .6);
  EXPECT_FALSE(scene.ask().is_collide);
  manager.setThickness(two, .5);
  EXPECT_TRUE(scene.ask().is_collide);
  for (Object* object : {one, two}) {
    Result with_all;
    manager.collide(object, Request(), with_all);
    EXPECT_TRUE(with_all.is_collide);
  }
  Request request;
  request.ignore_initially_closer =
      true;  // which needs a distance, and this pair has one
  EXPECT_FALSE(scene.ask(request).is_collide);
  manager.setPairDistance(two, one, .9);
  EXPECT_FALSE(scene.ask().is_collide);
  request = Request();
  request.min_distance = .2;
  EXPECT_TRUE(scene.ask(request).is_collide);
  // A mesh or shape that is not registered has none.
  Object other(scene.ball, translation(V(5.4, 0, 0), V(5.4, 0, 0)));
  Result result;
  manager.collide(&other, Request(), result);
  ASSERT_EQ(result.pairs.size(), 1u);
  EXPECT_EQ(result.pairs[0].o2, two);
  manager.setThickness(two, 0);
  manager.collide(&other, Request(), result);
  EXPECT_FALSE(result.is_collide);
  // The distance is that of the geometries.
  manager.setPairDistance(two, one, 2);
  EXPECT_TRUE(scene.ask().is_collide);
  ContinuousManagerDistance<double> nearest;
  manager.distance(ContinuousDistanceRequest<double>(), nearest);
  EXPECT_NEAR(nearest.result.distance_lo, 1, 1e-2);
  manager.resetPairDistance(one, two);
  EXPECT_FALSE(scene.ask().is_collide);
  // What is forgotten with an object does not come back with it.
  manager.setPairDistance(one, two, 2);
  manager.unregisterObject(two);
  manager.registerObject(two);
  EXPECT_FALSE(scene.ask().is_collide);
}

TEST(FCL_MANAGER_STEPS, obstaclesOfARobotHaveAThickness) {
  JointChain chain;
  chain.addRevolute(Pose::Identity(), {0, 0, 1});
  CollisionRobot<double> robot(chain);
  robot.attach(0, std::make_shared<Sphere<double>>(.1),
               Pose(Translation3<double>(1, 0, 0)));
  Manager obstacles;
  const auto post = makeObject(std::make_shared<Sphere<double>>(.1),
                               translation(V(0, 1.3, 0), V(0, 1.3, 0)));
  obstacles.registerObject(post.get());
  Request request;
  RobotEdgeResult<double> result;
  EXPECT_TRUE(robot.checkEdge({0}, {2}, &obstacles, request, result));
  obstacles.setThickness(post.get(), .2);
  EXPECT_FALSE(robot.checkEdge({0}, {2}, &obstacles, request, result));
  obstacles.setThickness(post.get(), .05);
  EXPECT_TRUE(robot.checkEdge({0}, {2}, &obstacles, request, result));
}

TEST(FCL_MANAGER_STEPS, aRobotWithAnyThreads) {
  Random random(74);
  JointChain chain;
  for (int i = 0; i < 5; ++i)
    chain.addRevolute(Pose(Translation3<double>(i > 0 ? .4 : 0, 0, 0)),
                      random.point(1).normalized());
  CollisionRobot<double> robot(chain);
  robot.allowNeighbours();
  for (int i = 0; i < 5; ++i)
    robot.attach(i, std::make_shared<Sphere<double>>(.15),
                 Pose(Translation3<double>(.2, 0, 0)));
  Manager obstacles;
  std::vector<std::unique_ptr<Object>> balls;
  for (int i = 0; i < 80; ++i) {
    const V place = random.point(1.5);
    balls.push_back(
        makeObject(std::make_shared<Sphere<double>>(.1), translation(place, place)));
    obstacles.registerObject(balls.back().get());
  }
  int contacts = 0;
  for (int i = 0; i < 20; ++i)
    for (const auto query :
         {ContinuousQuery::kAll, ContinuousQuery::kFirst, ContinuousQuery::kAny}) {
      std::vector<double> from, to;
      for (int k = 0; k < 5; ++k) {
        from.push_back(random.uniform(-2, 2));
        to.push_back(from.back() + random.uniform(-1, 1));
      }
      Request request;
      request.query = query;
      RobotEdgeResult<double> one, result;
      robot.checkEdge(from, to, &obstacles, request, one);
      request.num_threads = 3;
      robot.checkEdge(from, to, &obstacles, request, result);
      EXPECT_EQ(result.joint_values, one.joint_values);
      ASSERT_EQ(result.pairs.size(), one.pairs.size());
      for (std::size_t k = 0; k < one.pairs.size(); ++k)
        expectIdentical(result.pairs[k].result, one.pairs[k].result);
      contacts += static_cast<int>(one.pairs.size());
    }
  EXPECT_GT(contacts, 20);
}

}  // namespace
}  // namespace test
}  // namespace fcl
