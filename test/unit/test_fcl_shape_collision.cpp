// SPDX-License-Identifier: BSD-3-Clause
//
// Public queries of shapes, against closed forms; every way to ask.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

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
#include "fcl/math/bv/OBBRSS.h"
#include "fcl/math/motion/interp_motion.h"
#include "fcl/math/motion/screw_motion.h"
#include "fcl/math/motion/translation_motion.h"
#include "fcl/narrowphase/continuous_collision.h"
#include "sanitizer.h"
#include "test_models.h"

namespace fcl {
namespace test {
namespace {

using Point = Vector3<double>;
using Geometry = std::shared_ptr<CollisionGeometry<double>>;
using Pose = Transform3<double>;
using Request = ContinuousContactRequest<double>;
using Result = ContinuousContactResult<double>;

constexpr double kPi = 3.14159265358979323846;
constexpr double kTocErr = 1e-9;

Pose at(double x, double y, double z) {
  Pose pose = Pose::Identity();
  pose.translation() << x, y, z;
  return pose;
}

Pose turned(double angle, const Point& axis, Pose pose = Pose::Identity()) {
  pose.linear() = AngleAxis<double>(angle, axis).toRotationMatrix();
  return pose;
}

struct Moving {
  Geometry geometry;
  Pose begin, end;
};

Request requestOf(ContinuousQuery query = ContinuousQuery::kFirst) {
  Request request;
  request.query = query;
  request.toc_err = kTocErr;
  request.ccd_motion_type = CCDM_LINEAR;
  request.num_max_contacts = 100000;
  request.enable_contact = true;
  return request;
}

Result ask(const Moving& a, const Moving& b, const Request& request = requestOf()) {
  Result result;
  continuousCollide(a.geometry.get(), a.begin, a.end, b.geometry.get(), b.begin, b.end,
                    request, result);
  return result;
}

/// Expects the first contact at a time, whichever object comes first.
void expectFirst(const Moving& a, const Moving& b, double time) {
  const Result results[2] = {ask(a, b), ask(b, a)};
  for (const Result& result : results) {
    ASSERT_TRUE(result.is_collide);
    EXPECT_LE(result.time_of_contact, time + 1e-15);
    EXPECT_NEAR(result.time_of_contact, time, 1e-11);
    ASSERT_FALSE(result.contacts.empty());
    EXPECT_GE(result.contacts[0].toc_hi, result.contacts[0].toc_lo);
    EXPECT_LE(result.contacts[0].toc_hi, time + kTocErr);
  }
  EXPECT_NEAR(results[0].time_of_contact, results[1].time_of_contact, 1e-11);
  EXPECT_LT((results[0].contacts[0].normal + results[1].contacts[0].normal).norm(), 1e-6);
  // FCL's own request has the same time, up to rounding: it looks for nothing else.
  ContinuousCollisionRequest<double> own;
  own.ccd_motion_type = CCDM_LINEAR;
  own.toc_err = kTocErr;
  ContinuousCollisionResult<double> own_result;
  EXPECT_NEAR(continuousCollide(a.geometry.get(), a.begin, a.end, b.geometry.get(),
                                b.begin, b.end, own, own_result),
              time, 1e-11);
  EXPECT_TRUE(own_result.is_collide);
}

Geometry octahedron(double radius) {
  auto vertices = std::make_shared<std::vector<Point>>();
  for (int i = 0; i < 6; ++i) {
    Point p = Point::Zero();
    p[i / 2] = i % 2 == 1 ? radius : -radius;
    vertices->push_back(p);
  }
  const int corners[8][3] = {{1, 3, 5}, {3, 0, 5}, {0, 2, 5}, {2, 1, 5},
                             {3, 1, 4}, {0, 3, 4}, {2, 0, 4}, {1, 2, 4}};
  auto faces = std::make_shared<std::vector<int>>();
  for (const auto& face : corners) {
    faces->push_back(3);
    faces->insert(faces->end(), face, face + 3);
  }
  return std::make_shared<Convex<double>>(vertices, 8, faces);
}

/// A tetrahedron with a corner at each place.
Geometry tetrahedron(const Point (&corner)[4]) {
  auto vertices = std::make_shared<std::vector<Point>>(corner, corner + 4);
  auto faces = std::make_shared<std::vector<int>>(
      std::vector<int>{3, 0, 2, 1, 3, 0, 1, 3, 3, 0, 3, 2, 3, 1, 2, 3});
  return std::make_shared<Convex<double>>(vertices, 4, faces);
}

Geometry floorMesh() {
  const TestMesh sheet =
      makeSheet(8, 8, [](double u, double v) { return Point(4 * u - 2, 4 * v - 2, 0); });
  auto model = std::make_shared<BVHModel<OBBRSS<double>>>();
  model->beginModel();
  model->addSubModel(sheet.vertices, sheet.triangles);
  model->endModel();
  return model;
}

Geometry deformableFloor(double from, double to) {
  const auto frame = [](double z) {
    return makeSheet(8, 8,
                     [z](double u, double v) { return Point(4 * u - 2, 4 * v - 2, z); });
  };
  auto model = std::make_shared<DeformableBVHModel<>>();
  model->beginModel();
  model->addSubModel(frame(from).vertices, frame(from).triangles);
  model->endModel();
  const auto coordinates = [](const TestMesh& mesh) {
    return mesh.vertices.front().data();
  };
  const TestMesh frames[2] = {frame(from), frame(to)};
  model->updateFrames(coordinates(frames[0]), coordinates(frames[1]),
                      frames[0].vertices.size());
  return model;
}

/// Something that stands on z = 0 or reaches up to `top` on the z axis.
struct Target {
  std::string name;
  Geometry geometry;
  double top;
};

std::vector<Target> targets() {
  return {
      {"sphere", std::make_shared<Sphere<double>>(0.5), 0.5},
      {"capsule", std::make_shared<Capsule<double>>(0.25, 1.), 0.75},
      {"box", std::make_shared<Box<double>>(1., 2., 0.5), 0.25},
      {"ellipsoid", std::make_shared<Ellipsoid<double>>(0.5, 0.75, 0.375), 0.375},
      {"cone", std::make_shared<Cone<double>>(0.5, 1.), 0.5},
      {"cylinder", std::make_shared<Cylinder<double>>(0.5, 0.75), 0.375},
      {"convex", octahedron(0.5), 0.5},
      {"triangle",
       std::make_shared<TriangleP<double>>(Point(-1, -1, 0), Point(2, -1, 0),
                                           Point(-1, 2, 0)),
       0},
      {"plane", std::make_shared<Plane<double>>(Point(0, 0, 1), 0.25), 0.25},
      {"halfspace", std::make_shared<Halfspace<double>>(Point(0, 0, 1), 0.125), 0.125},
      {"mesh", floorMesh(), 0},
      {"cloth", deformableFloor(0, 0), 0}};
}

TEST(ShapeCollide, BallDropsOnEverything) {
  const double radius = 0.25;
  for (const Target& target : targets()) {
    SCOPED_TRACE(target.name);
    const Moving ball{std::make_shared<Sphere<double>>(radius), at(0, 0, 2),
                      at(0, 0, -2)};
    const Moving still{target.geometry, at(0, 0, 0), at(0, 0, 0)};
    expectFirst(ball, still, (2 - radius - target.top) / 4);
  }
}

TEST(ShapeCollide, TheNormalIsTheWayOfTheBall) {
  for (const Target& target : targets()) {
    SCOPED_TRACE(target.name);
    const Result result =
        ask({target.geometry, at(0, 0, 0), at(0, 0, 0)},
            {std::make_shared<Sphere<double>>(0.25), at(0, 0, 2), at(0, 0, -2)});
    ASSERT_FALSE(result.contacts.empty());
    EXPECT_LT((result.contacts[0].normal - Point(0, 0, 1)).norm(), 1e-6);
    EXPECT_LT((result.contacts[0].pos - Point(0, 0, target.top)).norm(), 1e-6);
  }
}

TEST(ShapeCollide, ScenesFarFromTheOrigin) {
  const double far = 0x1p20;
  for (const Target& target : targets()) {
    if (target.geometry->getObjectType() == OT_GEOM &&
        (target.name == "plane" || target.name == "halfspace"))
      continue;
    SCOPED_TRACE(target.name);
    const Result result =
        ask({std::make_shared<Sphere<double>>(0.25), at(far, far, 2), at(far, far, -2)},
            {target.geometry, at(far, far, 0), at(far, far, 0)});
    ASSERT_TRUE(result.is_collide);
    EXPECT_LE(result.time_of_contact, (1.75 - target.top) / 4);
    EXPECT_NEAR(result.time_of_contact, (1.75 - target.top) / 4, 1e-7);
  }
}

TEST(ShapeCollide, EveryPairThatPassesAboveDoesNotTouch) {
  // Around the z axis everything is within 2 of the origin.
  for (const Target& a : targets()) {
    if (a.name == "plane" || a.name == "halfspace") continue;
    for (const Target& b : targets()) {
      if (a.geometry->getObjectType() == OT_BVH && b.geometry->getObjectType() == OT_BVH)
        continue;
      SCOPED_TRACE(a.name + " over " + b.name);
      const Moving over{a.geometry, turned(0, Point(0, 1, 0), at(-3, 0, 4)),
                        turned(2, Point(0, 1, 0), at(3, 0, 4))};
      const Moving below{b.geometry, at(0, 0, 0), at(0, 0, 0)};
      EXPECT_FALSE(ask(over, below).is_collide);
      EXPECT_FALSE(ask(below, over).is_collide);
    }
  }
}

TEST(ShapeCollide, WhatIsInsideTouchesAtTheBeginning) {
  const Geometry ball = std::make_shared<Sphere<double>>(0.0625);
  for (const Target& target : targets()) {
    if (target.geometry->getObjectType() == OT_BVH || target.name == "triangle" ||
        target.name == "plane")
      continue;
    SCOPED_TRACE(target.name);
    for (const double still : {0., 0.125}) {
      const Result result = ask({ball, at(0, 0, 0), at(0, 0, still)},
                                {target.geometry, at(0, 0, 0), at(0, 0, 0)});
      ASSERT_TRUE(result.is_collide);
      EXPECT_EQ(result.time_of_contact, 0);
      ASSERT_EQ(result.contacts.size(), 1u);
      EXPECT_EQ(result.contacts[0].toc_hi, 0);
      EXPECT_EQ(result.contacts[0].kind, ContinuousContactKind::kShapes);
      EXPECT_FALSE(result.contacts[0].within_tolerance);
    }
  }
  // A surface has no inside.
  EXPECT_FALSE(ask({ball, at(0, 0, 1), at(0, 0, 1)},
                   {std::make_shared<Plane<double>>(Point(0, 0, 1), 0.5), at(0, 0, 0),
                    at(0, 0, 0)})
                   .is_collide);
}

// The middle of the box of a hull may be far outside of the hull.
TEST(ShapeCollide, HullsAroundWhoseBoxesMeetAreApart) {
  const Geometry low = tetrahedron({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}),
                 high = tetrahedron({{1, 1, 1}, {0, 1, 1}, {1, 0, 1}, {1, 1, 0}}),
                 triangle = std::make_shared<TriangleP<double>>(
                     Point(0, 0, 0), Point(1, 0, 0.5), Point(0, 1, 1)),
                 ball = std::make_shared<Sphere<double>>(0.1),
                 box = std::make_shared<Box<double>>(0.1, 0.1, 0.1);
  Pose middle = Pose::Identity();
  middle.translation() = Point(0.5, 0.5, 0.5);
  const Pose origin = Pose::Identity();
  const auto expectApart = [](const Geometry& a, const Pose& at_a, const Geometry& b,
                              const Pose& at_b) {
    ContinuousCollisionRequest<double> request;
    ContinuousCollisionResult<double> result;
    continuousCollide(a.get(), at_a, at_a, b.get(), at_b, at_b, request, result);
    EXPECT_FALSE(result.is_collide);
    continuousCollide(b.get(), at_b, at_b, a.get(), at_a, at_a, request, result);
    EXPECT_FALSE(result.is_collide);
  };
  expectApart(low, origin, high, origin);
  for (const Geometry& other : {ball, box}) {
    expectApart(low, origin, other, middle);
    expectApart(triangle, origin, other, middle);
  }
}

TEST(ShapeCollide, BoxTurnsOnItsEdge) {
  // The lowest point of a square of side 1 at an angle is (cos + sin) / 2 below its
  // center.
  const double height = 0.6, angle = kPi / 2,
               time = (kPi / 4 - std::acos(height * std::sqrt(2.))) / angle;
  const Moving box{std::make_shared<Box<double>>(1., 1., 1.),
                   turned(0, Point(1, 0, 0), at(0, 0, height)),
                   turned(angle, Point(1, 0, 0), at(0, 0, height))};
  for (const Geometry& floor :
       {Geometry(std::make_shared<Halfspace<double>>(Point(0, 0, 1), 0.)),
        Geometry(std::make_shared<Plane<double>>(Point(0, 0, 1), 0.)), floorMesh()})
    expectFirst(box, {floor, at(0, 0, 0), at(0, 0, 0)}, time);
}

TEST(ShapeCollide, AHalfspaceTurnsIntoABall) {
  // The distance of (2, 0, 1) from a plane through the origin, turned by an angle about
  // y, is cos - 2 sin.
  const double radius = 0.25, angle = -1,
               time = -(std::acos(radius / std::sqrt(5.)) - std::atan(2.)) / angle;
  const Moving ball{std::make_shared<Sphere<double>>(radius), at(2, 0, 1), at(2, 0, 1)};
  const Moving floor{std::make_shared<Halfspace<double>>(Point(0, 0, 1), 0.),
                     turned(0, Point(0, 1, 0)), turned(angle, Point(0, 1, 0))};
  expectFirst(ball, floor, time);
}

TEST(ShapeCollide, TipOfAConeOnAPlane) {
  const Moving cone{std::make_shared<Cone<double>>(0.5, 1.),
                    turned(kPi, Point(1, 0, 0), at(0, 0, 2)),
                    turned(kPi, Point(1, 0, 0), at(0, 0, 0))};
  expectFirst(
      cone,
      {std::make_shared<Plane<double>>(Point(0, 0, 1), 0.), at(0, 0, 0), at(0, 0, 0)},
      0.75);
}

TEST(ShapeCollide, ACapsuleSpinsIntoABall) {
  // The core, of half length 1, turns about y; the ball is where it has turned to 1 rad.
  const double radius = 0.125, ball = 0.0625, r = 0.75,
               time = (1 - std::asin((radius + ball) / r)) / 2;
  const Moving rod{std::make_shared<Capsule<double>>(radius, 2.),
                   turned(0, Point(0, 1, 0)), turned(2, Point(0, 1, 0))};
  const Pose place = at(r * std::sin(1), 0, r * std::cos(1));
  expectFirst(rod, {std::make_shared<Sphere<double>>(ball), place, place}, time);
}

TEST(ShapeCollide, ClothFallsOnABall) {
  const Moving cloth{deformableFloor(1, -1), at(0, 0, 0), at(0, 0, 0)};
  const Moving ball{std::make_shared<Sphere<double>>(0.25), at(0, 0, 0), at(0, 0, 0)};
  expectFirst(cloth, ball, 0.375);
}

TEST(ShapeCollide, AllContactsHaveOneForEachTriangle) {
  // The ball ends at z = 0 and reaches a circle of 0.5 in the plane of the sheet.
  const Moving floor{floorMesh(), at(0, 0, 0), at(0, 0, 0)};
  const Moving ball{std::make_shared<Sphere<double>>(0.5), at(0.125, 0, 1),
                    at(0.125, 0, 0)};
  const Result result = ask(floor, ball, requestOf(ContinuousQuery::kAll));
  std::set<std::intptr_t> triangles;
  for (std::size_t i = 0; i < result.contacts.size(); ++i) {
    const auto& contact = result.contacts[i];
    EXPECT_TRUE(triangles.insert(contact.b1).second);
    EXPECT_EQ(contact.b2, -1);
    EXPECT_TRUE(contact.first_on_o1);
    EXPECT_NEAR(contact.pos[2], 0, 1e-9);
    EXPECT_LE(result.contacts[i == 0 ? 0 : i - 1].toc_lo, contact.toc_lo);
    // At the time the ball reaches a circle around its axis.
    const double depth = 1 - contact.toc_lo, square = 0.25 - depth * depth;
    const Point from = contact.pos - Point(0.125, 0, 0);
    EXPECT_NEAR(from.head<2>().squaredNorm(), square, 1e-6);
    for (int k = 0; k < contact.numVertices(); ++k)
      EXPECT_GE(contact.vertices[static_cast<std::size_t>(k)], 0);
  }
  // By brute force: triangles whose nearest point to the axis is within 0.5.
  const TestMesh sheet =
      makeSheet(8, 8, [](double u, double v) { return Point(4 * u - 2, 4 * v - 2, 0); });
  std::size_t expected = 0;
  for (const Triangle& triangle : sheet.triangles) {
    const Geometry face = std::make_shared<TriangleP<double>>(
        sheet.vertices[triangle[0]], sheet.vertices[triangle[1]],
        sheet.vertices[triangle[2]]);
    expected += ask({face, at(0, 0, 0), at(0, 0, 0)}, ball).is_collide ? 1 : 0;
  }
  EXPECT_GT(expected, 8u);
  EXPECT_EQ(result.contacts.size(), expected);
}

// Of any contact it is only asked whether there is one. What is given is the first
// contact of its triangle, as in the list of all.
TEST(ShapeCollide, AnyContactIsInTheList) {
  const Geometry mesh = makeModel<BVHModel<OBBRSS<double>>>(makeIcosphere(4, .5));
  const Geometry shapes[] = {std::make_shared<Box<double>>(.8, .1, .1),
                             std::make_shared<Capsule<double>>(.1, .6),
                             std::make_shared<Cone<double>>(.3, .5),
                             std::make_shared<Halfspace<double>>(0, 0, 1, -.4)};
  Random random(3);
  int contacts = 0, later = 0, apart = 0;
  for (int i = 0; i < rounds(160); ++i) {
    SCOPED_TRACE(i);
    const auto place = [&random](double size) {
      Pose pose = turned(3 * random.uniform(0, 1), random.point(1).normalized());
      pose.translation() = random.point(size);
      return pose;
    };
    const Moving ball{mesh, place(.8), place(.8)},
        shape{shapes[i % 4], place(.4), place(.4)};
    Request any = requestOf(ContinuousQuery::kAny);
    any.min_distance = i % 3 == 0 ? .05 : 0;
    any.ignore_initially_closer = i % 6 == 0;
    Request all = any, first = any;
    all.query = ContinuousQuery::kAll;
    first.query = ContinuousQuery::kFirst;
    const Result found = ask(ball, shape, any), list = ask(ball, shape, all),
                 earliest = ask(ball, shape, first);
    ASSERT_EQ(found.is_collide, earliest.is_collide);
    ASSERT_EQ(found.contacts.size(), found.is_collide ? 1U : 0U);
    apart += !found.is_collide;
    if (!found.is_collide) continue;
    ++contacts;
    const auto& contact = found.contacts[0];
    EXPECT_EQ(found.time_of_contact, contact.toc_lo);
    EXPECT_LE(earliest.time_of_contact, contact.toc_lo + kTocErr);
    later += contact.toc_lo > earliest.time_of_contact + 1e-6;
    const auto of_list =
        std::find_if(list.contacts.begin(), list.contacts.end(),
                     [&](const auto& other) { return other.b1 == contact.b1; });
    ASSERT_NE(of_list, list.contacts.end());
    EXPECT_NEAR(of_list->toc_lo, contact.toc_lo, 2 * kTocErr);
  }
  EXPECT_GE(contacts + 1, rounds(64));
  EXPECT_GE(apart + 1, rounds(10));
  EXPECT_GE(later + 1, rounds(20));
}

TEST(ShapeCollide, KindsOfContacts) {
  const Moving floor{floorMesh(), at(0, 0, 0), at(0, 0, 0)};
  const Geometry ball = std::make_shared<Sphere<double>>(0.0625);
  const auto kindAt = [&](double x, double y) {
    const Result result = ask(floor, {ball, at(x, y, 1), at(x, y, -1)});
    return result.contacts.at(0).kind;
  };
  EXPECT_EQ(kindAt(0, 0), ContinuousContactKind::kVertexShape);
  EXPECT_EQ(kindAt(0.25, 0), ContinuousContactKind::kEdgeShape);
  EXPECT_EQ(kindAt(0.375, 0.25), ContinuousContactKind::kFaceShape);
}

TEST(ShapeCollide, MinDistance) {
  Request request = requestOf();
  request.min_distance = 0.25;
  for (const Target& target : targets()) {
    SCOPED_TRACE(target.name);
    const Result result =
        ask({std::make_shared<Sphere<double>>(0.25), at(0, 0, 2), at(0, 0, -2)},
            {target.geometry, at(0, 0, 0), at(0, 0, 0)}, request);
    ASSERT_TRUE(result.is_collide);
    EXPECT_LE(result.time_of_contact, (1.5 - target.top) / 4 + 1e-15);
    EXPECT_NEAR(result.time_of_contact, (1.5 - target.top) / 4, 1e-11);
  }
}

TEST(ShapeCollide, MinDistanceOfAMeshThatTurns) {
  // As in BoxTurnsOnItsEdge.
  const double height = 0.7, distance = 0.0625, angle = kPi / 2,
               time = (kPi / 4 - std::acos((height - distance) * std::sqrt(2.))) / angle;
  const TestMesh cube = makeBox({0.5, 0.5, 0.5});
  auto model = std::make_shared<BVHModel<OBBRSS<double>>>();
  model->beginModel();
  model->addSubModel(cube.vertices, cube.triangles);
  model->endModel();
  Request request = requestOf();
  request.min_distance = distance;
  const Moving box{model, turned(0, Point(1, 0, 0), at(0, 0, height)),
                   turned(angle, Point(1, 0, 0), at(0, 0, height))};
  const Geometry floor = std::make_shared<Halfspace<double>>(Point(0, 0, 1), 0.);
  const Result result = ask(box, {floor, at(0, 0, 0), at(0, 0, 0)}, request);
  ASSERT_TRUE(result.is_collide);
  EXPECT_LE(result.time_of_contact, time + 1e-15);
  EXPECT_NEAR(result.time_of_contact, time, 1e-11);
  EXPECT_NEAR(result.contacts.at(0).pos[2], 0.5 * distance, 1e-9);
}

// Boxes and flats in matrices that are rotations up to a few digits, and make all lengths
// smaller or larger. The distance is that in the world. The other box goes down by 4
// units of the scale.
TEST(ShapeCollide, MinDistanceWithInexactRotations) {
  const TestMesh cube = makeBox({1, 1, 1});
  auto mesh = std::make_shared<BVHModel<OBBRSS<double>>>();
  mesh->beginModel();
  mesh->addSubModel(cube.vertices, cube.triangles);
  mesh->endModel();
  const Geometry box = std::make_shared<Box<double>>(2, 2, 2),
                 plane = std::make_shared<Plane<double>>(Point(0, 0, 1), 1.),
                 halfspace = std::make_shared<Halfspace<double>>(Point(0, 0, 1), 1.);
  for (const double scale : {0.9997, 1.0004}) {
    const auto scaled = [scale](double z, double turn) {
      Pose pose = turned(turn, Point(0, 0, 1), at(0, 0, scale * z));
      pose.linear() *= scale;
      return pose;
    };
    for (const double distance : {0., 0.4})
      for (const double turn : {0., 1.})
        for (const Geometry& above : {box, Geometry(mesh)})
          for (const Geometry& below : {box, plane, halfspace}) {
            SCOPED_TRACE(testing::Message() << scale << " " << distance << " " << turn);
            Request request = requestOf();
            request.min_distance = scale * distance;
            const Moving a{above, scaled(5, 0), scaled(1, 0)},
                b{below, scaled(0, 0), scaled(0, turn)};
            const double time = (3 - distance) / 4;
            // The normal of a flat that turns may have grown by as much as the matrix is
            // no rotation.
            const double early = below != box && turn > 0 ? distance * 0x1p-10 : 0;
            for (const Result& result : {ask(a, b, request), ask(b, a, request)}) {
              ASSERT_TRUE(result.is_collide);
              EXPECT_LE(result.time_of_contact, time + 1e-15);
              EXPECT_NEAR(result.time_of_contact, time, early + 1e-11);
            }
          }
  }
}

TEST(ShapeCollide, ParallelFlatsWithInexactRotations) {
  const Geometry plane = std::make_shared<Plane<double>>(Point(0, 0, 1), 1.),
                 halfspace = std::make_shared<Halfspace<double>>(Point(0, 0, 1), 1.);
  for (const double scale : {0.9997, 1.0004})
    for (const double distance : {0., 0.4})
      for (const Geometry& below : {plane, halfspace}) {
        SCOPED_TRACE(testing::Message() << scale << " " << distance);
        const auto scaled = [scale](double z) {
          Pose pose = at(0, 0, scale * z);
          pose.linear() *= scale;
          return pose;
        };
        Request request = requestOf();
        request.min_distance = scale * distance;
        const Result result =
            ask({plane, scaled(5), scaled(-1)}, {below, scaled(0), scaled(0)}, request);
        ASSERT_TRUE(result.is_collide);
        EXPECT_LE(result.time_of_contact, (5 - distance) / 6 + 1e-15);
        EXPECT_NEAR(result.time_of_contact, (5 - distance) / 6, 1e-11);
        EXPECT_NEAR(result.contacts.at(0).normal[2], -1, 1e-12);
      }
}

TEST(ShapeCollide, TMaxCutsAtTheTime) {
  const Moving ball{std::make_shared<Sphere<double>>(0.25), at(0, 0, 2), at(0, 0, -2)};
  const Moving floor{floorMesh(), at(0, 0, 0), at(0, 0, 0)};
  Request request = requestOf();
  request.t_max = 0.4375 - 1e-9;
  EXPECT_FALSE(ask(ball, floor, request).is_collide);
  request.t_max = 0.4375;
  EXPECT_TRUE(ask(ball, floor, request).is_collide);
}

TEST(ShapeCollide, FiltersSeeNoTriangleOfAShape) {
  const Moving ball{std::make_shared<Sphere<double>>(0.25), at(0, 0, 2), at(0, 0, -2)};
  const Moving floor{floorMesh(), at(0, 0, 0), at(0, 0, 0)};
  Request request = requestOf(ContinuousQuery::kAll);
  request.accepts_triangles = [](std::intptr_t a, std::intptr_t b) {
    EXPECT_EQ(a, -1);
    return b % 2 == 0;
  };
  const Result result = ask(ball, floor, request);
  EXPECT_FALSE(result.contacts.empty());
  for (const auto& contact : result.contacts) EXPECT_EQ(contact.b2 % 2, 0);
  request.accepts_triangles = nullptr;
  request.filter1.group = 2;
  request.filter2.mask = 1;
  EXPECT_FALSE(ask(ball, floor, request).is_collide);
}

TEST(ShapeCollide, ParallelFlats) {
  const auto plane = [](double d) -> Geometry {
    return std::make_shared<Plane<double>>(Point(0, 0, 1), d);
  };
  const auto below = [](double d) -> Geometry {
    return std::make_shared<Halfspace<double>>(Point(0, 0, 1), d);
  };
  const auto above = [](double d) -> Geometry {
    return std::make_shared<Halfspace<double>>(Point(0, 0, -1), -d);
  };
  const Pose still = at(0, 0, 0), down = at(0, 0, -2), up = at(0, 0, 2);
  expectFirst({plane(1), still, down}, {plane(0), still, still}, 0.5);
  expectFirst({plane(-1), still, up}, {plane(0), still, still}, 0.5);
  expectFirst({plane(1), still, down}, {below(0), still, still}, 0.5);
  expectFirst({plane(-1), still, up}, {above(0), still, still}, 0.5);
  expectFirst({above(1), still, down}, {below(0), still, still}, 0.5);
  EXPECT_EQ(ask({below(1), still, up}, {below(-5), still, still}).time_of_contact, 0);
  EXPECT_EQ(ask({plane(-1), still, up}, {below(0), still, still}).time_of_contact, 0);
  EXPECT_FALSE(ask({plane(1), still, up}, {plane(0), still, still}).is_collide);
  // Others meet at once.
  EXPECT_EQ(ask({plane(5), still, still},
                {plane(0), turned(0.1, Point(1, 0, 0)), turned(0.1, Point(1, 0, 0))})
                .time_of_contact,
            0);
}

TEST(ShapeCollide, ShapesWithoutExtent) {
  const Moving floor{floorMesh(), at(0, 0, 0), at(0, 0, 0)};
  const std::vector<Geometry> points = {std::make_shared<Sphere<double>>(0.),
                                        std::make_shared<Capsule<double>>(0., 0.),
                                        std::make_shared<Box<double>>(0., 0., 0.),
                                        std::make_shared<Cone<double>>(0., 0.),
                                        std::make_shared<Cylinder<double>>(0., 0.),
                                        std::make_shared<Ellipsoid<double>>(0., 0., 0.)};
  for (const Geometry& point : points)
    expectFirst({point, at(0.3, 0.1, 1), at(0.3, 0.1, -1)}, floor, 0.5);
  const std::vector<Geometry> flat = {std::make_shared<Box<double>>(1., 1., 0.),
                                      std::make_shared<Cylinder<double>>(1., 0.),
                                      std::make_shared<Cone<double>>(1., 0.),
                                      std::make_shared<Ellipsoid<double>>(1., 1., 0.),
                                      std::make_shared<Capsule<double>>(0., 1.)};
  for (std::size_t i = 0; i < flat.size(); ++i) {
    SCOPED_TRACE(i);
    const double half = i == 4 ? 0.5 : 0;
    expectFirst({flat[i], at(0.3, 0.1, 1), at(0.3, 0.1, -1)}, floor, 0.5 * (1 - half));
  }
}

// What doc/choosing.md says about tiny scenes.
TEST(ShapeCollide, TinyScenes) {
  for (const double size : {1e-60, 1e-75, 1e-90, 1e-150, 1e-200}) {
    SCOPED_TRACE(size);
    TestMesh sheet = makeSheet(
        4, 4, [](double u, double v) { return Point(4 * u - 2, 4 * v - 2, 0); });
    for (Point& p : sheet.vertices) p *= size;
    auto mesh = std::make_shared<BVHModel<OBBRSS<double>>>();
    mesh->beginModel();
    mesh->addSubModel(sheet.vertices, sheet.triangles);
    mesh->endModel();
    const std::vector<Target> tiny = {
        {"sphere", std::make_shared<Sphere<double>>(0.5 * size), 0.5},
        {"box", std::make_shared<Box<double>>(size, 2 * size, 0.5 * size), 0.25},
        {"ellipsoid",
         std::make_shared<Ellipsoid<double>>(0.5 * size, 0.75 * size, 0.375 * size),
         0.375},
        {"cone", std::make_shared<Cone<double>>(0.5 * size, size), 0.5},
        {"convex", octahedron(0.5 * size), 0.5},
        {"plane", std::make_shared<Plane<double>>(Point(0, 0, 1), 0.25 * size), 0.25},
        {"mesh", mesh, 0}};
    for (const Target& target : tiny) {
      SCOPED_TRACE(target.name);
      const auto fall = [&] {
        return ask({std::make_shared<Sphere<double>>(0.25 * size), at(0, 0, 2 * size),
                    at(0, 0, -2 * size)},
                   {target.geometry, at(0, 0, 0), at(0, 0, 0)});
      };
      if (size < 0x1p-500 && target.geometry == mesh) {
        expectRefused(fall, "below 2^-500");
        continue;
      }
      const Result result = fall();
      const double time = (2 - 0.25 - target.top) / 4;
      EXPECT_TRUE(result.is_collide);
      EXPECT_LE(result.time_of_contact, time + 1e-15);
      if (size >= 1e-75) {
        EXPECT_NEAR(result.time_of_contact, time, 1e-11);
      }
    }
  }
}

TEST(ShapeCollide, GrazingBallAndEdge) {
  // The ball passes at a height of its radius plus or minus a part of it.
  const double radius = 0.5;
  for (const double part : {1e-2, 1e-4, 1e-6}) {
    const Geometry bar = std::make_shared<Cylinder<double>>(0.25, 4.);
    for (const double side : {-1., 1.}) {
      const double height = radius + 0.25 + side * part;
      const Result result = ask(
          {std::make_shared<Sphere<double>>(radius), at(-2, height, 0), at(2, height, 0)},
          {bar, at(0, 0, 0), at(0, 0, 0)});
      ASSERT_EQ(result.is_collide, side < 0);
      if (side > 0) continue;
      const double x = std::sqrt(0.75 * 0.75 - height * height);
      EXPECT_LE(result.time_of_contact, (2 - x) / 4 + 1e-15);
      EXPECT_NEAR(result.time_of_contact, (2 - x) / 4, 1e-8);
    }
  }
}

TEST(ShapeCollide, MotionsAndObjects) {
  const Geometry ball = std::make_shared<Sphere<double>>(0.25), floor = floorMesh();
  const auto still =
      std::make_shared<TranslationMotion<double>>(at(0, 0, 0), at(0, 0, 0));
  const auto fall =
      std::make_shared<TranslationMotion<double>>(at(0, 0, 2), at(0, 0, -2));
  const ScrewMotion<double> screw(at(0, 0, 2), turned(1, Point(0, 0, 1), at(0, 0, -2)));
  ContinuousCollisionRequest<double> request;
  ContinuousCollisionResult<double> result;
  EXPECT_NEAR(continuousCollide(ball.get(), fall.get(), floor.get(), still.get(), request,
                                result),
              0.4375, 1e-12);
  EXPECT_NEAR(
      continuousCollide(ball.get(), &screw, floor.get(), still.get(), request, result),
      0.4375, 1e-12);
  const ContinuousCollisionObject<double> moving(ball, fall), resting(floor, still);
  EXPECT_NEAR(collide(&moving, &resting, request, result), 0.4375, 1e-12);
  const CollisionObject<double> object1(ball, at(0, 0, 2)), object2(floor, at(0, 0, 0));
  EXPECT_NEAR(
      continuousCollide(&object1, at(0, 0, -2), &object2, at(0, 0, 0), request, result),
      0.4375, 1e-12);
  // FCL's solvers are not asked.
  for (const CCDSolverType solver : {CCDC_NAIVE, CCDC_CONSERVATIVE_ADVANCEMENT,
                                     CCDC_RAY_SHOOTING, CCDC_POLYNOMIAL_SOLVER}) {
    request.ccd_solver_type = solver;
    EXPECT_NEAR(continuousCollide(ball.get(), at(0, 0, 2), at(0, 0, -2), floor.get(),
                                  at(0, 0, 0), at(0, 0, 0), request, result),
                0.4375, 1e-12);
  }
}

TEST(ShapeCollide, TheDefaultMotionKeepsTheEndRotation) {
  // A rod that turns by a quarter passes the ball; translated only it would not.
  ContinuousCollisionRequest<double> request;
  ContinuousCollisionResult<double> result;
  const Capsule<double> rod(0.125, 2);
  const Sphere<double> ball(0.125);
  continuousCollide(&rod, Pose::Identity(), turned(kPi / 2, Point(0, 1, 0)), &ball,
                    at(0.6, 0, 0.6), at(0.6, 0, 0.6), request, result);
  EXPECT_TRUE(result.is_collide);
}

TEST(ShapeCollide, InFloat) {
  const Sphere<float> ball(0.25F);
  const Box<float> box(1.F, 1.F, 0.5F);
  Transform3<float> begin = Transform3<float>::Identity(), end = begin;
  const Transform3<float> still = begin;
  begin.translation() << 0, 0, 2;
  end.translation() << 0, 0, -2;
  ContinuousCollisionRequest<float> request;
  ContinuousCollisionResult<float> result;
  const float time =
      continuousCollide(&ball, begin, end, &box, still, still, request, result);
  EXPECT_LE(time, 0.375F);
  EXPECT_NEAR(time, 0.375F, 1e-6F);
}

TEST(ShapeCollide, ASlowTurnOfALargeBoxThatIsFast) {
  // In nanometres: the turn is lost beside the speed if one is taken from their sum.
  const double angle = 0.9e-6, way = 1e10, gap = 5e3;
  const Moving box{std::make_shared<Box<double>>(8e10, 8e10, 2e9), at(0, 0, 0),
                   turned(-angle, Point(0, 1, 0), at(-way, 0, 0))};
  const Pose place = at(0, 0, 2e9 + gap);
  const Result result = ask(box, {std::make_shared<Sphere<double>>(1e9), place, place});
  // Over the origin the upper side is at 1e9 - x sin(t angle) for the center's x, -t way.
  const double time = std::sqrt(gap / (way * angle));
  ASSERT_TRUE(result.is_collide);
  EXPECT_LE(result.time_of_contact, time + 1e-6);
  EXPECT_NEAR(result.time_of_contact, time, 1e-4);
}

TEST(ShapeCollide, APointBesideAMeshThatTurns) {
  const TestMesh cube = makeBox({1, 1, 1});
  auto model = std::make_shared<BVHModel<OBBRSS<double>>>();
  model->beginModel();
  model->addSubModel(cube.vertices, cube.triangles);
  model->endModel();
  const Moving turning{model, at(0, 0, 0), turned(2, Point(0, 0, 1))};
  const Pose inside = at(0.3, 0, 0.1), hit = at(1.2, 0.1, 0.1);
  for (const double radius : {0., 1e-9}) {
    const Geometry point = std::make_shared<Sphere<double>>(radius);
    EXPECT_FALSE(ask(turning, {point, inside, inside}).is_collide);
    EXPECT_TRUE(ask(turning, {point, hit, hit}).is_collide);
  }
}

TEST(ShapeCollide, AnInterpMotionAboutAPointOutsideOfABall) {
  const Sphere<double> ball(1);
  const InterpMotion<double> moving(Matrix3<double>::Identity(), Point::Zero(),
                                    turned(1, Point(0, 0, 1)).linear(), Point::Zero(),
                                    Point(0.5, 0, 0)),
      still(Matrix3<double>::Identity(), Point(5, 0, 0), Matrix3<double>::Identity(),
            Point(5, 0, 0), Point::Zero());
  ContinuousCollisionResult<double> result;
  continuousCollide(&ball, &moving, &ball, &still, ContinuousCollisionRequest<double>(),
                    result);
  EXPECT_FALSE(result.is_collide);
}

TEST(ShapeCollide, PlanesFarFromTheOriginAreNotMissed) {
  const auto plane = std::make_shared<Plane<double>>(Point(0, 0, 1), 0.);
  const auto scaled = std::make_shared<Plane<double>>(Point(0, 0, 1), 0.);
  scaled->n = Point(0, 0, 49);
  const double far = 1e6;
  Request request = requestOf();
  for (const double end : {far, far - 1}) {
    const Result result = ask({plane, at(0, 0, far + 1), at(0, 0, end)},
                              {scaled, at(0, 0, far), at(0, 0, far)}, request);
    ASSERT_TRUE(result.is_collide);
    const double time = 1 / (far + 1 - end);
    EXPECT_LE(result.time_of_contact, time);
    EXPECT_NEAR(result.time_of_contact, time, 1e-7);
  }
  request.accepts_triangles = [](std::intptr_t, std::intptr_t) { return false; };
  EXPECT_FALSE(
      ask({plane, at(0, 0, 1), at(0, 0, -1)}, {scaled, at(0, 0, 0), at(0, 0, 0)}, request)
          .is_collide);
}

TEST(ShapeCollide, PositionsOfFlatContactsAreOnBothObjects) {
  // A capsule that lies on a box within its radius, turned at random: the differences of
  // their points are coplanar.
  Random random(1);
  for (int i = 0; i < 20000; ++i) {
    const Pose tilt = turned(random.uniform(0, 3), random.point(1).normalized());
    const double height = random.uniform(0.55, 0.74);
    const Pose on_top = tilt * at(random.uniform(-0.4, 0.4), 0, height) *
                        turned(random.uniform(0, 3), Point(0, 0, 1)) *
                        turned(kPi / 2, Point(0, 1, 0));
    const Result result =
        ask({std::make_shared<Box<double>>(2., 2., 1.), tilt, tilt},
            {std::make_shared<Capsule<double>>(0.25, 1.), on_top, on_top});
    ASSERT_TRUE(result.is_collide);
    const Point local = tilt.inverse() * result.contacts.at(0).pos;
    ASSERT_LT(local.head<2>().norm(), 1);
    ASSERT_LE(local[2], 0.5 + 1e-12);
    ASSERT_GE(local[2], height - 0.25 - 1e-12);
  }
}

TEST(ShapeCollide, BadInputHasAClearError) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const auto messageOf = [](const Geometry& geometry, const Pose& end) -> std::string {
    try {
      ask({geometry, at(0, 0, 0), end},
          {std::make_shared<Sphere<double>>(1.), at(0, 0, 0), at(0, 0, 0)});
    } catch (const Exception& error) {
      return error.what();
    }
    return "";
  };
  const Pose still = at(0, 0, 0);
  const std::vector<std::pair<Geometry, std::string>> bad = {
      {std::make_shared<Sphere<double>>(-1.), "radius of the sphere"},
      {std::make_shared<Box<double>>(1., kNan, 1.), "side of the box"},
      {std::make_shared<Capsule<double>>(1., -1.), "length of the capsule"},
      {std::make_shared<Cone<double>>(kNan, 1.), "radius of the cone"},
      {std::make_shared<Cylinder<double>>(1., -2.), "height of the cylinder"},
      {std::make_shared<Ellipsoid<double>>(1., 1., kNan), "radius of the ellipsoid"},
      {std::make_shared<TriangleP<double>>(Point(kNan, 0, 0), Point(1, 0, 0),
                                           Point(0, 1, 0)),
       "triangle"}};
  for (const auto& [geometry, words] : bad) {
    const std::string message = messageOf(geometry, still);
    EXPECT_NE(message.find("o1: "), std::string::npos) << message;
    EXPECT_NE(message.find(words), std::string::npos) << message;
  }
  EXPECT_NE(messageOf(std::make_shared<Sphere<double>>(1.), at(kNan, 0, 0)), "");
}

TEST(ShapeCollide, WhatIsWrongIsToldInOneOrder) {
  const Pose still = at(0, 0, 0);
  const Sphere<double> wrong(-1), right(1);
  const Halfspace<double> flat(Point::UnitZ(), 0);
  const auto messageOf = [&still](const auto& o1, const auto& o2, auto request) {
    request.toc_err = -1;
    try {
      std::conditional_t<std::is_same_v<decltype(request), Request>, Result,
                         ContinuousCollisionResult<double>>
          result;
      continuousCollide(&o1, still, still, &o2, still, still, request, result);
    } catch (const Exception& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  const ContinuousCollisionRequest<double> plain;
  const Request with_contacts;
  EXPECT_NE(messageOf(wrong, right, plain).find("toc_err"), std::string::npos);
  EXPECT_EQ(messageOf(wrong, right, plain), messageOf(wrong, right, with_contacts));
  EXPECT_EQ(messageOf(right, right, plain), messageOf(right, right, with_contacts));
  EXPECT_EQ(messageOf(flat, right, plain), messageOf(flat, right, with_contacts));
}

// Also where the look at t = 0 would find that they overlap.
TEST(ShapeCollide, ARequestWithoutContactsRefusesTransforms) {
  Pose twice = at(0, 0, 0);
  twice.linear() *= 2;
  const Sphere<double> ball(1);
  for (const Pose& begin : {at(0, 0, 0), twice}) {
    ContinuousCollisionResult<double> result;
    EXPECT_THROW(continuousCollide(&ball, begin, twice, &ball, at(0, 0, 0), at(0, 0, 0),
                                   ContinuousCollisionRequest<double>(), result),
                 Exception);
  }
}

// Matrices that are rotations up to a few digits, the axis and angle of which are none.
TEST(ShapeCollide, TheNormalOfAFlatGrowsWithoutATurn) {
  const auto posed = [](double scale) {
    Pose pose = at(0, 0, 0);
    pose.linear() *= scale;
    return pose;
  };
  const Geometry floor = std::make_shared<Halfspace<double>>(Point(0, 0, 1), 0.),
                 ball = std::make_shared<Sphere<double>>(1.);
  for (const double scale : {1.0004, 0.9996}) {
    const Moving flat{floor, posed(1), posed(scale)};
    const Result touching = ask(flat, {ball, at(0, 0, 1.01), at(0, 0, 0.9998)});
    EXPECT_TRUE(touching.is_collide) << scale;
    EXPECT_LE(touching.time_of_contact, 0.01 / 0.0102) << scale;
    EXPECT_FALSE(ask(flat, {ball, at(0, 0, 1.01), at(0, 0, 1.002)}).is_collide) << scale;
  }
}

TEST(ShapeCollide, WhoPartsFromATurningFlatIsIgnored) {
  Pose typed = at(0, 0, 0);
  typed.linear() << 0.707, 0, 0.707, 0, 1, 0, -0.707, 0, 0.707;
  const Geometry floor = std::make_shared<Halfspace<double>>(Point(0, 0, 1), 0.),
                 ball = std::make_shared<Sphere<double>>(1.);
  Request request = requestOf();
  request.min_distance = 1;
  const Pose begin = at(1.2, 0, 1.2), end = at(0, 0, 9);  // 0.7 from the floor at t = 0
  EXPECT_TRUE(ask({floor, typed, at(0, 0, 0)}, {ball, begin, end}, request).is_collide);
  request.ignore_initially_closer = true;
  EXPECT_FALSE(ask({floor, typed, at(0, 0, 0)}, {ball, begin, end}, request).is_collide);
}

// A halfspace in such a pose missed contacts, and the radius of a sphere did not scale.
TEST(ShapeCollide, TransformsThatAreNoRotations) {
  const auto posed = [](const Matrix3<double>& m, double z) {
    Pose pose = at(0, 0, z);
    pose.linear() = m;
    return pose;
  };
  Matrix3<double> shear = Matrix3<double>::Identity();
  shear(2, 0) = 0.5;
  const Matrix3<double> one = Matrix3<double>::Identity(),
                        mirror = Point(1, 1, -1).asDiagonal(),
                        flat = Point(1, 1, 0).asDiagonal();
  const Geometry floor = std::make_shared<Halfspace<double>>(Point(0, 0, 1), 0.);
  const auto messageOf = [&](const Geometry& o, const Pose& begin, const Pose& end) {
    try {
      ask({o, begin, end}, {floor, at(0, 0, 0), at(0, 0, 0)});
    } catch (const Exception& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  const Geometry shapes[] = {std::make_shared<Sphere<double>>(1.),
                             std::make_shared<Box<double>>(1., 1., 1.),
                             std::make_shared<Halfspace<double>>(Point(0, 0, -1), 0.),
                             std::make_shared<Plane<double>>(Point(0, 0, 1), 0.)};
  for (const Geometry& shape : shapes)
    for (const Matrix3<double>& m : {Matrix3<double>(2 * one), mirror, shear, flat})
      for (const Matrix3<double>& other : {m, one}) {
        const std::string wanted = "a transform scales, mirrors or shears";
        for (const std::string& message :
             {messageOf(shape, posed(other, 3), posed(m, -1)),
              messageOf(shape, posed(m, 3), posed(other, -1))})
          EXPECT_NE(message.find(wanted), std::string::npos) << message;
      }
  // What was computed in float or typed with four digits is a rotation.
  Matrix3<double> typed;
  typed << 0.7071, -0.7071, 0, 0.7071, 0.7071, 0, 0, 0, 1;
  for (const Geometry& shape : shapes)
    EXPECT_EQ(messageOf(shape, posed(typed, 3), posed(one, -1)), "");
}

}  // namespace
}  // namespace test
}  // namespace fcl
