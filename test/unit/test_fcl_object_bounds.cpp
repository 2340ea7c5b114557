// SPDX-License-Identifier: BSD-3-Clause
//
// The moving boxes of objects contain them at all times, whatever the motion, and are
// tight where the path is straight. Objects that overlap at some time are box pairs.
#include "api/object_bounds.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <vector>

#include "fcl/broadphase/continuous_collision_manager.h"
#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "fcl/geometry/shape/box.h"
#include "fcl/geometry/shape/capsule.h"
#include "fcl/geometry/shape/cone.h"
#include "fcl/geometry/shape/convex.h"
#include "fcl/geometry/shape/cylinder.h"
#include "fcl/geometry/shape/ellipsoid.h"
#include "fcl/geometry/shape/sphere.h"
#include "fcl/geometry/shape/triangle_p.h"
#include "moving_objects.h"
#include "test_models.h"

namespace fcl {
namespace test {
namespace {

using namespace fcl::detail::deformable;
using Vector = Vector3<double>;
using Points = std::vector<Vector>;
using Geometry = std::shared_ptr<CollisionGeometry<double>>;
using Deformable = DeformableBVHModel<KDOP<double, 16>>;

/// A geometry, and points of it at the beginning and at the end, in its frame.
struct Body {
  Geometry geometry;
  Points begin, end;
};

Body still(const Geometry& geometry, const TestMesh& mesh) {
  return {geometry, mesh.vertices, mesh.vertices};
}

std::vector<Body> makeMeshes() {
  const TestMesh brick = makeBox({.3, .1, .05}, 2);
  TestMesh bent = brick;
  for (auto& p : bent.vertices) p = 1.2 * p + Vector(.1, .5 * p[0] * p[0], .2);
  std::vector<Body> out;
  out.push_back(still(makeModel<BVHModel<OBBRSS<double>>>(brick), brick));
  out.push_back(still(makeModel<BVHModel<RSS<double>>>(brick), brick));
  out.push_back(still(makeModel<BVHModel<kIOS<double>>>(brick), brick));
  out.push_back(still(makeModel<BVHModel<KDOP<double, 24>>>(brick), brick));
  out.push_back({makeModel<Deformable>(brick, bent), brick.vertices, bent.vertices});
  out.push_back(
      {makeModel<BVHModel<OBBRSS<double>>>(brick, bent), brick.vertices, bent.vertices});
  return out;
}

std::vector<Body> makeShapes() {
  std::vector<Body> out;
  TestMesh ball = makeUvSphere(24, 12, .3), oval = ball,
           capsule = makeCapsule(24, 12, .1, .4);
  for (auto& p : oval.vertices) p = Vector(p[0], .5 * p[1], .2 * p[2]);
  for (auto& p : capsule.vertices) p[2] -= .2;
  out.push_back(still(std::make_shared<Sphere<double>>(.3), ball));
  out.push_back(still(std::make_shared<Ellipsoid<double>>(.3, .15, .06), oval));
  out.push_back(still(std::make_shared<Capsule<double>>(.1, .4), capsule));
  out.push_back(still(std::make_shared<Box<double>>(.6, .2, .1), makeBox({.3, .1, .05})));
  using Profile = std::vector<std::array<double, 2>>;
  const Profile cone{{0, .2}, {.1, -.2}, {0, -.2}},
      cylinder{{0, .2}, {.1, .2}, {.1, -.2}, {0, -.2}};
  out.push_back(still(std::make_shared<Cone<double>>(.1, .4), makeLathe(24, cone)));
  out.push_back(
      still(std::make_shared<Cylinder<double>>(.1, .4), makeLathe(24, cylinder)));
  const auto corners = std::make_shared<const Points>(
      Points{{1, 0, 0}, {1, .3, 0}, {1, 0, .3}, {1.2, .1, .1}});
  const auto faces = std::make_shared<const std::vector<int>>(
      std::vector<int>{3, 0, 2, 1, 3, 0, 1, 3, 3, 1, 2, 3, 3, 2, 0, 3});
  out.push_back(
      {std::make_shared<Convex<double>>(corners, 4, faces), *corners, *corners});
  const Points triangle{{1, 0, 0}, {1, .3, 0}, {1, 0, .3}};
  out.push_back(
      {std::make_shared<TriangleP<double>>(triangle[0], triangle[1], triangle[2]),
       triangle, triangle});
  return out;
}

/// A motion, and its pose by other formulas.
struct Path {
  std::shared_ptr<MotionBase<double>> motion;
  std::function<RealPose(double)> at;
};

Path randomPath(Random& random, double way) {
  const Vector from = random.point(way), velocity = random.point(1),
               bend = random.point(1);
  const auto straight = [](const Vector& p) {
    return RealPose{RealMatrix::Identity(), p.cast<Real>()};
  };
  switch (random.index(5)) {
    case 0:
      return {translation(from, from + velocity),
              [=](double t) { return straight(from + t * velocity); }};
    case 1:
      return {std::make_shared<BoundedThrow>(from, velocity, bend), [=](double t) {
                return straight(from + t * velocity + .5 * t * t * bend);
              }};
    default: {
      const ReferenceMotion motion = randomMotion(random, way);
      return {toFcl(motion), [motion](double t) { return motion.at(t); }};
    }
  }
}

/// The exact box of the points at t, as sides.
HalfAxisBox exactBox(const Body& body, const Path& path, double t) {
  const RealPose pose = path.at(t);
  HalfAxisBox box;
  std::fill(box.half, box.half + HalfAxisBox::kSides, -HUGE_VAL);
  for (std::size_t i = 0; i < body.begin.size(); ++i) {
    const RealVector p = pose * ((1 - t) * body.begin[i] + t * body.end[i]);
    for (int k = 0; k < 3; ++k) {
      box.half[k] = std::max(box.half[k], static_cast<double>(-p[k]));
      box.half[k + 3] = std::max(box.half[k + 3], static_cast<double>(p[k]));
    }
  }
  return box;
}

detail::MovingGeometry<double> movingGeometry(const Body& body, const Path& path) {
  return detail::movingGeometry(body.geometry.get(), path.motion.get(),
                                body.geometry.get());
}

double sideAt(const MovingBounds& bounds, int side, double t) {
  const double place = t * bounds.num_spans;
  const int i = std::min(static_cast<int>(place), bounds.num_spans - 1);
  return (1 - (place - i)) * bounds.boxes[i].half[side] +
         (place - i) * bounds.boxes[i + 1].half[side];
}

TEST(ObjectBounds, ContainTheObjectAtAllTimes) {
  Random random(1);
  std::vector<Body> bodies = makeMeshes();
  for (Body& body : makeShapes()) bodies.push_back(std::move(body));
  int num_curved = 0;
  double widest = 0;
  for (int i = 0; i < 600; ++i) {
    SCOPED_TRACE(i);
    const Body& body = bodies[random.index(bodies.size())];
    const Path path = randomPath(random, 1);
    BoundsList list;
    detail::appendBounds(movingGeometry(body, path), list);
    ASSERT_EQ(list.items.size(), 1u);
    const MovingBounds bounds = list.at(0);
    num_curved += bounds.num_spans > 1;
    for (int k = 0; k <= 64; ++k) {
      const double t = k / 64.;
      const HalfAxisBox exact = exactBox(body, path, t);
      for (int j = 0; j < HalfAxisBox::kSides; ++j) {
        EXPECT_GE(sideAt(bounds, j, t), exact.half[j]);
        widest = std::max(widest, sideAt(bounds, j, t) - exact.half[j]);
      }
    }
  }
  EXPECT_GT(num_curved, 100);
  // Objects have a radius of about 0.3, paths a length of up to 3.5.
  EXPECT_LT(widest, .7);
}

TEST(ObjectBounds, AreTightOnStraightPaths) {
  for (const Body& body : makeMeshes()) {
    // The bounds of a rigid mesh are FCL's root volume, which may be turned or round.
    const NODE_TYPE type = body.geometry->getNodeType();
    if (type == BV_kIOS || type == BV_RSS) continue;
    const bool is_turned = type == BV_OBBRSS && body.begin == body.end;
    const Vector from(1, 2, 3), to(2, 1, 5);
    const Path path{
        translation(from, to), [&](double t) {
          return RealPose{RealMatrix::Identity(), (from + t * (to - from)).cast<Real>()};
        }};
    BoundsList list;
    detail::appendBounds(movingGeometry(body, path), list);
    ASSERT_EQ(list.items[0].num_spans, 1);
    for (const double t : {0., 1.}) {
      const HalfAxisBox exact = exactBox(body, path, t);
      for (int j = 0; j < HalfAxisBox::kSides; ++j)
        EXPECT_NEAR(sideAt(list.at(0), j, t), exact.half[j], is_turned ? .02 : 1e-6);
    }
  }
}

TEST(ObjectBounds, NoObjectsThatOverlapAreMissed) {
  Random random(2);
  std::vector<Body> bodies = makeMeshes();
  for (Body& body : makeShapes()) bodies.push_back(std::move(body));
  int num_overlapping = 0, num_box_pairs = 0;
  for (int scene = 0; scene < 20; ++scene) {
    constexpr std::size_t kCount = 30;
    constexpr int kSamples = 64;
    std::vector<std::unique_ptr<ContinuousCollisionObject<double>>> objects;
    std::vector<std::vector<HalfAxisBox>> boxes;
    ContinuousCollisionManager<double> manager;
    for (std::size_t i = 0; i < kCount; ++i) {
      const Body& body = bodies[random.index(bodies.size())];
      const Path path = randomPath(random, 2);
      objects.push_back(makeObject(body.geometry, path.motion));
      manager.registerObject(objects.back().get());
      boxes.emplace_back();
      for (int k = 0; k <= kSamples; ++k)
        boxes.back().push_back(exactBox(body, path, double(k) / kSamples));
    }
    std::vector<std::vector<bool>> met(kCount, std::vector<bool>(kCount, false));
    std::vector<std::size_t> place(kCount);
    for (std::size_t i = 0; i < kCount; ++i) {
      place[i] = i;
      objects[i]->setUserData(&place[i]);
    }
    const auto callback = [](ContinuousCollisionObject<double>* o1,
                             ContinuousCollisionObject<double>* o2, void* cdata) {
      auto& seen = *static_cast<std::vector<std::vector<bool>>*>(cdata);
      const std::size_t i = *static_cast<std::size_t*>(o1->getUserData()),
                        k = *static_cast<std::size_t*>(o2->getUserData());
      EXPECT_LT(i, k);
      EXPECT_FALSE(seen[i][k]);
      seen[i][k] = true;
      return false;
    };
    ContinuousCollisionCallBack<double> function = callback;
    manager.collide(&met, function);
    for (std::size_t i = 0; i < kCount; ++i)
      for (std::size_t k = i + 1; k < kCount; ++k) {
        num_box_pairs += met[i][k];
        bool overlap = false;
        for (std::size_t s = 0; s <= kSamples && !overlap; ++s) {
          overlap = true;
          for (int j = 0; j < HalfAxisBox::kSides; ++j)
            overlap &=
                boxes[i][s].half[j] + boxes[k][s].half[HalfAxisBox::opposite(j)] >= 0;
        }
        if (!overlap) continue;
        ++num_overlapping;
        EXPECT_TRUE(met[i][k]) << scene << ": " << i << ", " << k;
      }
  }
  EXPECT_GT(num_overlapping, 300);
  // Few box pairs beyond.
  EXPECT_LT(num_box_pairs, 1.5 * num_overlapping);
}

}  // namespace
}  // namespace test
}  // namespace fcl
