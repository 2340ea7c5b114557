// SPDX-License-Identifier: BSD-3-Clause
//
// How deep two solids overlap at t = 0, and in which direction they part: against closed
// forms, and against the reach along many directions.
#include "shapes/penetration.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "fcl/geometry/bvh/BVH_model.h"
#include "fcl/geometry/octree/octree.h"
#include "fcl/narrowphase/continuous_collision.h"
#include "mesh_generators.h"
#include "posed_shape.h"
#include "sanitizer.h"

namespace fcl {
namespace test {
namespace {

using Point = Vector3<double>;
using Tf = Transform3<double>;
using Geometry = std::shared_ptr<CollisionGeometry<double>>;
constexpr double kClose = 1e-9;

Tf at(const Point& place) { return Tf(Translation3<double>(place)); }

Tf randomTurn(Random& random) {
  return Tf(AngleAxis<double>(random.uniform(0, 3), randomDirection(random)));
}

ContinuousContactResultd contactsOf(const Geometry& a, const Tf& pose_a,
                                    const Geometry& b, const Tf& pose_b,
                                    const Tf& end_b) {
  ContinuousContactRequestd request;
  ContinuousContactResultd result;
  continuousCollide(a.get(), pose_a, pose_a, b.get(), pose_b, end_b, request, result);
  return result;
}

ContinuousContactd contactOf(const Geometry& a, const Tf& pose_a, const Geometry& b,
                             const Tf& pose_b) {
  const auto result = contactsOf(a, pose_a, b, pose_b, pose_b);
  EXPECT_EQ(result.contacts.size(), 1U);
  return result.contacts.empty() ? ContinuousContactd{} : result.contacts[0];
}

/// The depth is known, and the normal too unless it is zero. The same after a common
/// motion, and in the other order with the opposite normal.
void expectDepth(const Geometry& a, const Tf& pose_a, const Geometry& b, const Tf& pose_b,
                 double depth, const Point& normal) {
  Random random(4711);
  for (int i = 0; i < 8; ++i) {
    const Tf moved = i == 0 ? Tf::Identity() : at(random.point(3)) * randomTurn(random);
    ContinuousContactd contact = contactOf(a, moved * pose_a, b, moved * pose_b);
    EXPECT_EQ(contact.toc_lo, 0);
    EXPECT_NEAR(contact.penetration_depth, depth, kClose);
    EXPECT_NEAR(contact.normal.norm(), 1, 1e-12);
    if (!normal.isZero()) {
      EXPECT_LE((moved.linear() * normal - contact.normal).norm(), kClose);
    }
    const Point out = contact.normal;
    contact = contactOf(b, moved * pose_b, a, moved * pose_a);
    EXPECT_NEAR(contact.penetration_depth, depth, kClose);
    if (!normal.isZero()) {
      EXPECT_LE((out + contact.normal).norm(), kClose);
    }
  }
}

Geometry sphere(double r) { return std::make_shared<Sphere<double>>(r); }
Geometry capsule(double r, double length) {
  return std::make_shared<Capsule<double>>(r, length);
}
Geometry box(double x, double y, double z) {
  return std::make_shared<Box<double>>(x, y, z);
}

TEST(FCL_PENETRATION, twoSpheres) {
  const Geometry a = sphere(0.5), b = sphere(0.3);
  const Point way(0.1, -0.2, 0.3);
  expectDepth(a, at({1, 2, 3}), b, at(Point(1, 2, 3) + way), 0.8 - way.norm(),
              way.normalized());
  expectDepth(a, at({1, 2, 3}), b, at({1, 2, 3}), 0.8, Point::Zero());
}

TEST(FCL_PENETRATION, aSphereInABox) {
  const Geometry of = box(2, 4, 6), ball = sphere(0.25);
  expectDepth(of, Tf::Identity(), ball, at({0.4, 1.7, -2}), 0.55, Point(0, 1, 0));
  expectDepth(of, Tf::Identity(), ball, at({0.9, -1.8, 2.7}), 0.35, Point(1, 0, 0));
  // Outside of the box, beside an edge.
  const Point beside(0.09, 0.12, 0);
  expectDepth(of, Tf::Identity(), ball, at(Point(1, 2, 1) + beside), 0.25 - 0.15,
              beside.normalized());
}

/// The axes of two boxes are the only candidates, with the products of their edges.
double depthOfBoxes(const PosedShape& a, const PosedShape& b, Point& normal) {
  std::vector<Point> axes;
  for (int i = 0; i < 3; ++i) {
    axes.emplace_back(a.pose.linear().col(i));
    axes.emplace_back(b.pose.linear().col(i));
    for (int k = 0; k < 3; ++k) {
      const Point n = a.pose.linear().col(i).cross(b.pose.linear().col(k));
      if (n.norm() > 1e-6) axes.push_back(n.normalized());
    }
  }
  double least = HUGE_VAL;
  for (const Point& axis : axes)
    for (const Point& n : {axis, Point(-axis)}) {
      const double depth = n.dot(a.support(n)) - n.dot(b.support(-n));
      if (!(depth < least)) continue;
      least = depth;
      normal = n;
    }
  return least;
}

TEST(FCL_PENETRATION, twoBoxes) {
  expectDepth(box(2, 2, 2), Tf::Identity(), box(2, 2, 2), at({0.3, 1.6, -0.5}), 0.4,
              Point(0, 1, 0));
  expectDepth(box(1, 1, 1), Tf::Identity(), box(1, 1, 1), Tf::Identity(), 1,
              Point::Zero());
  int overlapping = 0;
  for (int i = 0; i < rounds(2000); ++i) {
    SCOPED_TRACE(i);
    Random random(100 + i);
    PosedShape a = randomShape("box", random), b = randomShape("box", random);
    a.pose = randomTurn(random);
    b.pose = at(random.point(0.6)) * randomTurn(random);
    Point normal;
    const double depth = depthOfBoxes(a, b, normal);
    if (depth < 1e-6) continue;
    ++overlapping;
    const auto contact = contactOf(a.geometry, a.pose, b.geometry, b.pose);
    EXPECT_NEAR(contact.penetration_depth, depth, kClose);
    EXPECT_NEAR(contact.normal.dot(a.support(contact.normal)) -
                    contact.normal.dot(b.support(-contact.normal)),
                depth, kClose);
  }
  EXPECT_GT(overlapping, rounds(2000) / 3);
}

TEST(FCL_PENETRATION, capsules) {
  // Beside each other, crossing, and a small one inside of the wall of a large one.
  expectDepth(capsule(0.3, 2), Tf::Identity(), capsule(0.2, 3), at({0.3, 0.1, 0.7}),
              0.5 - std::hypot(0.3, 0.1), Point(0.3, 0.1, 0).normalized());
  const Tf across(AngleAxis<double>(M_PI / 2, Point::UnitX()));
  expectDepth(capsule(0.3, 2), Tf::Identity(), capsule(0.2, 2), at({0.25, 0, 0}) * across,
              0.25, Point(1, 0, 0));
  expectDepth(capsule(0.3, 2), Tf::Identity(), capsule(0.2, 2), across, 0.5,
              Point::Zero());
  expectDepth(capsule(0.3, 2), Tf::Identity(), sphere(0.1), at({0.1, 0, 0.5}), 0.3,
              Point(1, 0, 0));
  // A capsule that stands in a box leaves it by the nearest side.
  expectDepth(box(2, 3, 4), Tf::Identity(), capsule(0.2, 1), at({0.2, 0.1, -0.4}), 1.0,
              Point(1, 0, 0));
  expectDepth(box(2, 3, 4), Tf::Identity(), capsule(0.2, 1), at({0.2, 0.1, -1.9}), 0.8,
              Point(0, 0, -1));
}

TEST(FCL_PENETRATION, planesAndHalfspaces) {
  const Geometry below = std::make_shared<Halfspace<double>>(Point(0, 0, 1), 0.5),
                 above = std::make_shared<Halfspace<double>>(Point(0, 0, -1), -0.3),
                 plane = std::make_shared<Plane<double>>(Point(0, 0, 1), 0.4);
  expectDepth(below, Tf::Identity(), sphere(0.3), at({3, 4, -2}), 2.8, Point(0, 0, 1));
  expectDepth(below, Tf::Identity(), capsule(0.3, 2), at({3, 4, -2}), 3.8,
              Point(0, 0, 1));
  expectDepth(plane, Tf::Identity(), box(1, 1, 1), at({3, 4, 0.1}), 0.2, Point(0, 0, -1));
  expectDepth(plane, Tf::Identity(), sphere(0.5), at({3, 4, 0.6}), 0.3, Point(0, 0, 1));
  expectDepth(below, Tf::Identity(), above, Tf::Identity(), 0.2, Point(0, 0, 1));
  expectDepth(below, Tf::Identity(), plane, Tf::Identity(), 0.1, Point(0, 0, 1));
  // No translation parts these.
  for (const Geometry& other :
       {below, Geometry(std::make_shared<Halfspace<double>>(Point(0, 1, 1), 3))}) {
    const auto contact = contactOf(below, Tf::Identity(), other, Tf::Identity());
    EXPECT_EQ(contact.penetration_depth, 0);
    EXPECT_TRUE(contact.normal.isZero());
  }
}

/// What a direction has to be as long as.
double reachAlong(const PosedShape& a, const PosedShape& b, const Point& n) {
  return n.dot(a.support(n)) - n.dot(b.support(-n));
}

bool isCurved(const PosedShape& shape) {
  return shape.kind == "ellipsoid" || shape.kind == "cone" || shape.kind == "cylinder";
}

TEST(FCL_PENETRATION, noDirectionIsBetter) {
  const char* const kKinds[] = {"sphere", "capsule",  "box",    "ellipsoid",
                                "cone",   "cylinder", "convex", "triangle"};
  int deep = 0, exact = 0;
  for (int i = 0; i < rounds(1000); ++i) {
    SCOPED_TRACE(i);
    Random random(900 + i);
    PosedShape a = randomShape(kKinds[i % 8], random),
               b = randomShape(kKinds[i / 8 % 8], random);
    a.pose = randomTurn(random);
    b.pose = at(random.point(0.3)) * randomTurn(random);
    const auto result = contactsOf(a.geometry, a.pose, b.geometry, b.pose, b.pose);
    if (result.contacts.empty()) continue;
    const auto& contact = result.contacts[0];
    const Point n = contact.normal;
    ASSERT_NEAR(n.norm(), 1, 1e-12);
    const double depth = contact.penetration_depth;
    EXPECT_NEAR(reachAlong(a, b, n), depth, kClose);
    double least = HUGE_VAL;
    Point best = n;
    for (int k = 0; k < 2000; ++k) {
      const Point other = randomDirection(random);
      const double reach = reachAlong(a, b, other);
      if (!(reach < least)) continue;
      least = reach;
      best = other;
    }
    // The best of them, and what is near to it.
    for (double step = 0.1; step > 1e-9; step *= 0.7)
      for (int k = 0; k < 20; ++k) {
        const Point other = (best + random.point(step)).normalized();
        const double reach = reachAlong(a, b, other);
        if (!(reach < least)) continue;
        least = reach;
        best = other;
      }
    const bool is_curved = isCurved(a) || isCurved(b);
    EXPECT_LE(depth, least + (is_curved ? 2e-4 : kClose));
    exact += depth <= least + kClose;
    deep += depth > 1e-3;
  }
  EXPECT_GT(deep, rounds(1000) / 2);
  EXPECT_GT(exact, deep * 9 / 10);
}

TEST(FCL_PENETRATION, whatIsMovedOutOnlyTouches) {
  const char* const kKinds[] = {"sphere", "box", "ellipsoid", "cone", "cylinder"};
  int deep = 0;
  for (int i = 0; i < rounds(500); ++i) {
    SCOPED_TRACE(i);
    Random random(5000 + i);
    const PosedShape a = randomShape(kKinds[i % 5], random),
                     b = randomShape(kKinds[i / 5 % 5], random);
    const Tf pose_a = randomTurn(random),
             pose_b = at(random.point(0.3)) * randomTurn(random);
    const auto result = contactsOf(a.geometry, pose_a, b.geometry, pose_b, pose_b);
    if (result.contacts.empty() || result.contacts[0].penetration_depth < 0.05) continue;
    const Point out = result.contacts[0].penetration_depth * result.contacts[0].normal;
    const auto touches = [&](double share) {
      const Tf moved = at(share * out) * pose_b;
      return contactsOf(a.geometry, pose_a, b.geometry, moved, moved).is_collide;
    };
    EXPECT_TRUE(touches(0.99));
    EXPECT_FALSE(touches(1.000001));
    ++deep;
  }
  EXPECT_GT(deep, rounds(500) / 3);
}

TEST(FCL_PENETRATION, trianglesAndCells) {
  // The triangles of a square at z = 0, and a box that reaches 0.1 below it.
  auto square = std::make_shared<BVHModel<OBBRSSd>>();
  square->beginModel();
  square->addTriangle({-5, -5, 0}, {5, -5, 0}, {5, 5, 0});
  square->addTriangle({-5, -5, 0}, {5, 5, 0}, {-5, 5, 0});
  square->endModel();
  const auto result = contactsOf(square, Tf::Identity(), box(1, 1, 1), at({0.1, 0, 0.4}),
                                 at({0.1, 0, 0.4}));
  ASSERT_EQ(result.contacts.size(), 2U);
  for (const auto& contact : result.contacts) {
    EXPECT_NEAR(contact.penetration_depth, 0.1, kClose);
    EXPECT_LE((contact.normal - Point(0, 0, 1)).norm(), kClose);
  }
#if FCL_HAVE_OCTOMAP
  auto cells = std::make_shared<octomap::OcTree>(1.);
  cells->updateNode(octomap::point3d(0.5F, 0.5F, 0.5F), true);
  const auto contact = contactOf(sphere(0.25), at({0.5, 0.4, 1.1}),
                                 std::make_shared<OcTree<double>>(cells), Tf::Identity());
  EXPECT_NEAR(contact.penetration_depth, 0.15, kClose);
  EXPECT_LE((contact.normal - Point(0, 0, -1)).norm(), kClose);
#endif
}

TEST(FCL_PENETRATION, otherContactsHaveNone) {
  // One that comes later, one that touches, one at a distance.
  const auto later =
      contactsOf(sphere(0.5), Tf::Identity(), sphere(0.5), at({2, 0, 0}), Tf::Identity());
  ASSERT_EQ(later.contacts.size(), 1U);
  EXPECT_EQ(later.contacts[0].penetration_depth, 0);
  EXPECT_LE((later.contacts[0].normal - Point(1, 0, 0)).norm(), 1e-9);
  ContinuousContactRequestd request;
  request.min_distance = 0.5;
  ContinuousContactResultd near;
  const Geometry ball = sphere(0.5);
  continuousCollide(ball.get(), Tf::Identity(), Tf::Identity(), ball.get(),
                    at({1.25, 0, 0}), at({1.25, 0, 0}), request, near);
  ASSERT_EQ(near.contacts.size(), 1U);
  EXPECT_EQ(near.contacts[0].penetration_depth, 0);
  EXPECT_LE((near.contacts[0].normal - Point(1, 0, 0)).norm(), 1e-9);
  request.min_distance = 0;
  request.enable_contact = false;
  continuousCollide(ball.get(), Tf::Identity(), Tf::Identity(), ball.get(),
                    at({0.5, 0, 0}), at({0.5, 0, 0}), request, near);
  ASSERT_EQ(near.contacts.size(), 1U);
  EXPECT_EQ(near.contacts[0].penetration_depth, 0);
  EXPECT_TRUE(near.contacts[0].normal.isZero());
}

/// All directions are nearly as good, so that the search ends before it has proved one.
/// 2e-3 of the size is what the page allows for.
TEST(FCL_PENETRATION, aBallInAHullOfManyPoints) {
  Random random(31);
  auto points = std::make_shared<std::vector<Point>>();
  for (int i = 0; i < 3000; ++i) points->push_back(randomDirection(random));
  const auto face = std::make_shared<std::vector<int>>(std::vector<int>{3, 0, 1, 2});
  const auto hull = std::make_shared<Convex<double>>(points, 1, face);
  const auto contact = contactOf(hull, Tf::Identity(), sphere(0.25), Tf::Identity());
  const auto reach = [&](const Point& n) {
    double most = 0.25;
    for (const Point& p : *points) most = std::max(most, n.dot(p) + 0.25);
    return most;
  };
  EXPECT_NEAR(reach(contact.normal), contact.penetration_depth, kClose);
  double least = HUGE_VAL;
  for (int i = 0; i < 20000; ++i) least = std::min(least, reach(randomDirection(random)));
  EXPECT_LE(contact.penetration_depth, least + 2e-3 * 1.25);
}

TEST(FCL_PENETRATION, everySizeAndFloat) {
  for (const double size : {1e-100, 1e-12, 1., 1e12, 1e100}) {
    const auto contact = contactOf(box(2 * size, 2 * size, 2 * size), Tf::Identity(),
                                   sphere(size), at({0, 1.5 * size, 0}));
    EXPECT_NEAR(contact.penetration_depth / size, 0.5, kClose);
    EXPECT_LE((contact.normal - Point(0, 1, 0)).norm(), kClose);
  }
  const Boxf cube(2, 2, 2);
  const Spheref ball(0.5F);
  TranslationMotion<float> rests(Transform3f::Identity(), Transform3f::Identity());
  Transform3f place = Transform3f::Identity();
  place.translation() = Vector3f(0, 0, -1.25F);
  TranslationMotion<float> beside(place, place);
  ContinuousContactResultf result;
  continuousCollide(&cube, &rests, &ball, &beside, ContinuousContactRequestf{}, result);
  ASSERT_EQ(result.contacts.size(), 1U);
  EXPECT_FLOAT_EQ(result.contacts[0].penetration_depth, 0.25F);
  EXPECT_LE((result.contacts[0].normal - Vector3f(0, 0, -1)).norm(), 1e-6F);
}

}  // namespace
}  // namespace test
}  // namespace fcl
