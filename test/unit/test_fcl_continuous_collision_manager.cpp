// SPDX-License-Identifier: BSD-3-Clause
//
// The continuous manager: its answers against all pairs by brute force, its interface,
// and its errors.
#include "fcl/broadphase/continuous_collision_manager.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <new>
#include <set>
#include <thread>
#include <utility>
#include <vector>

#include "fcl/broadphase/broadphase_dynamic_AABB_tree.h"
#include "fcl/broadphase/default_broadphase_callbacks.h"
#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "fcl/geometry/shape/halfspace.h"
#include "fcl/geometry/shape/sphere.h"
#include "fcl/math/bv/OBBRSS.h"
#include "moving_objects.h"
#include "test_models.h"

namespace fcl {
namespace test {
namespace {

using Manager = ContinuousCollisionManager<double>;
using Object = ContinuousCollisionObject<double>;
using Request = ContinuousContactRequest<double>;
using Result = ContinuousManagerResult<double>;
using Geometry = std::shared_ptr<CollisionGeometry<double>>;
using Rigid = BVHModel<OBBRSS<double>>;
using Deformable = DeformableBVHModel<KDOP<double, 16>>;
using Vector = Vector3<double>;
using PairSet = std::set<std::pair<const void*, const void*>>;

/// Objects, as managers take them.
struct Scene {
  std::vector<std::unique_ptr<Object>> owned;
  std::vector<Object*> objects;

