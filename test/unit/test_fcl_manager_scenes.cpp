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
#include "fcl/geometry/octree/octree.h"
#include "fcl/geometry/shape/box.h"
#include "fcl/geometry/shape/capsule.h"
#include "fcl/geometry/shape/cone.h"
#include "fcl/geometry/shape/convex.h"
#include "fcl/geometry/shape/cylinder.h"
#include "fcl/geometry/shape/ellipsoid.h"
#include "fcl/geometry/shape/halfspace.h"
#include "fcl/geometry/shape/plane.h"
#include "fcl/geometry/shape/sphere.h"
#include "fcl/geometry/shape/triangle_p.h"
#include "fcl/math/bv/OBBRSS.h"
#include "moving_objects.h"
#include "test_models.h"

namespace fcl {
namespace test {
namespace {

using Manager = ContinuousCollisionManager<double>;
using Object = ContinuousCollisionObject<double>;
using Request = ContinuousContactRequest<double>;
using Result = ContinuousContactResult<double>;
using ManagerResult = ContinuousManagerResult<double>;
using Geometry = std::shared_ptr<CollisionGeometry<double>>;
using Rigid = BVHModel<OBBRSS<double>>;
using Deformable = DeformableBVHModel<KDOP<double, 16>>;
using Vector = Vector3<double>;

int numScenes() {
  const char* text = std::getenv("FCL_CCD_TEST_SCENES");
  return text ? std::atoi(text) : 60;
}

TestMesh bent(TestMesh mesh) {
  for (auto& p : mesh.vertices) p += Vector(.1, .5 * p[0] * p[0], .5 * p[0] * p[1]);
  return mesh;
}

Geometry makeConvex() {
  auto corners = std::make_shared<std::vector<Vector>>(
      std::vector<Vector>{{-.2, -.2, -.1}, {.3, 0, -.1}, {-.1, .3, -.1}, {0, 0, .3}});
  auto faces = std::make_shared<std::vector<int>>(
      std::vector<int>{3, 0, 2, 1, 3, 0, 1, 3, 3, 1, 2, 3, 3, 2, 0, 3});
  return std::make_shared<Convex<double>>(corners, 4, faces);
}

/// About twenty cells, some of them pruned into larger ones.
Geometry makeOctree(Random& random) {
  const auto map = std::make_shared<octomap::OcTree>(.08);
  const auto occupy = [&map](std::size_t x, std::size_t y, std::size_t z, bool occupied) {
    const auto middle = [](std::size_t i) { return .08f * (float(i) - 3.5f); };
    map->updateNode(octomap::point3d(middle(x), middle(y), middle(z)), occupied);
  };
  for (int i = 0; i < 20; ++i)
    occupy(random.index(8), random.index(8), random.index(8), random.index(5) != 0);
  for (std::size_t k = 0; k < 8; ++k) occupy(4 + (k & 1), 4 + (k >> 1 & 1), k >> 2, true);
  map->prune();
  return std::make_shared<OcTree<double>>(map);
}

/// The geometries with a finite size: rigid meshes, meshes that deform, shapes, octrees.
std::vector<Geometry> makeGeometries() {
  const TestMesh ball = makeIcosphere(1, .2), brick = makeBox({.3, .1, .05}, 2);
  Random random(41);
  return {makeModel<Rigid>(ball),
          makeModel<BVHModel<AABB<double>>>(brick),
          makeModel<BVHModel<KDOP<double, 24>>>(brick),
          makeModel<Deformable>(ball),
          makeModel<Deformable>(brick, bent(brick)),
          makeModel<DeformableBVHModel<OBBRSS<double>>>(ball, bent(ball)),
          makeModel<Rigid>(brick, bent(brick)),  // in FCL's updated state
          std::make_shared<Box<double>>(.3, .2, .4),
          std::make_shared<Sphere<double>>(.2),
          std::make_shared<Capsule<double>>(.1, .4),
          std::make_shared<Ellipsoid<double>>(.1, .2, .3),
          std::make_shared<Cone<double>>(.2, .4),
          std::make_shared<Cylinder<double>>(.2, .3),
          makeConvex(),
          std::make_shared<TriangleP<double>>(Vector(0, 0, 0), Vector(.4, 0, .1),
                                              Vector(0, .4, 0)),
          makeOctree(random),
          makeOctree(random)};
}

Geometry randomFlat(Random& random) {
  const Vector normal = random.point(1).normalized();
  const double offset = random.uniform(-2, 0);
  if (random.index(3) == 0) return std::make_shared<Plane<double>>(normal, offset);
  return std::make_shared<Halfspace<double>>(normal, offset);
}

/// @param flats  how many of 100 objects are tilted planes or halfspaces
Geometry randomGeometry(Random& random, std::size_t flats) {
  if (flats > 0 && random.index(100) < flats) return randomFlat(random);
  static const std::vector<Geometry> finite = makeGeometries();
  // What has no end touches most others: few scenes have it.
  static const std::vector<Geometry> infinite = {
      std::make_shared<Plane<double>>(Vector(.6, 0, .8), -2),
      std::make_shared<Plane<double>>(Vector(0, 1, 0), 2),
      std::make_shared<Halfspace<double>>(Vector(0, 0, 1), -2.5),
      std::make_shared<Halfspace<double>>(Vector(0, .6, -.8), -2.5)};
  const auto& from = random.index(100) == 0 ? infinite : finite;
  return from[random.index(from.size())];
}

std::shared_ptr<MotionBase<double>> randomObjectMotion(Random& random, double size,
                                                       bool straight) {
  const Vector from = random.point(size);
  switch (random.index(straight ? 2 : 6)) {
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

ContinuousFilter randomFilter(Random& random, const Object& object) {
  const auto group = [&random] { return 1U << random.index(3); };
  const auto mask = [&random] { return std::uint32_t(1 + random.index(7)); };
  ContinuousFilter filter{group(), mask(), {}, {}};
  const auto geometry = object.collisionGeometry();
  if (const auto* mesh = dynamic_cast<const Rigid*>(geometry.get())) {
    for (int i = 0; i < mesh->num_tris; ++i) filter.triangle_groups.push_back(group());
    for (int i = 0; i < mesh->num_tris; ++i) filter.triangle_masks.push_back(mask());
  }
  return filter;
}

/// A minimum distance is for straight paths.
Request randomRequest(Random& random, bool straight) {
  Request request;
  if (straight && random.index(2) == 0) request.min_distance = .05;
  if (random.index(4) == 0) request.t_max = .6;
  return request;
}

/// The objects of a manager, in the order of their registration.
class Scene {
 public:
  Scene(Random& random, std::size_t count, std::size_t flats = 0)
      : random_(random), size_(.7 * std::cbrt(double(count))), flats_(flats) {
    is_straight = random.index(4) == 0;
    has_filters_ = random.index(2) == 0;
    cloth_ = makeModel<Deformable>(clothFrame(), clothFrame());
    std::vector<Object*> added;
    for (std::size_t i = 0; i < count; ++i) added.push_back(make(i == 0));
    manager.registerObjects(added);
    for (Object* object : added) setFilter(object);
    manager.setSelfCollision(objects[0], true);
  }

  /// The next step: some objects go, some come, some have another geometry or motion, and
  /// the cloth has another frame.
  void change() {
    const std::size_t count = objects.size();
    for (std::size_t i = 0; i < count / 5; ++i) {
      const std::size_t gone = 1 + random_.index(objects.size() - 1);
      manager.unregisterObject(objects[gone]);
      filters.erase(objects[gone]);
      objects.erase(objects.begin() + std::ptrdiff_t(gone));
      manager.registerObject(make(false));
      setFilter(objects.back());
    }
    EXPECT_EQ(update(*cloth_, clothFrame()), BVH_OK);
    std::vector<Object*> changed{objects[0]};
    for (std::size_t i = 1; i < objects.size(); ++i) {
      if (random_.index(3) != 0) continue;
      changed.push_back(objects[i]);
      filters.erase(objects[i]);
      manager.setFilter(objects[i], ContinuousFilter());
      objects[i]->~Object();
      new (objects[i]) Object(randomGeometry(random_, flats_), randomMotion());
    }
    const std::size_t way = random_.index(3);
    if (way == 0)
      for (Object* object : changed) manager.update(object);
    else if (way == 1)
      manager.update(changed);
    else
      manager.update();
  }

  const ContinuousFilter& filterOf(const Object* object) const {
    static const ContinuousFilter none;
    const auto entry = filters.find(object);
    return entry == filters.end() ? none : entry->second;
  }

  Manager manager;
  /// Whether all paths are straight.
  bool is_straight;
  std::vector<Object*> objects;
  std::map<const Object*, ContinuousFilter> filters;

 private:
  TestMesh clothFrame() {
    const Vector bend = random_.point(1);
    return makeSheet(4, 4, [&bend](double u, double v) {
      u -= .5;
      v -= .5;
      return Vector(u * (1 - std::abs(bend[2] * u)), v,
                    bend[0] * u * u + bend[1] * u * v + 3 * bend[2] * v * v * u);
    });
  }
  std::shared_ptr<MotionBase<double>> randomMotion() {
    return randomObjectMotion(random_, size_, is_straight);
  }
  Object* make(bool is_cloth) {
    owned_.push_back(makeObject(
        is_cloth ? Geometry(cloth_) : randomGeometry(random_, flats_), randomMotion()));
    objects.push_back(owned_.back().get());
    return objects.back();
  }
  void setFilter(Object* object) {
    if (!has_filters_ || random_.index(2) == 0) return;
    filters[object] = randomFilter(random_, *object);
    manager.setFilter(object, filters[object]);
  }

  Random& random_;
  double size_;
  std::size_t flats_;
  bool has_filters_;
  std::shared_ptr<Deformable> cloth_;
  std::vector<std::unique_ptr<Object>> owned_;
};

using Pair = std::pair<const Object*, const Object*>;

struct PairTruth {
  Result all;
  /// The time that a query for the first contact of this pair has.
  double first;
};
using Truth = std::map<Pair, PairTruth>;

Result ask(const Scene& scene, const Object* a, const Object* b, Request request) {
  request.filter1 = scene.filterOf(a);
  request.filter2 = scene.filterOf(b);
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

/// @return the pairs in contact
Truth expectAnswers(Scene& scene, Request request, std::size_t one) {
  const Truth truth = bruteForce(scene, request);
  ManagerResult result;
  request.query = ContinuousQuery::kFirst;
  scene.manager.collide(request, result);
  expectFirst(result, truth);
  request.query = ContinuousQuery::kAny;
  scene.manager.collide(request, result);
  expectAny(result, truth);
  request.query = ContinuousQuery::kAll;
  scene.manager.collide(request, result);
  expectAll(result, truth);
  expectOneWithAll(scene, scene.objects[one], request, truth);
  expectTwoManagers(scene, request, truth);
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
