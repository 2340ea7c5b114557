// SPDX-License-Identifier: BSD-3-Clause
#include "manager_scenes.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <utility>

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

namespace fcl {
namespace test {
namespace {

using Object = ContinuousCollisionObject<double>;
using Geometry = std::shared_ptr<CollisionGeometry<double>>;
using Rigid = BVHModel<OBBRSS<double>>;
using Deformable = DeformableBVHModel<KDOP<double, 16>>;
using Vector = Vector3<double>;

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

}  // namespace

ManagerScene::ManagerScene(Random& random, std::size_t count, std::size_t flats,
                           double spacing)
    : random_(random), size_(.7 * spacing * std::cbrt(double(count))), flats_(flats) {
  is_straight = random.index(4) == 0;
  has_filters_ = random.index(2) == 0;
  cloth_ = makeModel<Deformable>(clothFrame(), clothFrame());
  std::vector<Object*> added;
  for (std::size_t i = 0; i < count; ++i) added.push_back(make(i == 0));
  manager.registerObjects(added);
  for (Object* object : added) setFilter(object);
  manager.setSelfCollision(objects[0], true);
}

void ManagerScene::change() {
  const std::size_t count = objects.size();
  for (std::size_t i = 0; i < count / 5; ++i) {
    const std::size_t gone = 1 + random_.index(objects.size() - 1);
    manager.unregisterObject(objects[gone]);
    filters.erase(objects[gone]);
    thickness.erase(objects[gone]);
    for (auto it = pair_distances.begin(); it != pair_distances.end();)
      it = it->first.first == objects[gone] || it->first.second == objects[gone]
               ? pair_distances.erase(it)
               : std::next(it);
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

const ContinuousFilter& ManagerScene::filterOf(const Object* object) const {
  static const ContinuousFilter none;
  const auto entry = filters.find(object);
  return entry == filters.end() ? none : entry->second;
}

void ManagerScene::addThickness(bool with_pairs) {
  for (Object* object : objects)
    if (random_.index(2) == 0) {
      thickness[object] = random_.index(4) == 0 ? 0 : random_.uniform(0, .2);
      manager.setThickness(object, thickness[object]);
    }
  if (!with_pairs) return;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    Object *o1 = objects[random_.index(objects.size())],
           *o2 = objects[random_.index(objects.size())];
    const double distance = random_.index(3) == 0 ? 0 : random_.uniform(0, .5);
    manager.setPairDistance(o1, o2, distance);
    const std::pair<const Object*, const Object*> pair(std::min(o1, o2),
                                                       std::max(o1, o2));
    pair_distances[pair] = distance;
    if (random_.index(8) == 0) {
      manager.resetPairDistance(o2, o1);
      pair_distances.erase(pair);
    }
  }
}

double ManagerScene::distanceOf(const Object* o1, const Object* o2) const {
  const auto entry = pair_distances.find({std::min(o1, o2), std::max(o1, o2)});
  if (entry != pair_distances.end()) return entry->second;
  const auto of = [this](const Object* o) {
    const auto own = thickness.find(o);
    return own == thickness.end() ? 0 : own->second;
  };
  return of(o1) + of(o2);
}

TestMesh ManagerScene::clothFrame() {
  const Vector bend = random_.point(1);
  return makeSheet(4, 4, [&bend](double u, double v) {
    u -= .5;
    v -= .5;
    return Vector(u * (1 - std::abs(bend[2] * u)), v,
                  bend[0] * u * u + bend[1] * u * v + 3 * bend[2] * v * v * u);
  });
}

std::shared_ptr<MotionBase<double>> ManagerScene::randomMotion() {
  return randomObjectMotion(random_, size_, is_straight);
}

ManagerScene::Object* ManagerScene::make(bool is_cloth) {
  owned_.push_back(makeObject(
      is_cloth ? Geometry(cloth_) : randomGeometry(random_, flats_), randomMotion()));
  objects.push_back(owned_.back().get());
  return objects.back();
}

void ManagerScene::setFilter(Object* object) {
  if (!has_filters_ || random_.index(2) == 0) return;
  filters[object] = randomFilter(random_, *object);
  manager.setFilter(object, filters[object]);
}

}  // namespace test
}  // namespace fcl
