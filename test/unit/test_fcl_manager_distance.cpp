// SPDX-License-Identifier: BSD-3-Clause
//
// The least distance of many objects, against continuousDistance() of all pairs.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "fcl/broadphase/continuous_collision_manager.h"
#include "fcl/geometry/shape/halfspace.h"
#include "fcl/geometry/shape/plane.h"
#include "fcl/geometry/shape/sphere.h"
#include "manager_scenes.h"
#include "sanitizer.h"

namespace fcl {
namespace test {
namespace {

using Manager = ContinuousCollisionManager<double>;
using Object = ContinuousCollisionObject<double>;
using Request = ContinuousDistanceRequest<double>;
using Result = ContinuousDistanceResult<double>;
using Nearest = ContinuousManagerDistance<double>;
using Vector = Vector3<double>;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

bool isFlat(const Object* object) {
  const NODE_TYPE type = object->getNodeType();
  return type == GEOM_PLANE || type == GEOM_HALFSPACE;
}

Result distanceOf(const ManagerScene& scene, const Object* a, const Object* b,
                  Request request) {
  request.filter1 = scene.filterOf(a);
  request.filter2 = scene.filterOf(b);
  Result result;
  continuousDistance(a->collisionGeometry().get(), a->getMotion(),
                     b->collisionGeometry().get(), b->getMotion(), request, result);
  return result;
}

/// The bracket of the least distance of all pairs, and the first time of contact.
struct Truth {
  double lo{kInfinity}, hi{kInfinity};
  bool is_collide{false};
  double first{1};
};

template <typename Counts>
Truth bruteForce(const ManagerScene& scene, const Request& request, Counts&& counts) {
  Truth truth;
  for (std::size_t i = 0; i < scene.objects.size(); ++i)
    for (std::size_t k = i + 1; k < scene.objects.size(); ++k) {
      const Object *const a = scene.objects[i], *const b = scene.objects[k];
      if (!counts(a, b) || (isFlat(a) && isFlat(b))) continue;
      const Result result = distanceOf(scene, a, b, request);
      truth.lo = std::min(truth.lo, result.distance_lo);
      truth.hi = std::min(truth.hi, result.distance_hi);
      if (!result.is_collide) continue;
      truth.is_collide = true;
      truth.first = std::min(truth.first, result.time);
    }
  return truth;
}

/// @param truth  with the same tolerance
void expectNearest(const ManagerScene& scene, const Nearest& nearest, const Truth& truth,
                   const Request& request) {
  const Result& result = nearest.result;
  EXPECT_FALSE(result.is_cut_off);
  EXPECT_EQ(result.is_collide, truth.is_collide);
  if (truth.is_collide) {
    // With the objects swapped the bracket of the time is another one.
    EXPECT_NEAR(result.time, truth.first, request.toc_err);
    EXPECT_EQ(result.distance_hi, 0);
  } else if (truth.hi < kInfinity) {
    // Brackets of the same distance overlap.
    EXPECT_LE(result.distance_lo, truth.hi);
    EXPECT_GE(result.distance_hi, truth.lo);
    EXPECT_LE(result.distance_hi - result.distance_lo,
              std::max(request.abs_err, request.rel_err * result.distance_hi) + 1e-9);
  } else {
    EXPECT_EQ(result.distance_lo, kInfinity);
    EXPECT_EQ(nearest.o1, nullptr);
    return;
  }
  // The two objects are that near, whatever the order.
  ASSERT_NE(nearest.o1, nullptr);
  const Result own = distanceOf(scene, nearest.o1, nearest.o2, request);
  EXPECT_LE(own.distance_lo, result.distance_hi);
  EXPECT_GE(own.distance_hi, result.distance_lo);
}

void expectEndsAt(const ManagerScene& scene, const Truth& truth, Request request) {
  request.max_distance = truth.lo / 2;
  Nearest nearest;
  scene.manager.distance(request, nearest);
  EXPECT_TRUE(nearest.result.is_cut_off);
  EXPECT_EQ(nearest.result.distance_lo, request.max_distance);
  EXPECT_GE(nearest.result.distance_hi, truth.lo);
  EXPECT_EQ(nearest.o1 != nullptr, nearest.result.distance_hi < kInfinity);
  request.max_distance = 2 * truth.hi;
  scene.manager.distance(request, nearest);
  expectNearest(scene, nearest, truth, request);
}

void expectOfOne(const ManagerScene& scene, Object* one, const Request& request) {
  const Truth truth = bruteForce(scene, request, [one](const Object* a, const Object* b) {
    return a == one || b == one;
  });
  Nearest nearest;
  scene.manager.distance(one, request, nearest);
  expectNearest(scene, nearest, truth, request);
  EXPECT_TRUE(!nearest.o1 || nearest.o1 == one);
}

void expectOfTwoManagers(const ManagerScene& scene, const Request& request) {
  Manager half[2];
  const auto halfOf = [&scene](const Object* object) {
    const auto place = std::find(scene.objects.begin(), scene.objects.end(), object);
    return (place - scene.objects.begin()) % 3 == 0 ? 1 : 0;
  };
  for (Object* object : scene.objects) {
    half[halfOf(object)].registerObject(object);
    half[halfOf(object)].setFilter(object, scene.filterOf(object));
  }
  const Truth truth = bruteForce(scene, request, [&](const Object* a, const Object* b) {
    return halfOf(a) != halfOf(b);
  });
  Nearest nearest;
  half[0].distance(half[1], request, nearest);
  expectNearest(scene, nearest, truth, request);
  EXPECT_TRUE(!nearest.o1 || halfOf(nearest.o1) == 0);
}

/// FCL's interface. It does not say which of the objects that touch do so first, and
/// filters of triangles do not act.
void expectOfCallback(const ManagerScene& scene, const Truth& truth,
                      const Request& request) {
  for (const auto& entry : scene.filters)
    if (!entry.second.triangle_groups.empty()) return;
  const BroadPhaseContinuousCollisionManager<double>& manager = scene.manager;
  DefaultContinuousDistanceData<double> data;
  data.request = request;
  manager.distance(&data, &DefaultContinuousDistanceFunction<double>);
  EXPECT_EQ(data.done, truth.is_collide);
  EXPECT_EQ(data.nearest.o1 != nullptr, truth.hi < kInfinity);
  if (truth.is_collide || !data.nearest.o1) return;
  EXPECT_LE(data.nearest.result.distance_lo, truth.hi);
  EXPECT_GE(data.nearest.result.distance_hi, truth.lo);
}

TEST(ContinuousManagerDistance, ScenesOfAllKindsAgainstAllPairs) {
  int apart = 0, in_contact = 0;
  std::size_t num_tested = 0, num_pairs = 0;
  for (int i = 0; i < manyRounds(64); ++i) {
    SCOPED_TRACE("scene " + std::to_string(i));
    Random random(9000 + std::uint64_t(i));
    const std::size_t count = 2 + random.index(22);
    ManagerScene scene(random, count, i % 4 == 3 ? 10 : 0, i % 2 == 0 ? 1.5 : 4);
    for (int step = 0; step < 2; ++step) {
      SCOPED_TRACE("step " + std::to_string(step));
      if (step == 1) scene.change();
      Request request;
      request.rel_err = 1e-2;
      if (random.index(4) == 0) request.t_max = .6;
      const Truth truth =
          bruteForce(scene, request, [](const Object*, const Object*) { return true; });
      Nearest nearest;
      scene.manager.distance(request, nearest);
      expectNearest(scene, nearest, truth, request);
      if (!truth.is_collide && truth.hi < kInfinity) {
        ++apart;
        num_tested += nearest.num_tested;
        num_pairs += count * (count - 1) / 2;
        expectEndsAt(scene, truth, request);
      }
      in_contact += truth.is_collide ? 1 : 0;
      expectOfOne(scene, scene.objects[random.index(count)], request);
      expectOfTwoManagers(scene, request);
      expectOfCallback(scene, truth, request);
    }
  }
  EXPECT_GT(apart, rounds(20));
  EXPECT_GT(in_contact, rounds(20));
  // Most pairs are never looked at.
  EXPECT_LT(num_tested, num_pairs / 3);
}

std::unique_ptr<Object> ballAt(const Vector& from, const Vector& to, double radius = 1) {
  return makeObject(std::make_shared<Sphere<double>>(radius), translation(from, to));
}

// A row of balls that rest, of which the gaps become smaller, far from the origin.
TEST(ContinuousManagerDistance, LooksAtFewPairs) {
  Manager manager;
  std::vector<std::unique_ptr<Object>> owned;
  double x = 1e4;
  for (int i = 0; i < 2000; ++i) {
    owned.push_back(ballAt({x, 0, 0}, {x, 0, 0}));
    manager.registerObject(owned.back().get());
    x += 3 - 5e-4 * i;
  }
  Request request;
  request.rel_err = 1e-6;
  Nearest nearest;
  manager.distance(request, nearest);
  EXPECT_NEAR(nearest.result.distance_hi, 1 - 5e-4 * 1998, 1e-5);
  EXPECT_EQ(nearest.o1, owned[1998].get());
  EXPECT_EQ(nearest.o2, owned[1999].get());
  EXPECT_LT(nearest.num_tested, 20u);
}

TEST(ContinuousManagerDistance, OfNothing) {
  Manager manager;
  Nearest nearest;
  const auto expectNone = [&](std::size_t num_tested) {
    manager.distance(Request(), nearest);
    EXPECT_EQ(nearest.o1, nullptr);
    EXPECT_EQ(nearest.o2, nullptr);
    EXPECT_EQ(nearest.result.distance_lo, kInfinity);
    EXPECT_EQ(nearest.result.distance_hi, kInfinity);
    EXPECT_FALSE(nearest.result.is_collide);
    EXPECT_FALSE(nearest.result.is_cut_off);
    EXPECT_EQ(nearest.num_tested, num_tested);
    // The same as if they were too far away.
    Request request;
    request.max_distance = 1;
    manager.distance(request, nearest);
    EXPECT_TRUE(nearest.result.is_cut_off);
    EXPECT_EQ(nearest.result.distance_lo, 1);
    DefaultContinuousDistanceData<double> data;
    manager.distance(&data, &DefaultContinuousDistanceFunction<double>);
    EXPECT_EQ(data.nearest.result.distance_hi, kInfinity);
    EXPECT_EQ(data.nearest.o1, nullptr);
  };
  expectNone(0);
  const auto one = ballAt({0, 0, 0}, {1, 0, 0}), two = ballAt({5, 0, 0}, {5, 0, 0});
  manager.registerObject(one.get());
  expectNone(0);
  // Both are in a group that does not meet itself.
  manager.registerObject(two.get());
  for (Object* object : {one.get(), two.get()}) manager.setFilter(object, {1, 2, {}, {}});
  expectNone(0);
  manager.setFilter(one.get(), {1, ~0U, {}, {}});
  manager.setFilter(two.get(), {1, ~0U, {}, {}});
  manager.distance(Request(), nearest);
  EXPECT_NEAR(nearest.result.distance_hi, 2, 2e-3);
  EXPECT_EQ(nearest.result.time, 1);
}

// Floor and wall, which touch, do not hide what stands on the floor.
TEST(ContinuousManagerDistance, PairsOfPlanesAreLeftOut) {
  const auto rest = translation({0, 0, 0}, {0, 0, 0});
  const auto floor = makeObject(std::make_shared<Halfspace<double>>(Vector(0, 0, 1), 0),
                                rest),
             roof = makeObject(std::make_shared<Plane<double>>(Vector(0, 0, 1), 1), rest),
             wall = makeObject(std::make_shared<Plane<double>>(Vector(1, 0, 0), 9), rest);
  const auto ball = ballAt({0, 0, .5}, {3, 0, .3}, .2);
  Manager manager;
  manager.registerObjects({floor.get(), roof.get(), wall.get()});
  Nearest nearest;
  manager.distance(Request(), nearest);
  EXPECT_EQ(nearest.result.distance_hi, kInfinity);
  manager.registerObject(ball.get());
  manager.distance(Request(), nearest);
  EXPECT_NEAR(nearest.result.distance_hi, .1, 1e-4);
  EXPECT_EQ(nearest.o1, floor.get());
  EXPECT_EQ(nearest.o2, ball.get());
  DefaultContinuousDistanceData<double> data;
  manager.distance(&data, &DefaultContinuousDistanceFunction<double>);
  EXPECT_NEAR(data.nearest.result.distance_hi, .1, 1e-4);
}

// What has no end is found from any distance, in all three forms.
TEST(ContinuousManagerDistance, PlanesThatAreFarAway) {
  const auto rest = translation({0, 0, 0}, {0, 0, 0});
  const auto ball = ballAt({0, 0, 5}, {0, 0, 4}, .2),
             other = ballAt({1, 0, 5}, {1, 0, 5}, .2);
  struct Case {
    Vector normal;
    double distance;
  };
  for (const Case& of : {Case{{0, 0, 1}, 3.8}, Case{{0, .6, .8}, 3.}}) {
    const auto floor =
        makeObject(std::make_shared<Halfspace<double>>(of.normal, 0), rest);
    const auto expectDistance = [&](const Nearest& nearest, const Object* o1) {
      EXPECT_NEAR(nearest.result.distance_hi, of.distance, 1e-2);
      EXPECT_EQ(nearest.o1, o1);
    };
    Manager floors, balls, both;
    floors.registerObject(floor.get());
    balls.registerObject(ball.get());
    both.registerObjects({floor.get(), ball.get()});
    Nearest nearest;
    both.distance(Request(), nearest);
    expectDistance(nearest, floor.get());
    balls.distance(floor.get(), Request(), nearest);
    expectDistance(nearest, floor.get());
    floors.distance(ball.get(), Request(), nearest);
    expectDistance(nearest, ball.get());
    both.distance(ball.get(), Request(), nearest);
    expectDistance(nearest, ball.get());
    balls.distance(floors, Request(), nearest);
    expectDistance(nearest, ball.get());
    Request cut;
    cut.max_distance = 10;
    both.distance(cut, nearest);
    expectDistance(nearest, floor.get());
    EXPECT_FALSE(nearest.result.is_cut_off);
    DefaultContinuousDistanceData<double> data;
    both.distance(&data, &DefaultContinuousDistanceFunction<double>);
    expectDistance(data.nearest, floor.get());
    // Two balls that are nearer to each other.
    both.registerObject(other.get());
    both.distance(Request(), nearest);
    EXPECT_NEAR(nearest.result.distance_hi, .6, 1e-2);
  }
}

// Objects of no size, and one that is far from all others.
TEST(ContinuousManagerDistance, OddSizes) {
  Manager manager;
  const auto point = ballAt({0, 0, 0}, {0, 0, 0}, 0),
             far = ballAt({1e30, 0, 0}, {1e30, 0, 0}, 0);
  Nearest nearest;
  manager.registerObject(point.get());
  manager.distance(Request(), nearest);
  EXPECT_EQ(nearest.o1, nullptr);
  manager.registerObject(far.get());
  manager.distance(Request(), nearest);
  EXPECT_NEAR(nearest.result.distance_hi, 1e30, 1e27);
  std::vector<std::unique_ptr<Object>> owned;
  constexpr int kCount = rounds(3000);
  for (int i = 0; i < kCount; ++i) {
    const Vector at(3. * (i % 15) + 1, 3. * (i / 15 % 15), 3.001 * (i / 225));
    owned.push_back(ballAt(at, at));
    manager.registerObject(owned.back().get());
  }
  manager.unregisterObject(point.get());
  manager.distance(Request(), nearest);
  EXPECT_NEAR(nearest.result.distance_hi, 1, 1e-2);
  // The neighbours along diagonals too, of which the boxes are as near.
  EXPECT_LT(nearest.num_tested, 13u * kCount);
}

// Obstacles that do not count against each other, and a robot that is further from
// them than they are from each other.
TEST(ContinuousManagerDistance, ObstaclesThatAreFilteredOut) {
  Manager manager;
  std::vector<std::unique_ptr<Object>> owned;
  for (int i = 0; i < rounds(3000); ++i) {
    const Vector at(3. * (i % 50), 3. * (i / 50), 0);
    owned.push_back(ballAt(at, at));
    manager.registerObject(owned.back().get());
    manager.setFilter(owned.back().get(), {1, 2, {}, {}});
  }
  Nearest nearest;
  manager.distance(Request(), nearest);
  EXPECT_EQ(nearest.num_tested, 0u);
  const auto robot = ballAt({0, 0, 1000}, {0, 0, 1000});
  manager.registerObject(robot.get());
  manager.setFilter(robot.get(), {2, 1, {}, {}});
  manager.distance(Request(), nearest);
  EXPECT_NEAR(nearest.result.distance_hi, 998, 1);
  EXPECT_EQ(nearest.o1, owned[0].get());
  EXPECT_EQ(nearest.o2, robot.get());
}

// The answer is the same, to the bit, whether the trees were built or grew.
TEST(ContinuousManagerDistance, TreesDoNotMatter) {
  for (int i = 0; i < 10; ++i) {
    Random random(500 + std::uint64_t(i));
    const ManagerScene scene(random, 30, 0, 4);
    Manager grown;
    for (Object* object : scene.objects) {
      grown.registerObject(object);
      grown.setFilter(object, scene.filterOf(object));
    }
    for (std::size_t k = 0; k < scene.objects.size(); k += 3)
      grown.update(scene.objects[k]);
    Nearest built, other;
    scene.manager.distance(Request(), built);
    grown.distance(Request(), other);
    EXPECT_EQ(built.o1, other.o1);
    EXPECT_EQ(built.o2, other.o2);
    EXPECT_EQ(built.result.distance_lo, other.result.distance_lo);
    EXPECT_EQ(built.result.distance_hi, other.result.distance_hi);
    EXPECT_EQ(built.result.time, other.result.time);
    EXPECT_EQ(built.num_tested, other.num_tested);
  }
}

// A mesh that is tested with itself touches itself. Its distance from others is another
// question.
TEST(ContinuousManagerDistance, SelfCollisionIsNoDistance) {
  Random random(3);
  ManagerScene scene(random, 1);
  const auto ball = ballAt({40, 0, 0}, {40, 0, 0});
  scene.manager.registerObject(ball.get());
  Nearest nearest;
  scene.manager.distance(Request(), nearest);
  EXPECT_EQ(nearest.o1, scene.objects[0]);
  EXPECT_EQ(nearest.o2, ball.get());
  EXPECT_GT(nearest.result.distance_lo, 30);
}

/// What a callback saw.
struct Calls {
  std::size_t count{0}, ends_after{~std::size_t{0}};
  double dist{0}, last{0};
};

bool countCalls(CollisionObject<double>* o1, CollisionObject<double>* o2, void* cdata,
                double& dist) {
  auto& calls = *static_cast<Calls*>(cdata);
  EXPECT_NE(o1->getUserData(), o2->getUserData());
  // All boxes are as wide: the order of their distances is that of their centers.
  const double apart =
      (o1->getAABB().center() - o2->getAABB().center()).cwiseAbs().maxCoeff();
  EXPECT_GE(apart, calls.last * (1 - 0x1p-7));
  calls.last = apart;
  ++calls.count;
  if (calls.dist > 0) dist = calls.dist;
  return calls.count >= calls.ends_after;
}

TEST(ContinuousManagerDistance, CallbacksDecide) {
  Manager manager;
  std::vector<std::unique_ptr<Object>> owned;
  for (int i = 0; i < 10; ++i) {
    owned.push_back(ballAt({4. * i, 0, 0}, {4. * i, 1, 0}));
    manager.registerObject(owned.back().get());
  }
  const auto callsWith = [&manager](Calls calls) {
    manager.distance(&calls, &countCalls);
    return calls.count;
  };
  // Each pair once, if the distance stays, the nearest first; up to a distance of 6.5
  // those of neighbours with one object in between.
  EXPECT_EQ(callsWith({}), 45u);
  EXPECT_EQ(callsWith({0, 3, 0, 0}), 3u);
  EXPECT_EQ(callsWith({0, ~std::size_t{0}, 6.5, 0}), 17u);
}

TEST(ContinuousManagerDistance, ErrorsNameTheObjects) {
  Manager manager;
  const auto far = ballAt({9, 0, 0}, {9, 0, 0});
  const auto thrown = makeObject(
      std::make_shared<Sphere<double>>(1),
      std::make_shared<Throw>(Vector(0, 0, 0), Vector(1, 0, 0), Vector(0, 0, 0)));
  manager.registerObjects({far.get(), thrown.get()});
  Nearest nearest;
  nearest.num_tested = 77;
  const auto messageOf = [&nearest](const auto& call) -> std::string {
    try {
      call();
    } catch (const Exception& error) {
      EXPECT_EQ(nearest.num_tested, 77u);
      return error.what();
    }
    return "no exception";
  };
  const std::string of_pair = messageOf([&] { manager.distance(Request(), nearest); });
  for (const char* part : {"o1 is object 0", "o2 is object 1", "BoundedMotion"})
    EXPECT_NE(of_pair.find(part), std::string::npos) << of_pair;
  // Also where no pair is looked at.
  manager.unregisterObject(thrown.get());
  Request request;
  request.max_distance = -1;
  EXPECT_NE(messageOf([&] { manager.distance(request, nearest); }).find("max_distance"),
            std::string::npos);
  request.max_distance = 1;
  request.abs_err = -1;
  EXPECT_NE(messageOf([&] { manager.distance(request, nearest); }).find("abs_err"),
            std::string::npos);
  EXPECT_NE(
      messageOf([&] { manager.distance(nullptr, Request(), nearest); }).find("null"),
      std::string::npos);
}

TEST(ContinuousManagerDistance, InFloat) {
  ContinuousCollisionManager<float> manager;
  std::vector<std::unique_ptr<ContinuousCollisionObject<float>>> owned;
  for (int i = 0; i < 5; ++i) {
    const Vector3<float> at(3.F * float(i), 0.F, 0.F),
        to = at + Vector3<float>(i == 2 ? .5F : 0.F, 0.F, 0.F);
    owned.push_back(std::make_unique<ContinuousCollisionObject<float>>(
        std::make_shared<Sphere<float>>(1.F),
        std::make_shared<TranslationMotion<float>>(Matrix3<float>::Identity(), at, to)));
    manager.registerObject(owned.back().get());
  }
  ContinuousManagerDistance<float> nearest;
  manager.distance(ContinuousDistanceRequest<float>(), nearest);
  EXPECT_NEAR(nearest.result.distance_hi, .5F, 1e-3F);
  EXPECT_EQ(nearest.o1, owned[2].get());
  EXPECT_EQ(nearest.o2, owned[3].get());
}

}  // namespace
}  // namespace test
}  // namespace fcl
