// SPDX-License-Identifier: BSD-3-Clause
//
// The continuous manager on random scenes of 2 to 60 objects of all kinds, against the
// queries of all pairs. FCL_CCD_TEST_SCENES sets the number of scenes:
//   FCL_CCD_TEST_SCENES=1000 build/release/test/unit/test_fcl_manager_scenes
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "fcl/broadphase/continuous_collision_manager.h"
#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "fcl/math/bv/OBBRSS.h"
#include "manager_scenes.h"
#include "sanitizer.h"
#include "test_models.h"

namespace fcl {
namespace test {
namespace {

using Scene = ManagerScene;
using Manager = ContinuousCollisionManager<double>;
using Object = ContinuousCollisionObject<double>;
using Request = ContinuousContactRequest<double>;
using Result = ContinuousContactResult<double>;
using ManagerResult = ContinuousManagerResult<double>;
using Rigid = BVHModel<OBBRSS<double>>;
using Deformable = DeformableBVHModel<KDOP<double, 16>>;

int numScenes() {
  const char* text = std::getenv("FCL_CCD_TEST_SCENES");
  return text ? std::atoi(text) : 60;
}

/// A minimum distance is for straight paths.
Request randomRequest(Random& random, bool straight) {
  Request request;
  if (straight && random.index(2) == 0) request.min_distance = .05;
  if (random.index(4) == 0) request.t_max = .6;
  if (random.index(2) == 0) request.num_threads = 3;
  return request;
}

using Pair = std::pair<const Object*, const Object*>;

struct PairTruth {
  Result all;
  /// The time that a query for the first contact of this pair has.
  double first;
};
using Truth = std::map<Pair, PairTruth>;

Result ask(const Scene& scene, const Object* a, const Object* b, Request request,
           bool with_thickness = true) {
  request.num_threads = 1;
  request.filter1 = scene.filterOf(a);
  request.filter2 = scene.filterOf(b);
  if (a == b) {
    // A mesh is tested with itself whatever its own group and mask are.
    request.filter1.group = ContinuousFilter().group;
    request.filter1.mask = ContinuousFilter().mask;
  }
  if (with_thickness) request.min_distance += scene.distanceOf(a, b);
  Result result;
  if (a == b)
    continuousSelfCollide(a->collisionGeometry().get(), request, result);
  else
    fcl::collide(a, b, request, result);
  return result;
}

/// The pairs in contact, by the queries of all pairs.
Truth bruteForce(const Scene& scene, Request request) {
  Truth truth;
  const auto add = [&](const Object* a, const Object* b) {
    request.query = ContinuousQuery::kAll;
    Result all = ask(scene, a, b, request);
    if (!all.is_collide) return;
    request.query = ContinuousQuery::kFirst;
    truth[{a, b}] = {std::move(all), ask(scene, a, b, request).time_of_contact};
  };
  add(scene.objects[0], scene.objects[0]);
  for (std::size_t i = 0; i < scene.objects.size(); ++i)
    for (std::size_t k = i + 1; k < scene.objects.size(); ++k)
      add(scene.objects[i], scene.objects[k]);
  return truth;
}

void expectFirst(const ManagerResult& result, const Truth& truth) {
  double first = 1;
  for (const auto& entry : truth) first = std::min(first, entry.second.first);
  EXPECT_EQ(result.time_of_contact, first);
  ASSERT_EQ(result.pairs.size(), truth.empty() ? 0u : 1u);
  EXPECT_EQ(result.is_collide, !truth.empty());
  if (truth.empty()) return;
  const auto found = truth.find({result.pairs[0].o1, result.pairs[0].o2});
  ASSERT_NE(found, truth.end());
  EXPECT_EQ(found->second.first, first);
}

void expectAny(const ManagerResult& result, const Truth& truth) {
  EXPECT_EQ(result.is_collide, !truth.empty());
  ASSERT_EQ(result.pairs.size(), truth.empty() ? 0u : 1u);
  if (truth.empty()) return;
  EXPECT_EQ(truth.count({result.pairs[0].o1, result.pairs[0].o2}), 1u);
}

void expectAll(const ManagerResult& result, const Truth& truth) {
  EXPECT_EQ(result.is_collide, !truth.empty());
  ASSERT_EQ(result.pairs.size(), truth.size());
  double time = 0;
  for (const auto& pair : result.pairs) {
    EXPECT_GE(pair.result.time_of_contact, time);
    time = pair.result.time_of_contact;
    const auto found = truth.find({pair.o1, pair.o2});
    ASSERT_NE(found, truth.end());
    expectIdentical(pair.result, found->second.all);
  }
}

/// The queries of one object with all others.
void expectOneWithAll(const Scene& scene, Object* one, Request request,
                      const Truth& truth) {
  std::map<const Object*, int> expected;
  for (const auto& entry : truth) {
    const Pair& pair = entry.first;
    if (pair.first == pair.second) continue;
    if (pair.first == one) expected[pair.second] = 1;
    if (pair.second == one) expected[pair.first] = 1;
  }
  request.query = ContinuousQuery::kAll;
  ManagerResult result;
  scene.manager.collide(one, request, result);
  EXPECT_EQ(result.pairs.size(), expected.size());
  for (const auto& pair : result.pairs) {
    EXPECT_EQ(pair.o1, one);
    EXPECT_EQ(expected.count(pair.o2), 1u);
  }
}

/// Some of the objects are in a second manager: the pairs across.
void expectTwoManagers(Scene& scene, Request request, const Truth& truth) {
  Manager half[2];
  std::map<const Object*, std::size_t> half_of;
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    Object* object = scene.objects[i];
    half_of[object] = i % 3 == 0 ? 1 : 0;
    half[half_of[object]].registerObject(object);
    half[half_of[object]].setFilter(object, scene.filterOf(object));
    if (scene.thickness.count(object))
      half[half_of[object]].setThickness(object, scene.thickness[object]);
  }
  std::size_t across = 0;
  for (const auto& entry : truth)
    across += half_of[entry.first.first] != half_of[entry.first.second] ? 1 : 0;
  request.query = ContinuousQuery::kAll;
  ManagerResult result;
  half[0].collide(half[1], request, result);
  EXPECT_EQ(result.pairs.size(), across);
  for (const auto& pair : result.pairs) {
    EXPECT_EQ(half_of[pair.o1], 0u);
    EXPECT_EQ(half_of[pair.o2], 1u);
    EXPECT_EQ(truth.count({pair.o1, pair.o2}) + truth.count({pair.o2, pair.o1}), 1u);
  }
}

/// The answer of one thread, with the same pairs in the same order.
void expectSameOrder(const Scene& scene, Request request, const ManagerResult& result) {
  if (request.num_threads == 1) return;
  request.num_threads = 1;
  ManagerResult one;
  scene.manager.collide(request, one);
  ASSERT_EQ(result.pairs.size(), one.pairs.size());
  for (std::size_t i = 0; i < one.pairs.size(); ++i) {
    EXPECT_EQ(result.pairs[i].o1, one.pairs[i].o1);
    EXPECT_EQ(result.pairs[i].o2, one.pairs[i].o2);
    expectIdentical(result.pairs[i].result, one.pairs[i].result);
  }
  // Of a query for the first contact it may depend on brackets.
  if (request.query != ContinuousQuery::kFirst) {
    EXPECT_EQ(result.num_tested, one.num_tested);
  }
}

/// @return the pairs in contact
Truth expectAnswers(Scene& scene, Request request, std::size_t one) {
  const Truth truth = bruteForce(scene, request);
  ManagerResult result;
  request.query = ContinuousQuery::kFirst;
  scene.manager.collide(request, result);
  expectFirst(result, truth);
  expectSameOrder(scene, request, result);
  request.query = ContinuousQuery::kAny;
  scene.manager.collide(request, result);
  expectAny(result, truth);
  expectSameOrder(scene, request, result);
  request.query = ContinuousQuery::kAll;
  scene.manager.collide(request, result);
  expectAll(result, truth);
  expectSameOrder(scene, request, result);
  expectOneWithAll(scene, scene.objects[one], request, truth);
  // The distance of a pair is for objects of one manager.
  if (scene.pair_distances.empty()) expectTwoManagers(scene, request, truth);
  return truth;
}

char kindOf(const Object* object) {
  const auto geometry = object->collisionGeometry();
  if (geometry->getObjectType() == OT_OCTREE) return 'o';
  if (geometry->getObjectType() == OT_GEOM) return 's';
  const auto* fcl_mesh = dynamic_cast<const Rigid*>(geometry.get());
  const bool deforms = dynamic_cast<const Deformable*>(geometry.get()) ||
                       (fcl_mesh && fcl_mesh->build_state == BVH_BUILD_STATE_UPDATED);
  return deforms ? 'd' : 'r';
}

TEST(ContinuousCollisionManager, ScenesWithTiltedFlatsAgainstAllPairs) {
  int in_contact = 0;
  for (int i = 0; i < numScenes() / 2; ++i) {
    SCOPED_TRACE("scene " + std::to_string(i));
    Random random(5000 + std::uint64_t(i));
    Scene scene(random, 2 + random.index(15), 20);
    for (int step = 0; step < 2; ++step) {
      SCOPED_TRACE("step " + std::to_string(step));
      if (step == 1) scene.change();
      const Request request = randomRequest(random, scene.is_straight);
      const Truth truth =
          expectAnswers(scene, request, random.index(scene.objects.size()));
      in_contact += !truth.empty();
    }
  }
  EXPECT_GT(in_contact, numScenes() / 4);
}

TEST(ContinuousCollisionManager, ScenesWithThicknessAgainstAllPairs) {
  int only_with_thickness = 0, in_contact = 0;
  for (int i = 0; i < manyRounds(numScenes()); ++i) {
    SCOPED_TRACE("scene " + std::to_string(i));
    Random random(9000 + std::uint64_t(i));
    Scene scene(random, 2 + random.index(30), i % 4 == 0 ? 10 : 0);
    for (int step = 0; step < 2; ++step) {
      SCOPED_TRACE("step " + std::to_string(step));
      const Request request = randomRequest(random, scene.is_straight);
      // With the boxes of before, of objects that rest too.
      ManagerResult without;
      scene.manager.collide(request, without);
      scene.addThickness(i % 2 == 0);
      if (step == 1) scene.change();
      const Truth truth =
          expectAnswers(scene, request, random.index(scene.objects.size()));
      in_contact += static_cast<int>(truth.size());
      for (const auto& entry : truth)
        only_with_thickness +=
            !ask(scene, entry.first.first, entry.first.second, request, false).is_collide;
    }
    if (HasFailure()) break;
  }
  EXPECT_GT(only_with_thickness, in_contact / 10);
}

TEST(ContinuousCollisionManager, ScenesOfAllKindsAgainstAllPairs) {
  int apart = 0, in_contact = 0;
  std::map<std::string, int> by_kind;
  for (int i = 0; i < numScenes(); ++i) {
    SCOPED_TRACE("scene " + std::to_string(i));
    Random random(1000 + std::uint64_t(i));
    Scene scene(random, 2 + random.index(59));
    for (int step = 0; step < 2; ++step) {
      SCOPED_TRACE("step " + std::to_string(step));
      if (step == 1) scene.change();
      const Request request = randomRequest(random, scene.is_straight);
      const Truth truth =
          expectAnswers(scene, request, random.index(scene.objects.size()));
      ++(truth.empty() ? apart : in_contact);
      for (const auto& entry : truth) {
        std::string kinds{kindOf(entry.first.first), kindOf(entry.first.second)};
        std::sort(kinds.begin(), kinds.end());
        ++by_kind[kinds];
      }
    }
    if (HasFailure()) break;
  }
  // All kinds of pairs were in contact: deforming and rigid meshes, shapes, octrees.
  for (const char* kinds : {"dd", "do", "dr", "ds", "oo", "or", "os", "rr", "rs", "ss"})
    EXPECT_GT(by_kind[kinds], 0) << kinds;
  EXPECT_GT(in_contact, apart);
  RecordProperty("scenes_in_contact", in_contact);
  for (const auto& entry : by_kind) RecordProperty("pairs_" + entry.first, entry.second);
}

}  // namespace
}  // namespace test
}  // namespace fcl
