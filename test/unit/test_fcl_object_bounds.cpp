// SPDX-License-Identifier: BSD-3-Clause
//
// The moving boxes of objects contain them at all times, whatever the motion, and are
// tight where the path is straight. Objects that overlap at some time are box pairs. A
// plane or halfspace is bounded by itself.
#include "prepare/object_bounds.h"

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
#include "fcl/geometry/shape/halfspace.h"
#include "fcl/geometry/shape/plane.h"
#include "fcl/geometry/shape/sphere.h"
#include "fcl/geometry/shape/triangle_p.h"
#include "moving_objects.h"
#include "sanitizer.h"
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
  for (int i = 0; i < rounds(600); ++i) {
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
  EXPECT_GT(num_curved, rounds(100));
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
  for (int scene = 0; scene < rounds(20); ++scene) {
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
  EXPECT_GT(num_overlapping, rounds(300));
  // Few box pairs beyond.
  EXPECT_LT(num_box_pairs, 1.5 * num_overlapping);
}

/// A plane or a halfspace, and its normal and offset.
struct Flat {
  Geometry geometry;
  Vector normal;
  double offset;
  bool is_plane;
};

Flat randomFlat(Random& random) {
  Flat flat;
  flat.normal = random.point(1).normalized();
  flat.offset = random.uniform(-2, 2);
  flat.is_plane = random.index(2) == 0;
  if (flat.is_plane)
    flat.geometry = std::make_shared<Plane<double>>(flat.normal, flat.offset);
  else
    flat.geometry = std::make_shared<Halfspace<double>>(flat.normal, flat.offset);
  return flat;
}

/// How far the points of a body are from a flat at t, by the formulas of both motions.
double distanceAt(double t, const Flat& flat, const Path& path_flat, const Body& body,
                  const Path& path_body) {
  const RealPose pose_flat = path_flat.at(t), pose_body = path_body.at(t);
  const RealVector normal = pose_flat.rotation * flat.normal.cast<Real>(),
                   foot = pose_flat * Vector(flat.offset * flat.normal);
  Real lowest = HUGE_VAL, highest = -HUGE_VAL;
  for (std::size_t i = 0; i < body.begin.size(); ++i) {
    const RealVector p = pose_body * Vector((1 - t) * body.begin[i] + t * body.end[i]);
    const Real height = normal.dot(p - foot);
    lowest = std::min(lowest, height);
    highest = std::max(highest, height);
  }
  const Real above = flat.is_plane ? std::max(lowest, -highest) : lowest;
  return static_cast<double>(above);
}

TEST(ObjectBounds, FlatsMeetWhatComesNearThem) {
  Random random(3);
  std::vector<Body> bodies = makeMeshes();
  for (Body& body : makeShapes()) bodies.push_back(std::move(body));
  int num_near = 0, num_apart = 0, num_culled = 0;
  double longest = 0;
  for (int i = 0; i < rounds(1000); ++i) {
    SCOPED_TRACE(i);
    const Body& body = bodies[random.index(bodies.size())];
    const Flat flat = randomFlat(random);
    // Some are far from the origin.
    const double way = i % 10 == 0 ? 1e5 : 4;
    const Path path = randomPath(random, way), path_flat = randomPath(random, way);
    const double distance = i % 3 == 0 ? random.uniform(0, .5) : 0;
    BoundsList list;
    detail::appendBounds(movingGeometry(body, path), list);
    detail::appendBounds(movingGeometry({flat.geometry, {}, {}}, path_flat), list);
    const MovingBounds bounds = list.at(0), of_flat = list.at(1);
    ASSERT_TRUE(of_flat.flat);
    const MeetingWindow window = meetingWindow(bounds, of_flat, distance),
                        swapped = meetingWindow(of_flat, bounds, distance);
    ASSERT_EQ(window.isEmpty(), swapped.isEmpty());
    const bool may_meet =
        mayMeet(linearBox(bounds), *of_flat.flat, LinearQuery(distance, 1));
    constexpr int kSamples = 64;
    double first = 2, last = -1;
    for (int k = 0; k <= kSamples; ++k) {
      const double t = double(k) / kSamples;
      if (distanceAt(t, flat, path_flat, body, path) > distance) continue;
      first = std::min(first, t);
      last = t;
    }
    if (last < 0) {
      ++num_apart;
      num_culled += window.isEmpty();
      continue;
    }
    ++num_near;
    EXPECT_TRUE(may_meet);
    EXPECT_LE(window.lo, first);
    EXPECT_GE(window.hi, last);
    if (way < 5) longest = std::max(longest, first - window.lo);
  }
  EXPECT_GT(num_near, rounds(200));
  EXPECT_GT(num_apart, rounds(200));
  EXPECT_GT(num_culled, (kHasAddressSanitizer ? .8 : .9) * num_apart);
  EXPECT_LT(longest, 1);
}

// Tilted, turning or moving: the manager does not hand out what is far above a floor.
TEST(ObjectBounds, FloorsMeetNothingThatIsFarAbove) {
  const auto floor =
      std::make_shared<Halfspace<double>>(Vector(.1, 0, 1).normalized(), 0);
  const auto ball = std::make_shared<Sphere<double>>(.5);
  const auto turn = std::make_shared<InterpMotion<double>>(
      Matrix3<double>::Identity(), Vector::Zero(),
      AngleAxis<double>(.5, Vector::UnitX()).matrix(), Vector::Zero(), Vector::Zero());
  const std::vector<std::shared_ptr<MotionBase<double>>> motions = {
      translation(Vector::Zero(), Vector::Zero()),
      translation(Vector::Zero(), Vector(1, 2, 3)), turn};
  for (const auto& motion : motions) {
    ContinuousCollisionManager<double> manager;
    std::vector<std::unique_ptr<ContinuousCollisionObject<double>>> objects;
    objects.push_back(makeObject(floor, motion));
    for (int i = 0; i < 20; ++i)
      for (int k = 0; k < 20; ++k) {
        const Vector at(2 * i - 20, 2 * k - 20, 50);
        objects.push_back(makeObject(ball, translation(at, at + Vector(.1, .2, .3))));
      }
    objects.push_back(makeObject(ball, translation({0, 0, 50}, {0, 0, -1})));
    for (auto& object : objects) manager.registerObject(object.get());
    const ContinuousCollisionObject<double>* const of_interest[2] = {
        objects.front().get(), objects.back().get()};
    struct Seen {
      const ContinuousCollisionObject<double>* const (&of_interest)[2];
      int with_floor;
      bool is_met;
    } seen{of_interest, 0, false};
    ContinuousCollisionCallBack<double> callback =
        [](ContinuousCollisionObject<double>* o1, ContinuousCollisionObject<double>* o2,
           void* data) {
          Seen& all = *static_cast<Seen*>(data);
          all.with_floor += o1 == all.of_interest[0] || o2 == all.of_interest[0];
          all.is_met |= o1 == all.of_interest[0] && o2 == all.of_interest[1];
          return false;
        };
    manager.collide(&seen, callback);
    EXPECT_EQ(seen.with_floor, 1);
    EXPECT_TRUE(seen.is_met);
  }
}

// A window begins at most this much before the flat and the points meet.
TEST(ObjectBounds, FlatsAreTightOnStraightPaths) {
  Random random(4);
  const Body body{
      std::make_shared<Sphere<double>>(0), {Vector::Zero()}, {Vector::Zero()}};
  for (int i = 0; i < 100; ++i) {
    Flat flat = randomFlat(random);
    const Vector from = flat.normal * (flat.offset + 2), to = flat.normal * flat.offset;
    const auto straight = [&](const Vector& p, const Vector& q) {
      return Path{translation(p, q), {}};
    };
    BoundsList list;
    detail::appendBounds(movingGeometry(body, straight(from, to)), list);
    detail::appendBounds(
        movingGeometry({flat.geometry, {}, {}}, straight(Vector::Zero(), flat.normal)),
        list);
    EXPECT_EQ(list.at(1).flat->numSpans(), 1);
    const MeetingWindow window = meetingWindow(list.at(0), list.at(1), 0);
    EXPECT_NEAR(window.lo, 2. / 3, 1e-10);
    EXPECT_LE(window.lo, 2. / 3);
  }
}

}  // namespace
}  // namespace test
}  // namespace fcl