  Object* add(const Geometry& geometry,
              const std::shared_ptr<MotionBase<double>>& motion) {
    owned.push_back(makeObject(geometry, motion));
    objects.push_back(owned.back().get());
    return objects.back();
  }
};

/// Meshes of some kinds, the same in all scenes.
const std::vector<Geometry>& geometries() {
  static const std::vector<Geometry> all = [] {
    const TestMesh ball = makeIcosphere(0, .2), brick = makeBox({.3, .1, .05});
    std::vector<Geometry> out;
    out.push_back(makeModel<Rigid>(ball));
    out.push_back(makeModel<Rigid>(brick));
    out.push_back(makeModel<BVHModel<AABB<double>>>(brick));
    out.push_back(makeModel<Deformable>(ball));
    TestMesh bent = brick;
    for (auto& p : bent.vertices) p[2] += .5 * p[0] * p[0] + .1;
    out.push_back(makeModel<Deformable>(brick, bent));
    return out;
  }();
  return all;
}

std::shared_ptr<MotionBase<double>> randomObjectMotion(Random& random, double size) {
  const Vector from = random.point(size);
  switch (random.index(6)) {
    case 0:
      return translation(from, from);
    case 1:
      return translation(from, from + random.point(1));
    case 2:
      return std::make_shared<BoundedThrow>(from, random.point(1), random.point(1));
    default: {
      ReferenceMotion motion = randomMotion(random, .5);
      motion.move(from);
      return toFcl(motion);
    }
  }
}

Scene randomScene(Random& random, std::size_t count, double spacing = .8) {
  Scene scene;
  const double size = std::cbrt(double(count)) * spacing;
  for (std::size_t i = 0; i < count; ++i)
    scene.add(geometries()[random.index(geometries().size())],
              randomObjectMotion(random, size));
  return scene;
}

struct PairTime {
  std::pair<const void*, const void*> pair;
  double time;
};

/// The pairs in contact, each with the time that it has on its own.
std::vector<PairTime> bruteForce(const std::vector<Object*>& objects,
                                 const Request& asked) {
  Request request = asked;
  request.query = ContinuousQuery::kFirst;
  std::vector<PairTime> out;
  for (std::size_t i = 0; i < objects.size(); ++i)
    for (std::size_t k = i + 1; k < objects.size(); ++k) {
      ContinuousContactResult<double> result;
      fcl::collide(objects[i], objects[k], request, result);
      if (result.is_collide)
        out.push_back({{objects[i], objects[k]}, result.time_of_contact});
    }
  return out;
}

PairSet namesOf(const std::vector<PairTime>& pairs) {
  PairSet names;
  for (const PairTime& pair : pairs) names.insert(pair.pair);
  return names;
}

PairSet namesOf(const Result& result) {
  PairSet names;
  for (const auto& pair : result.pairs) names.emplace(pair.o1, pair.o2);
  return names;
}

/// First, any and all contacts of a manager whose objects are these.
void expectAnswers(const Manager& manager, const std::vector<Object*>& objects) {
  Request request;
  request.enable_contact = false;
  const std::vector<PairTime> truth = bruteForce(objects, request);
  const PairSet pairs = namesOf(truth);
  double first = 1;
  for (const PairTime& pair : truth) first = std::min(first, pair.time);

  Result result;
  request.query = ContinuousQuery::kFirst;
  manager.collide(request, result);
  EXPECT_EQ(result.is_collide, !truth.empty());
  EXPECT_EQ(result.time_of_contact, first);
  ASSERT_EQ(result.pairs.size(), truth.empty() ? 0u : 1u);
  for (const PairTime& pair : truth)
    if (pair.pair == *namesOf(result).begin()) {
      EXPECT_EQ(pair.time, first);
    }
  EXPECT_LE(result.num_tested, result.num_box_pairs + 1);

  request.query = ContinuousQuery::kAny;
  manager.collide(request, result);
  EXPECT_EQ(result.is_collide, !truth.empty());
  ASSERT_EQ(result.pairs.size(), truth.empty() ? 0u : 1u);
  if (!truth.empty()) {
    EXPECT_EQ(pairs.count(*namesOf(result).begin()), 1u);
  }

  request.query = ContinuousQuery::kAll;
  manager.collide(request, result);
  EXPECT_EQ(namesOf(result), pairs);
  EXPECT_EQ(result.pairs.size(), pairs.size());
  for (std::size_t i = 1; i < result.pairs.size(); ++i)
    EXPECT_LE(result.pairs[i - 1].result.time_of_contact,
              result.pairs[i].result.time_of_contact);
}

TEST(ContinuousCollisionManager, RandomScenesAgainstAllPairs) {
  Random random(1);
  int colliding = 0;
  for (int i = 0; i < 250; ++i) {
    SCOPED_TRACE(i);
    const Scene scene = randomScene(random, 2 + random.index(i % 10 == 0 ? 59 : 14));
    Manager manager;
    manager.registerObjects(scene.objects);
    expectAnswers(manager, scene.objects);
    Request request;
    request.query = ContinuousQuery::kAny;
    Result result;
    manager.collide(request, result);
    colliding += result.is_collide;
  }
  EXPECT_GT(colliding, 100);
  EXPECT_LT(colliding, 245);
}

TEST(ContinuousCollisionManager, FirstContactDoesNotDependOnTheOrder) {
  Random random(2);
  for (int i = 0; i < 60; ++i) {
    Scene scene = randomScene(random, 25);
    Request request;
    request.query = ContinuousQuery::kFirst;
    Result result[2];
    for (Result& out : result) {
      Manager manager;
      for (Object* object : scene.objects) manager.registerObject(object);
      manager.collide(request, out);
      std::reverse(scene.objects.begin(), scene.objects.end());
    }
    // The queries of a pair and of the pair swapped round differently.
    EXPECT_NEAR(result[0].time_of_contact, result[1].time_of_contact, 1e-12);
    ASSERT_EQ(result[0].pairs.size(), result[1].pairs.size());
    if (result[0].pairs.empty() || result[0].time_of_contact == 0) continue;
    EXPECT_EQ(std::minmax(result[0].pairs[0].o1, result[0].pairs[0].o2),
              std::minmax(result[1].pairs[0].o1, result[1].pairs[0].o2));
  }
}

bool collectPair(Object* o1, Object* o2, void* pairs) {
  static_cast<PairSet*>(pairs)->emplace(std::min(o1, o2), std::max(o1, o2));
  return false;
}

PairSet boxPairsOf(const Manager& manager) {
  PairSet pairs;
  manager.collide(&pairs, &collectPair);
  return pairs;
}

TEST(ContinuousCollisionManager, ChangesKeepTheBoxPairs) {
  Random random(3);
  Scene scene = randomScene(random, 60);
  Manager manager;
  std::vector<bool> is_in(60, false);
  std::size_t count = 0;
  for (int step = 0; step < 400; ++step) {
    const std::size_t i = random.index(60);
    Object* object = scene.objects[i];
    if (is_in[i] && random.index(2)) {
      // Another motion in the place of the old one, with the same object.
      scene.owned[i]->~Object();
      new (scene.owned[i].get())
          Object(geometries()[random.index(5)], randomObjectMotion(random, 3));
      if (random.index(2))
        manager.update(object);
      else
        manager.update(std::vector<Object*>{object, object});
    } else {
      is_in[i] ? manager.unregisterObject(object) : manager.registerObject(object);
      is_in[i] = !is_in[i];
      count = is_in[i] ? count + 1 : count - 1;
    }
    ASSERT_EQ(manager.size(), count);
    if (step % 20) continue;
    if (step % 100 == 0) manager.update();
    if (step % 140 == 0) manager.setup();
    Manager fresh;
    for (std::size_t k = 0; k < 60; ++k)
      if (is_in[k]) fresh.registerObject(scene.objects[k]);
    EXPECT_EQ(boxPairsOf(manager), boxPairsOf(fresh));
    std::vector<Object*> objects, expected;
    manager.getObjects(objects);
    fresh.getObjects(expected);
    EXPECT_EQ(std::set<Object*>(objects.begin(), objects.end()),
              std::set<Object*>(expected.begin(), expected.end()));
  }
  manager.clear();
  EXPECT_TRUE(manager.empty());
  EXPECT_TRUE(boxPairsOf(manager).empty());
}

TEST(ContinuousCollisionManager, FormationFlight) {
  Scene scene;
  for (int i = 0; i < 10; ++i)
    scene.add(geometries()[0], translation({.5 * i, 0, 0}, {.5 * i + 40, 30, 0}));
  // One that turns in the formation, and one that stands in the way.
  Matrix3<double> turned = AngleAxis<double>(1, Vector::UnitZ()).toRotationMatrix();
  scene.add(geometries()[0], std::make_shared<InterpMotion<double>>(
                                 Matrix3<double>::Identity(), Vector(0, .6, 0), turned,
                                 Vector(40, 30.6, 0), Vector(0, 0, 0)));
  Object* wall = scene.add(geometries()[1], translation({40, 30, 0}, {40, 30, 0}));
  Manager manager;
  manager.registerObjects(scene.objects);
  for (const auto& pair : boxPairsOf(manager))
    EXPECT_TRUE(pair.first == wall || pair.second == wall);
  Request request;
  request.query = ContinuousQuery::kFirst;
  Result result;
  manager.collide(request, result);
  ASSERT_EQ(result.pairs.size(), 1u);
  EXPECT_EQ(result.pairs[0].o2, wall);
}

/// What a callback of discrete objects saw.
struct SeenObjects {
  PairSet pairs;
  std::vector<CollisionObject<double>*> objects;
  std::size_t most{1000};
};

bool collectDiscrete(CollisionObject<double>* o1, CollisionObject<double>* o2,
                     void* cdata) {
  auto& seen = *static_cast<SeenObjects*>(cdata);
  auto *first = static_cast<Object*>(o1->getUserData()),
       *second = static_cast<Object*>(o2->getUserData());
  seen.pairs.emplace(std::min(first, second), std::max(first, second));
  seen.objects.insert(seen.objects.end(), {o1, o2});
  return seen.pairs.size() >= seen.most;
}

TEST(ContinuousCollisionManager, FclsInterface) {
  Random random(4);
  const Scene scene = randomScene(random, 30, .3);
  Manager manager, half[2];
  manager.registerObjects(scene.objects);
  for (std::size_t i = 0; i < 30; ++i) half[i % 2].registerObject(scene.objects[i]);
  const BroadPhaseContinuousCollisionManager<double>& base = manager;
  SeenObjects seen;
  base.collide(&seen, &collectDiscrete);
  EXPECT_EQ(seen.pairs, boxPairsOf(manager));
  ASSERT_GT(seen.pairs.size(), 5u);
  for (CollisionObject<double>* object : seen.objects) {
    // The AABB covers the geometry at the pose, which is that of the beginning.
    const auto* moving = static_cast<Object*>(object->getUserData());
    EXPECT_EQ(object->collisionGeometry(), moving->collisionGeometry());
    Transform3<double> tf;
    moving->getMotion()->integrate(0);
    moving->getMotion()->getCurrentTransform(tf);
    EXPECT_TRUE(object->getTransform().isApprox(tf, 1e-9));
    EXPECT_TRUE(object->getAABB().contain(tf.translation()));
  }
  seen = SeenObjects();
  seen.most = 2;
  base.collide(&seen, &collectDiscrete);
  EXPECT_EQ(seen.pairs.size(), 2u);

  // One against all, and the two halves, are all pairs.
  seen = SeenObjects();
  for (Object* object : scene.objects) base.collide(object, &seen, &collectDiscrete);
  EXPECT_EQ(seen.pairs, boxPairsOf(manager));
  PairSet pairs;
  half[0].collide(half[1], &pairs, &collectPair);
  seen = SeenObjects();
  half[0].collide(&half[1], &seen, &collectDiscrete);
  EXPECT_EQ(seen.pairs, pairs);
  for (const Manager& one : half) one.collide(&pairs, &collectPair);
  EXPECT_EQ(pairs, boxPairsOf(manager));

  DefaultContinuousCollisionData<double> data;
  manager.collide(&data, DefaultContinuousCollisionFunction<double>);
}

bool keepFirstGeometry(CollisionObject<double>* o1, CollisionObject<double>*,
                       void* geometry) {
  *static_cast<const CollisionGeometry<double>**>(geometry) =
      o1->collisionGeometry().get();
  return true;
}

TEST(ContinuousCollisionManager, AnObjectWhereAnotherOneWasHasItsOwnGeometry) {
  const auto still = translation(Vector(0, 0, 0), Vector(0, 0, 0));
  const auto rests = makeObject(std::make_shared<Sphere<double>>(1), still);
  Manager manager;
  manager.registerObject(rests.get());
  // Neither is registered. The second one is at the address of the first.
  alignas(Object) char memory[sizeof(Object)];
  for (int i = 0; i < 2; ++i) {
    const Geometry geometry = std::make_shared<Sphere<double>>(.5);
    Object* const object = new (memory) Object(geometry, still);
    const CollisionGeometry<double>* seen = nullptr;
    manager.collide(object, &seen, &keepFirstGeometry);
    EXPECT_EQ(seen, geometry.get());
    object->~Object();
  }
}

bool collectFirst(Object* o1, Object*, void* objects) {
  static_cast<std::set<const Object*>*>(objects)->insert(o1);
  return false;
}

bool unregisterFirst(Object* o1, Object*, void* data) {
  auto& manager = *static_cast<Manager*>(data);
  std::vector<Object*> objects;
  manager.getObjects(objects);
  if (std::find(objects.begin(), objects.end(), o1) != objects.end())
    manager.unregisterObject(o1);
  return false;
}

TEST(ContinuousCollisionManager, CallbacksMayChangeTheManager) {
  Random random(12);
  const Scene scene = randomScene(random, 30, .3);
  Manager manager;
  manager.registerObjects(scene.objects);
  std::set<const Object*> first;
  manager.collide(&first, &collectFirst);
  ASSERT_GT(first.size(), 3u);
  manager.collide(&manager, &unregisterFirst);
  EXPECT_EQ(manager.size(), scene.objects.size() - first.size());
  EXPECT_TRUE(boxPairsOf(manager).empty());
}

TEST(SweptCollisionObject, FclsDiscreteManagersMissNoContact) {
  Random random(6);
  Scene scene = randomScene(random, 40, .25);
  DynamicAABBTreeCollisionManager<double> tree;
  std::vector<std::unique_ptr<SweptCollisionObject<double>>> swept;
  for (Object* object : scene.objects) {
    swept.push_back(std::make_unique<SweptCollisionObject<double>>(object));
    tree.registerObject(swept.back().get());
  }
  for (int step = 0; step < 2; ++step) {
    if (step == 1)
      for (const auto& object : swept) {
        auto* moving = static_cast<Object*>(object->getUserData());
        const auto geometry = std::const_pointer_cast<CollisionGeometry<double>>(
            moving->collisionGeometry());
        moving->~Object();
        new (moving) Object(geometry, randomObjectMotion(random, .8));
        moving->setUserData(nullptr);
        object->update();
      }
    tree.update();
    SeenObjects seen;
    tree.collide(&seen, &collectDiscrete);
    const std::vector<PairTime> truth = bruteForce(scene.objects, Request());
    EXPECT_GT(truth.size(), 10u);
    for (const PairTime& pair : truth) {
      const auto name = std::minmax(pair.pair.first, pair.pair.second);
      EXPECT_EQ(seen.pairs.count({name.first, name.second}), 1u);
    }
  }
}

TEST(ContinuousCollisionManager, OneAndTwoManagers) {
  Random random(5);
  for (int i = 0; i < 40; ++i) {
    const Scene scene = randomScene(random, 20);
    Manager half[2];
    for (std::size_t k = 0; k < 20; ++k) half[k % 2].registerObject(scene.objects[k]);
    Request request;
    request.enable_contact = false;
    PairSet across, of_first;
    double first = 1;
    for (const PairTime& found : bruteForce(scene.objects, request)) {
      const auto parity = [&](const void* object) {
        return std::find(scene.objects.begin(), scene.objects.end(), object) -
               scene.objects.begin();
      };
      auto pair = found.pair;
      if (parity(pair.first) % 2 == parity(pair.second) % 2) continue;
      if (parity(pair.first) % 2) std::swap(pair.first, pair.second);
      across.insert(pair);
      if (pair.first == scene.objects[0]) of_first.insert(pair);
      first = std::min(first, found.time);
    }
    Result result;
    half[0].collide(half[1], request, result);
    EXPECT_EQ(namesOf(result), across);
    half[1].collide(scene.objects[0], request, result);
    EXPECT_EQ(namesOf(result), of_first);
    request.query = ContinuousQuery::kFirst;
    half[0].collide(half[1], request, result);
    EXPECT_NEAR(result.time_of_contact, first, 1e-4);
  }
}

TEST(ContinuousCollisionManager, GroupsAndMasks) {
  Scene scene;
  const auto still = translation({0, 0, 0}, {0, 0, 0});
  for (int i = 0; i < 3; ++i) scene.add(geometries()[0], still);
  Manager manager;
  manager.registerObjects(scene.objects);
  EXPECT_EQ(boxPairsOf(manager).size(), 3u);
  ContinuousFilter robot, wall;
  robot.group = 2;
  wall.group = 4;
  wall.mask = 2;
  manager.setFilter(scene.objects[0], robot);
  manager.setFilter(scene.objects[1], wall);
  manager.setFilter(scene.objects[2], wall);
  EXPECT_EQ(boxPairsOf(manager).size(), 2u);
  // Groups of triangles: all of them reject the robot.
  robot.triangle_masks.assign(20, 8);
  manager.setFilter(scene.objects[0], robot);
  EXPECT_EQ(boxPairsOf(manager).size(), 0u);
  // One of them accepts it: a box pair, whose contacts are those of this triangle.
  robot.triangle_masks[7] = 4;
  manager.setFilter(scene.objects[0], robot);
  EXPECT_EQ(boxPairsOf(manager).size(), 2u);
  Result result;
  manager.collide(Request(), result);
  ASSERT_EQ(result.pairs.size(), 2u);
  for (const auto& contact : result.pairs[0].result.contacts) EXPECT_EQ(contact.b1, 7);
}

TEST(ContinuousCollisionManager, ObjectsThatRestAreRemembered) {
  Scene scene;
  for (int i = 0; i < 40; ++i)
    scene.add(geometries()[1], translation({.5 * i, 0, 0}, {.5 * i, 0, 0}));
  Manager manager;
  manager.registerObjects(scene.objects);
  EXPECT_EQ(boxPairsOf(manager).size(), 39u);
  manager.unregisterObject(scene.objects[10]);
  EXPECT_EQ(boxPairsOf(manager).size(), 37u);
  // It takes the place of the one that is gone.
  Object* other = scene.add(geometries()[0], translation({0, 0, 0}, {0, 0, 0}));
  manager.registerObject(other);
  EXPECT_EQ(boxPairsOf(manager).size(), 38u);
  // At a distance they are found anew.
  Request request;
  request.min_distance = .3;
  request.query = ContinuousQuery::kAll;
  Result result;
  manager.collide(request, result);
  EXPECT_GT(result.num_box_pairs, 38u);
}

TEST(ContinuousCollisionManager, SelfCollisionOnRequest) {
  TestMesh flat = makeSheet(8, 1),
           folded = makeSheet(8, 1, [](double u, double v) {
             return Vector(std::abs(u - .5), v, .4 * (u > .5 ? .5 - u : u - .5));
           });
  const auto cloth = makeModel<Deformable>(flat, folded);
  Scene scene;
  scene.add(cloth, translation({0, 0, 0}, {1, 0, 0}));
  Manager manager;
  manager.registerObjects(scene.objects);
  Request request;
  Result result;
  manager.collide(request, result);
  EXPECT_FALSE(result.is_collide);
  manager.setSelfCollision(scene.objects[0], true);
  manager.collide(request, result);
  ContinuousContactResult<double> expected;
  continuousSelfCollide(cloth.get(), request, expected);
  ASSERT_TRUE(expected.is_collide);
  ASSERT_EQ(result.pairs.size(), 1u);
  EXPECT_EQ(result.pairs[0].o1, result.pairs[0].o2);
  expectIdentical(result.pairs[0].result, expected);
  expectRefused(
      [&] {
        manager.setSelfCollision(scene.add(std::make_shared<Sphere<double>>(1),
                                           translation({0, 0, 0}, {0, 0, 0})),
                                 true);
      },
      "is not a triangle mesh but a sphere");
}

TEST(ContinuousCollisionManager, AnObjectWithoutABoxIsPairedWithAll) {
  Scene scene;
  scene.add(geometries()[0], translation({50, 0, 0}, {51, 0, 0}));
  scene.add(geometries()[0], translation({0, 50, 0}, {0, 50, 0}));
  scene.add(geometries()[0],
            std::make_shared<Throw>(Vector(0, 0, 0), Vector(1, 0, 0), Vector(0, 0, 0)));
  // Below z = -1; and tilted, far below all objects.
  scene.add(std::make_shared<Halfspace<double>>(Vector(0, 0, 1), -1),
            translation({0, 0, 0}, {0, 0, 0}));
  scene.add(std::make_shared<Halfspace<double>>(Vector(1, 1, 1).normalized(), -100),
            translation({0, 0, 0}, {0, 0, 0}));
  Manager manager;
  manager.registerObjects(scene.objects);
  const PairSet pairs = boxPairsOf(manager);
  const auto has = [&](std::size_t i, std::size_t k) {
    return pairs.count(std::minmax<const void*>(scene.objects[i], scene.objects[k])) == 1;
  };
  EXPECT_FALSE(has(0, 1));
  for (const std::size_t i : {0, 1, 3, 4}) EXPECT_TRUE(has(2, i));
  EXPECT_FALSE(has(3, 0));
  EXPECT_FALSE(has(3, 1));
  EXPECT_FALSE(has(4, 0));
  EXPECT_FALSE(has(4, 1));
  // Two flats are always a pair.
  EXPECT_TRUE(has(4, 3));
}

TEST(ContinuousCollisionManager, QueriesOfSeveralThreads) {
  Random random(7);
  const Scene scene = randomScene(random, 60, .4);
  Manager manager;
  manager.registerObjects(scene.objects);
  Request request;
  request.query = ContinuousQuery::kFirst;
  // The first query of all remembers the pairs that rest.
  std::vector<PairSet> pairs(4);
  std::vector<Result> results(4);
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < pairs.size(); ++i)
    threads.emplace_back([&, i] {
      pairs[i] = boxPairsOf(manager);
      manager.collide(request, results[i]);
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_GT(pairs[0].size(), 30u);
  for (std::size_t i = 1; i < pairs.size(); ++i) {
    EXPECT_EQ(pairs[i], pairs[0]);
    EXPECT_EQ(results[i].time_of_contact, results[0].time_of_contact);
  }
  request.num_threads = 4;
  manager.collide(request, results[1]);
  EXPECT_EQ(results[1].time_of_contact, results[0].time_of_contact);
  EXPECT_EQ(results[1].num_tested, results[0].num_tested);
}

TEST(ContinuousCollisionManager, Float) {
  const auto ball = makeModel<BVHModel<OBBRSS<float>>>(makeIcosphere(0, .2));
  const auto motion = [](float from, float to) {
    return std::make_shared<TranslationMotion<float>>(
        Matrix3<float>::Identity(), Vector3<float>(from, 0, 0), Vector3<float>(to, 0, 0));
  };
  ContinuousCollisionObject<float> a(ball, motion(0, 1)), b(ball, motion(3, 1)),
      c(ball, motion(-2, -1));
  ContinuousCollisionManager<float> manager;
  manager.registerObjects({&a, &b, &c});
  ContinuousContactRequest<float> request;
  request.query = ContinuousQuery::kFirst;
  ContinuousManagerResult<float> result;
  manager.collide(request, result);
  ASSERT_EQ(result.pairs.size(), 1u);
  EXPECT_EQ(result.pairs[0].o1, &a);
  EXPECT_EQ(result.pairs[0].o2, &b);
  EXPECT_EQ(result.num_box_pairs, 1u);
  ContinuousContactResult<float> alone;
  fcl::collide(&a, &b, request, alone);
  EXPECT_EQ(result.time_of_contact, alone.time_of_contact);
}

TEST(ContinuousCollisionManager, Errors) {
  Scene scene;
  Object* object = scene.add(geometries()[0], translation({0, 0, 0}, {1, 0, 0}));
  Object* stranger = scene.add(geometries()[0], translation({0, 0, 0}, {1, 0, 0}));
  Object* nan = scene.add(geometries()[0], translation({0, NAN, 0}, {1, 0, 0}));
  Object* nan_shape =
      scene.add(std::make_shared<Sphere<double>>(NAN), translation({0, 0, 0}, {1, 0, 0}));
  Object* empty = scene.add(std::make_shared<Rigid>(), translation({0, 0, 0}, {1, 0, 0}));
  Object no_motion(geometries()[0]);
  Manager manager;
  manager.registerObject(object);
  for (Object* bad : {nan, nan_shape, empty, &no_motion}) {
    EXPECT_THROW(manager.registerObject(bad), Exception);
    EXPECT_THROW(manager.registerObjects({stranger, bad}), Exception);
  }
  EXPECT_THROW(manager.registerObject(nullptr), Exception);
  EXPECT_THROW(manager.registerObject(object), Exception);
  EXPECT_THROW(manager.registerObjects({stranger, stranger}), Exception);
  EXPECT_EQ(manager.size(), 1u);
  EXPECT_THROW(manager.unregisterObject(stranger), Exception);
  EXPECT_THROW(manager.unregisterObject(nullptr), Exception);
  EXPECT_THROW(manager.update(stranger), Exception);
  EXPECT_THROW(manager.update(std::vector<Object*>{object, nullptr}), Exception);
  EXPECT_THROW(manager.setFilter(stranger, ContinuousFilter()), Exception);
  EXPECT_THROW(manager.setSelfCollision(stranger, true), Exception);
  Result result;
  EXPECT_THROW(manager.collide(nullptr, Request(), result), Exception);
  Request request;
  request.t_max = NAN;
  EXPECT_THROW(manager.collide(request, result), Exception);
  request = Request();
  request.min_distance = -1;
  EXPECT_THROW(manager.collide(request, result), Exception);
  request = Request();
  request.num_threads = -1;
  EXPECT_THROW(manager.collide(request, result), Exception);
  // What a pair throws names its objects.
  manager.registerObject(stranger);
  request = Request();
  request.accepts_triangles = [](std::intptr_t, std::intptr_t) -> bool {
    throw Exception("no");
  };
  try {
    manager.collide(request, result);
    FAIL() << "a function that throws was not called";
  } catch (const Exception& error) {
    EXPECT_NE(std::string(error.what()).find("o1 is object 0, o2 is object 1"),
              std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace test
}  // namespace fcl
