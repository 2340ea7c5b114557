// SPDX-License-Identifier: BSD-3-Clause
//
// The least distance during the step: closed forms, random pairs against dense samples,
// arguments and errors.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "approach_cases.h"
#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "fcl/geometry/octree/octree.h"
#include "fcl/geometry/shape/box.h"
#include "fcl/geometry/shape/capsule.h"
#include "fcl/geometry/shape/cylinder.h"
#include "fcl/geometry/shape/halfspace.h"
#include "fcl/geometry/shape/plane.h"
#include "fcl/geometry/shape/sphere.h"
#include "fcl/math/bv/OBBRSS.h"
#include "fcl/math/motion/interp_motion.h"
#include "fcl/math/motion/screw_motion.h"
#include "fcl/math/motion/translation_motion.h"
#include "fcl/narrowphase/continuous_distance.h"
#include "feature_distance.h"
#include "moving_objects.h"
#include "sanitizer.h"
#include "test_models.h"

namespace fcl {
namespace test {
namespace {

using V = Vector3<double>;
using Pose = Transform3<double>;
using Rigid = BVHModel<OBBRSS<double>>;
using Model = DeformableBVHModel<KDOP<double, 16>>;
using Request = ContinuousDistanceRequest<double>;
using Result = ContinuousDistanceResult<double>;
using Geometry = CollisionGeometry<double>;

constexpr double kPi = 3.14159265358979323846;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

Pose at(double x, double y, double z) {
  Pose pose = Pose::Identity();
  pose.translation() << x, y, z;
  return pose;
}

Pose turned(double angle, const V& axis, const V& place = V::Zero()) {
  Pose pose(AngleAxis<double>(angle, axis).toRotationMatrix());
  pose.translation() = place;
  return pose;
}

Result ask(const Geometry& a, const Pose& a_beg, const Pose& a_end, const Geometry& b,
           const Pose& b_beg, const Pose& b_end, const Request& request = Request()) {
  Result result;
  EXPECT_EQ(continuousDistance(&a, a_beg, a_end, &b, b_beg, b_end, request, result),
            result.distance_lo);
  return result;
}

/// Expects the distance to be in the bracket, which is as narrow as requested.
void expectDistance(const Result& result, double distance, double time,
                    const Request& request = Request(), double time_error = 1e-2) {
  constexpr double kRounding = 1e-11;
  EXPECT_FALSE(result.is_collide);
  EXPECT_FALSE(result.is_cut_off);
  EXPECT_LE(result.distance_lo, distance + kRounding);
  EXPECT_GE(result.distance_hi, distance - kRounding);
  EXPECT_LE(result.distance_hi - result.distance_lo,
            std::max(request.abs_err, request.rel_err * result.distance_hi) + kRounding);
  EXPECT_NEAR(result.time, time, time_error);
  EXPECT_NEAR((result.nearest_points[1] - result.nearest_points[0]).norm(),
              result.distance_hi, kRounding);
}

/// Tolerances from coarse ones to rounding.
std::vector<Request> requests() {
  std::vector<Request> out(4);
  out[0].rel_err = 0.1;
  out[2].rel_err = 1e-8;
  out[3].rel_err = 0;
  for (Request& request : out) request.ccd_motion_type = CCDM_SCREW;
  return out;
}

TEST(FCL_CONTINUOUS_DISTANCE, spheresOnLines) {
  const Sphere<double> a(0.25), b(0.5);
  for (const Request& request : requests()) {
    // They pass each other at the distance 2 of their centers, at t = 1/4.
    const Result result =
        ask(a, at(-1, 0, 0), at(3, 0, 0), b, at(0, 2, 0), at(0, 2, 0), request);
    expectDistance(result, 1.25, 0.25, request, 0.2);
    EXPECT_EQ(result.b1, -1);
    EXPECT_EQ(result.b2, -1);
  }
}

TEST(FCL_CONTINUOUS_DISTANCE, spheresOnCircles) {
  // Both circle about the origin, on radii 1 and 3, by half a turn in opposite ways. They
  // are on one side of it at t = 1/2.
  const Sphere<double> a(0.25), b(0.5);
  for (const Request& request : requests()) {
    const auto on = [](double radius, double angle) {
      return turned(angle, V::UnitZ()) * at(radius, 0, 0);
    };
    const double part = 0.4 * kPi;
    const Result result =
        ask(a, on(1, -part), on(1, part), b, on(3, part), on(3, -part), request);
    expectDistance(result, 1.25, 0.5, request, 0.2);
  }
}

TEST(FCL_CONTINUOUS_DISTANCE, rodThatPassesAPoint) {
  // A thin rod along x from 0 to 2 turns about z; a free point is at the angle 0.7 and
  // the height 0.3.
  Model rod, point;
  rod.beginModel();
  rod.addEdge(V(0, 0, 0), V(2, 0, 0));
  rod.endModel();
  point.beginModel();
  point.addPoint(V(std::cos(0.7), std::sin(0.7), 0.3));
  point.endModel();
  for (const Request& request : requests()) {
    const Result result = ask(rod, at(0, 0, 0), turned(1, V::UnitZ()), point, at(0, 0, 0),
                              at(0, 0, 0), request);
    expectDistance(result, 0.3, 0.7, request, 0.2);
    EXPECT_EQ(result.b1, 0);
    EXPECT_EQ(result.b2, 0);
  }
}

TEST(FCL_CONTINUOUS_DISTANCE, boxAbovePlane) {
  // A cube on a corner turns about its center, at the height 2: its edge is lowest after
  // an eighth of a turn.
  const Box<double> box(2, 2, 2);
  const TestMesh mesh = makeBox(V(1, 1, 1), 2);
  const auto surface = makeModel<Rigid>(mesh);
  const Plane<double> plane(V::UnitZ(), 0);
  const Halfspace<double> ground(V::UnitZ(), 0);
  for (const Request& request : requests())
    for (const Geometry* body : {static_cast<const Geometry*>(&box),
                                 static_cast<const Geometry*>(surface.get())})
      for (const Geometry* flat : {static_cast<const Geometry*>(&plane),
                                   static_cast<const Geometry*>(&ground)}) {
        const Pose up = at(0, 0, 2), tilted = turned(kPi / 3, V::UnitX(), V(0, 0, 2));
        const Result result =
            ask(*body, up, tilted, *flat, at(0, 0, 0), at(1, 2, 0), request);
        expectDistance(result, 2 - std::sqrt(2.), 0.75, request, 0.3);
        const Result swapped =
            ask(*flat, at(0, 0, 0), at(1, 2, 0), *body, up, tilted, request);
        expectDistance(swapped, 2 - std::sqrt(2.), 0.75, request, 0.3);
      }
}

TEST(FCL_CONTINUOUS_DISTANCE, sheetThatDeforms) {
  // A flat sheet whose middle sinks to 0.25 above a ball's top at the end.
  const TestMesh flat =
      makeSheet(8, 8, [](double u, double v) { return V(2 * u - 1, 2 * v - 1, 2); });
  TestMesh bent = flat;
  for (V& p : bent.vertices) p[2] -= 0.75 * std::max(0., 1 - p.head<2>().norm());
  const auto sheet = makeModel<Model>(flat, bent);
  const Sphere<double> ball(1);
  const Result result =
      ask(*sheet, at(0, 0, 0), at(0, 0, 0), ball, at(0, 0, 0), at(0, 0, 0));
  expectDistance(result, 0.25, 1);
  EXPECT_NEAR(result.nearest_points[0][2], 1.25, 1e-9);
  EXPECT_NEAR(result.nearest_points[1][2], 1, 1e-9);
  // Only the first half counts: the sheet is lowest at its end.
  Request request;
  request.t_max = 0.5;
  expectDistance(
      ask(*sheet, at(0, 0, 0), at(0, 0, 0), ball, at(0, 0, 0), at(0, 0, 0), request),
      0.625, 0.5);
}

TEST(FCL_CONTINUOUS_DISTANCE, gripperAndWhatItHolds) {
  // Both turn as one, about an axis that is far away: the distance is always the same.
  const Box<double> finger(0.5, 0.5, 1);
  const Cylinder<double> held(0.25, 1);
  Request request;
  request.ccd_motion_type = CCDM_SCREW;
  const Pose turn = turned(2, V::UnitZ());
  const Pose a = at(3, 0, 0), b = at(4, 0, 0);
  expectDistance(ask(finger, a, turn * a, held, b, turn * b, request), 0.5, 0);
}

TEST(FCL_CONTINUOUS_DISTANCE, contacts) {
  const Sphere<double> a(0.25), b(0.5);
  const Result result = ask(a, at(-3, 0, 0), at(1, 0, 0), b, at(0, 0, 0), at(0, 0, 0));
  EXPECT_TRUE(result.is_collide);
  EXPECT_EQ(result.distance_lo, 0);
  EXPECT_EQ(result.distance_hi, 0);
  EXPECT_NEAR(result.time, 2.25 / 4, 1e-4);
  EXPECT_NEAR(result.nearest_points[0][0], -0.5, 1e-3);
  // Meshes that cross at the beginning, deep, and then part.
  const auto box = makeModel<Rigid>(makeBox(V(1, 1, 1), 8));
  const Result crossing =
      ask(*box, at(0, 0, 0), at(9, 0, 0), *box, at(0.5, 0.3, 0.4), at(0.5, 0.3, 0.4));
  EXPECT_TRUE(crossing.is_collide);
  EXPECT_EQ(crossing.time, 0);
  // One passes through the other in a short part of the step.
  const Result fast =
      ask(*box, at(-100, 0.5, 0), at(100, 0.5, 0), *box, at(0, 0, 0), at(0, 0, 0));
  EXPECT_TRUE(fast.is_collide);
  EXPECT_NEAR(fast.time, 0.49, 1e-4);
  // A body inside of a closed mesh does not touch its surface.
  const auto small = makeModel<Rigid>(makeBox(V(0.25, 0.25, 0.25), 2));
  expectDistance(ask(*small, at(0, 0, 0), at(0.25, 0, 0), *box, at(0, 0, 0), at(0, 0, 0)),
                 0.5, 1);
  const Box<double> solid(2, 2, 2);
  EXPECT_TRUE(ask(*small, at(0, 0, 0), at(0.25, 0, 0), solid, at(0, 0, 0), at(0, 0, 0))
                  .is_collide);
}

TEST(FCL_CONTINUOUS_DISTANCE, maxDistance) {
  const Sphere<double> a(0.25), b(0.5);
  Request request;
  const auto askWithin = [&](double distance) {
    request.max_distance = distance;
    return ask(a, at(-1, 0, 0), at(3, 0, 0), b, at(0, 2, 0), at(0, 2, 0), request);
  };
  const Result cut = askWithin(1);
  EXPECT_TRUE(cut.is_cut_off);
  EXPECT_EQ(cut.distance_lo, 1);
  EXPECT_GE(cut.distance_hi, 1.25);
  expectDistance(askWithin(1.3), 1.25, 0.25, request, 0.2);
  // Far away no pair may even be looked at.
  const auto box = makeModel<Rigid>(makeBox(V(1, 1, 1), 8));
  const Result far =
      ask(*box, at(0, 0, 0), at(1, 0, 0), *box, at(90, 0, 0), at(90, 0, 0), request);
  EXPECT_TRUE(far.is_cut_off);
  EXPECT_EQ(far.distance_lo, 1.3);
  EXPECT_GE(far.distance_hi, 87);
}

// Two points in one place, and a bound whose tolerance rounds to 0.
TEST(FCL_CONTINUOUS_DISTANCE, subnormalMaxDistanceEnds) {
  DeformableBVHModel<> point;
  point.beginModel();
  point.addPoint(Vector3<double>::Zero());
  point.endModel();
  const Transform3<double> still = Transform3<double>::Identity();
  Request request;
  request.max_distance = std::numeric_limits<double>::denorm_min();
  Result result;
  continuousDistance(&point, still, still, &point, still, still, request, result);
  EXPECT_EQ(result.distance_lo, 0);
  EXPECT_LE(result.distance_hi, 1e-150);
}

TEST(FCL_CONTINUOUS_DISTANCE, maxDistanceBelowRounding) {
  // The radii have no digits for it, but far more than that is proved.
  const Sphere<double> a(0.25), b(0.5);
  const auto box = makeModel<Rigid>(makeBox(V(0.25, 0.25, 0.25), 2));
  Request request;
  request.max_distance = 1e-300;
  for (const Geometry* first :
       {static_cast<const Geometry*>(&a), static_cast<const Geometry*>(box.get())}) {
    const Result cut =
        ask(*first, at(-1, 0, 0), at(3, 0, 0), b, at(0, 2, 0), at(0, 2, 0), request);
    EXPECT_FALSE(cut.is_collide);
    EXPECT_TRUE(cut.is_cut_off);
    EXPECT_EQ(cut.distance_lo, 1e-300);
  }
  // Their boxes show no gap: the direction that parts them is no axis of a box.
  const Capsule<double> rod(0.25, 10);
  const Pose tilt = turned(0.7, V(1, 1, 0).normalized());
  Pose place = tilt;
  place.translation() = 0.51 * V(1, 1, 0).normalized() + 3 * tilt.linear().col(2);
  const Result rods = ask(rod, at(0, 0, 0), at(0, 0, 1), rod, place, place, request);
  EXPECT_TRUE(rods.is_cut_off);
  EXPECT_EQ(rods.distance_lo, 1e-300);
  EXPECT_GE(rods.distance_hi, 0.01 - 1e-9);
  // What touches is not cut off.
  const Result touch =
      ask(a, at(-3, 0, 0), at(3, 0, 0), b, at(0, 0, 0), at(0, 0, 0), request);
  EXPECT_TRUE(touch.is_collide);
  EXPECT_FALSE(touch.is_cut_off);
}

TEST(FCL_CONTINUOUS_DISTANCE, filters) {
  // A floor in two parts of which the nearer one does not count.
  TestMesh mesh;
  mesh.vertices = {V(-9, -9, 0),  V(9, -9, 0),  V(0, 9, 0),
                   V(-9, -9, -1), V(9, -9, -1), V(0, 9, -1)};
  mesh.triangles = {Triangle(0, 1, 2), Triangle(3, 4, 5)};
  const auto floors = makeModel<Rigid>(mesh);
  const Sphere<double> ball(1);
  Request request;
  const auto drop = [&] {
    return ask(*floors, at(0, 0, 0), at(0, 0, 0), ball, at(0, 0, 3), at(0, 0, 2),
               request);
  };
  expectDistance(drop(), 1, 1);
  request.filter1.triangle_masks = {2, 1};
  expectDistance(drop(), 2, 1);
  EXPECT_EQ(drop().b1, 1);
  request.filter1.triangle_masks.clear();
  request.accepts_triangles = [](std::intptr_t b1, std::intptr_t) { return b1 == 1; };
  expectDistance(drop(), 2, 1);
  request.filter2.group = 4;
  request.filter1.mask = 3;
  const Result none = drop();
  EXPECT_EQ(none.distance_lo, kInfinity);
  EXPECT_EQ(none.distance_hi, kInfinity);
  EXPECT_FALSE(none.is_collide);
}

TEST(FCL_CONTINUOUS_DISTANCE, degenerateMeshes) {
  // A triangle without area, a repeated corner, and two layers in one place.
  TestMesh mesh;
  mesh.vertices = {V(0, 0, 0), V(1, 0, 0), V(2, 0, 0), V(0, 0, 0)};
  mesh.triangles = {Triangle(0, 1, 2), Triangle(0, 0, 1), Triangle(3, 0, 3),
                    Triangle(0, 1, 2)};
  const auto line = makeModel<Rigid>(mesh);
  const Sphere<double> ball(0.5);
  Request request;
  request.ccd_motion_type = CCDM_LINEAR;
  expectDistance(ask(*line, at(0, 0, 2), turned(1, V::UnitX(), V(0, 0, 2)), ball,
                     at(1, 0, 0), at(1, 0, 0), request),
                 1.5, 0, request, 1);
  expectDistance(ask(*line, at(0, 0, 2), at(0, 0, 1), *line, at(0, 0, 0), at(0, 0, 0)), 1,
                 1);
}

// The normal of a thin face is off by far more than its corners. A foot on that plane is
// beside the face, and seems too near.
TEST(FCL_CONTINUOUS_DISTANCE, thinFaces) {
  constexpr double kRounding = 1e-13;
  const Pose here = at(0, 0, 0);
  Random random(3);
  for (const double width : {1e-6, 1e-8, 1e-10})
    for (int round = 0; round < rounds(200); ++round) {
      const V along = randomDirection(random),
              across = along.cross(randomDirection(random)).normalized(),
              from = random.point(1), to = from + along,
              third = from + random.uniform(0.1, 0.9) * along + width * across,
              p = from + random.uniform(0.2, 0.8) * along +
                  random.uniform(0.1, 1) * along.cross(across);
      TestMesh mesh{{from, to, third}, {Triangle(0, 1, 2)}};
      const auto face = makeModel<Rigid>(mesh);
      Model point;
      point.beginModel();
      point.addPoint(p);
      point.endModel();
      // The edge is further away by less than the square of the width.
      const double distance = distanceOfEdges(from, to, p, p);
      for (const bool is_first : {true, false}) {
        const Result result = is_first ? ask(*face, here, here, point, here, here)
                                       : ask(point, here, here, *face, here, here);
        ASSERT_GE(result.distance_hi, distance - width * width - kRounding);
        ASSERT_LE(result.distance_hi, distance * (1 + 1e-3) + kRounding);
        ASSERT_LE(result.distance_lo, distance + kRounding);
      }
    }
}

TEST(FCL_CONTINUOUS_DISTANCE, sizes) {
  const auto box = makeModel<Rigid>(makeBox(V(1, 1, 1), 4));
  for (const double size : {1e-30, 1e-6, 1., 1e6, 1e30}) {
    SCOPED_TRACE(size);
    TestMesh mesh = makeBox(V(size, size, size), 4);
    const auto scaled = makeModel<Rigid>(mesh);
    const Result result =
        ask(*scaled, at(-9 * size, 0, 0), turned(1, V::UnitZ(), V(9 * size, 0, 0)),
            *scaled, at(0, 4 * size, 0), at(0, 4 * size, 0));
    EXPECT_LE(result.distance_hi - result.distance_lo, 1.001e-3 * result.distance_hi);
    EXPECT_GT(result.distance_lo, 1.5 * size);
    EXPECT_LT(result.distance_hi, 2 * size);
  }
}

// Squares of such lengths underflow. The bracket of shapes is right, if not narrow.
TEST(FCL_CONTINUOUS_DISTANCE, sizesOfWhichSquaresUnderflow) {
  for (const double size : {1e-160, 1e-200, 1e-300}) {
    SCOPED_TRACE(size);
    const Sphere<double> ball(size);
    const Box<double> box(2 * size, 2 * size, 2 * size);
    for (const Geometry* o :
         {static_cast<const Geometry*>(&ball), static_cast<const Geometry*>(&box)}) {
      const Result result = ask(*o, at(-9 * size, 0, 0), at(9 * size, 0, 0), *o,
                                at(0, 4 * size, 0), at(0, 4 * size, 0));
      EXPECT_FALSE(result.is_collide);
      EXPECT_LE(result.distance_lo, 2 * size);
      EXPECT_GE(result.distance_hi, 2 * size);
      EXPECT_LE(result.distance_hi, 2 * size + 1e-159);
    }
  }
  const Sphere<double> huge(1e60);
  expectRefused(
      [&] { ask(huge, at(0, 0, 0), at(0, 0, 0), huge, at(4e60, 0, 0), at(4e60, 0, 0)); },
      "2^160");
}

TEST(FCL_CONTINUOUS_DISTANCE, formsOfArguments) {
  const auto box = std::make_shared<Box<double>>(1, 2, 3);
  const auto mesh = makeModel<Rigid>(makeIcosphere(2, 1));
  const Pose from = at(-2, 2.5, 0), to = turned(1, V::UnitZ(), V(2, 2.5, 0));
  const Result transforms = ask(*box, from, to, *mesh, at(0, 0, 0), at(0, 0, 0));
  Result motions, objects;
  const InterpMotion<double> turning(from.linear(), from.translation(), to.linear(),
                                     to.translation(), V::Zero());
  const TranslationMotion<double> still(at(0, 0, 0), at(0, 0, 0));
  continuousDistance(box.get(), &turning, mesh.get(), &still, Request(), motions);
  const CollisionObject<double> o1(box, from), o2(mesh, at(0, 0, 0));
  continuousDistance(&o1, to, &o2, at(0, 0, 0), Request(), objects);
  EXPECT_FALSE(transforms.is_collide);
  for (const Result* other : {&motions, &objects}) {
    EXPECT_EQ(other->distance_lo, transforms.distance_lo);
    EXPECT_EQ(other->distance_hi, transforms.distance_hi);
    EXPECT_EQ(other->time, transforms.time);
  }
  const Sphere<float> small(0.25F), large(0.5F);
  Transform3<float> beg = Transform3<float>::Identity(), end = beg, rest = beg;
  beg.translation() << -1, 0, 0;
  end.translation() << 3, 0, 0;
  rest.translation() << 0, 2, 0;
  ContinuousDistanceResult<float> in_float;
  continuousDistance(&small, beg, end, &large, rest, rest,
                     ContinuousDistanceRequest<float>(), in_float);
  EXPECT_LE(in_float.distance_lo, 1.25F);
  EXPECT_GE(in_float.distance_hi, 1.25F);
  EXPECT_LE(in_float.distance_hi - in_float.distance_lo, 2e-3F);
}

// A point that is fast and passes another one closely is much further away when the time
// is rounded to a float.
TEST(FCL_CONTINUOUS_DISTANCE, timesOfFloatsAreFloats) {
  const auto pointAt = [](const Vector3<float>& p) {
    auto model = std::make_shared<DeformableBVHModel<KDOP<float, 16>>>();
    model->beginModel();
    model->addPoint(p);
    model->endModel();
    return model;
  };
  const float gap = 0x1p-10F;
  const auto a = pointAt({0, 0, 0}), b = pointAt({0, gap, 0});
  const Transform3<float> rest = Transform3<float>::Identity();
  for (const float place : {0.1F, 0.3F, 0.7F}) {
    Transform3<float> begin = rest, end = rest;
    begin.translation()[0] = -10000 * place;
    end.translation()[0] = begin.translation()[0] + 10000;
    ContinuousDistanceResult<float> result;
    continuousDistance(a.get(), begin, end, b.get(), rest, rest,
                       ContinuousDistanceRequest<float>(), result);
    const double from = begin.translation()[0], to = end.translation()[0],
                 x = from + (to - from) * double{result.time};
    EXPECT_GE(double{result.distance_hi}, std::hypot(x, gap) - 1e-9);
    EXPECT_LE(result.distance_lo, gap);
    EXPECT_GT(result.distance_lo, 0.98F * gap);
  }
}

// Two threads, the query before, and what the result held change nothing.
TEST(FCL_CONTINUOUS_DISTANCE, resultHoldsNothingOfTheQueryBefore) {
  const Sphere<double> a(0.25), b(0.5);
  Result result;
  const auto askInto = [&](double y) {
    continuousDistance(&a, at(-1, 0, 0), at(3, 0, 0), &b, at(0, y, 0), at(0, y, 0),
                       Request(), result);
  };
  askInto(0);
  EXPECT_TRUE(result.is_collide);
  askInto(2);
  expectDistance(result, 1.25, 0.25, Request(), 0.2);
}

TEST(FCL_CONTINUOUS_DISTANCE, pointsThatMeet) {
  // They have the distance 0, but that is no contact.
  constexpr double kRounding = 1e-12;
  Model points;
  points.beginModel();
  points.addPoint(V(1, 2, 3));
  points.endModel();
  const Pose here = at(0, 0, 0);
  for (const Pose& from : {here, at(1, 0, 0)}) {
    const Result result = ask(points, from, here, points, here, here);
    EXPECT_FALSE(result.is_collide);
    EXPECT_EQ(result.distance_lo, 0);
    EXPECT_NEAR(result.distance_hi, 0, kRounding);
    EXPECT_EQ(result.time, from.translation()[0]);
    EXPECT_NEAR((result.nearest_points[0] - V(1, 2, 3)).norm(), 0, kRounding);
  }
}

TEST(FCL_CONTINUOUS_DISTANCE, onlyTheBeginningCounts) {
  const Sphere<double> a(0.25), b(0.5);
  Request request;
  request.t_max = 0;
  expectDistance(ask(a, at(-3, 0, 0), at(3, 0, 0), b, at(0, 0, 0), at(0, 0, 0), request),
                 2.25, 0, request, 0);
}

TEST(FCL_CONTINUOUS_DISTANCE, errors) {
  const Sphere<double> ball(1);
  const Plane<double> plane(V::UnitZ(), 0);
  const Pose here = at(0, 0, 0), there = at(0, 0, 5);
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  const auto askWith = [&](const Request& request) {
    Result result;
    continuousDistance(&ball, here, here, &ball, there, there, request, result);
  };
  const auto withField = [](double Request::*field, double value) {
    Request request;
    request.*field = value;
    return request;
  };
  for (const double bad : {-1., kNaN, kInfinity}) {
    expectRefused([&] { askWith(withField(&Request::abs_err, bad)); }, "request.abs_err");
    expectRefused([&] { askWith(withField(&Request::rel_err, bad)); }, "request.rel_err");
    expectRefused([&] { askWith(withField(&Request::t_max, bad)); }, "request.t_max");
  }
  for (const double bad : {-1., 0., kNaN})
    expectRefused([&] { askWith(withField(&Request::max_distance, bad)); },
                  "request.max_distance");
  expectRefused([&] { askWith(withField(&Request::toc_err, -1)); }, "request.toc_err");
  Request threads;
  threads.num_threads = -1;
  expectRefused([&] { askWith(threads); }, "request.num_threads");
  expectRefused([&] { ask(plane, here, here, plane, there, there); }, "halfspace");
  expectRefused([&] { ask(ball, at(kNaN, 0, 0), here, ball, there, there); }, "o1");
  Result result;
  expectRefused(
      [&] {
        continuousDistance(static_cast<const Geometry*>(nullptr), here, here, &ball,
                           there, there, Request(), result);
      },
      "o1");
  const Throw thrown(V(0, 0, 9), V(0, 0, 1), V(0, 0, -1));
  const TranslationMotion<double> still(here, here);
  expectRefused(
      [&] { continuousDistance(&ball, &thrown, &ball, &still, Request(), result); },
      "BoundedMotion");
  TestMesh bad = makeIcosphere(1, 1);
  const Rigid unbuilt;
  expectRefused([&] { ask(unbuilt, here, here, ball, there, there); }, "o1");
  Pose sheared = here;
  sheared.linear()(0, 1) = 0.5;
  expectRefused([&] { ask(ball, here, here, ball, there, sheared); }, "o2");
  bad.vertices[3][1] = kNaN;
  const auto broken = makeModel<Rigid>(bad);
  expectRefused([&] { ask(*broken, here, here, ball, there, there); }, "vertex 3");
}

// Boxes leave out no pair that is nearer: as each pair of triangles alone, which no box
// leaves out.
TEST(FCL_CONTINUOUS_DISTANCE, boxesLeaveOutNothing) {
  Random random(5);
  const auto part = [](const TestMesh& mesh, std::size_t i) {
    return makeModel<Rigid>(TestMesh{mesh.vertices, {mesh.triangles[i]}});
  };
  for (int round = 0; round < rounds(16); ++round) {
    SCOPED_TRACE(round);
    const TestMesh mesh1 = shaken(makeBox(V(0.5, 0.3, 0.2), 1), 0.1, random.next()),
                   mesh2 = shaken(makeIcosphere(0, 0.4), 0.1, random.next());
    const Pose begin = turned(3 * random.point(1)[0], randomDirection(random),
                              random.point(1)),
               end = turned(1.5, randomDirection(random)) * begin,
               place = at(1.2, random.point(1)[0], random.point(1)[1]);
    Request request;
    request.rel_err = 1e-4;
    const Result whole = ask(*makeModel<Rigid>(mesh1), begin, end,
                             *makeModel<Rigid>(mesh2), place, place, request);
    double lo = kInfinity, hi = kInfinity;
    for (std::size_t i = 0; i < mesh1.triangles.size(); ++i)
      for (std::size_t j = 0; j < mesh2.triangles.size(); ++j) {
        const Result pair =
            ask(*part(mesh1, i), begin, end, *part(mesh2, j), place, place, request);
        lo = std::min(lo, pair.distance_lo);
        hi = std::min(hi, pair.distance_hi);
      }
    EXPECT_LE(whole.distance_lo, hi);
    EXPECT_LE(lo, whole.distance_hi);
  }
}

TEST(FCL_CONTINUOUS_DISTANCE, randomPairs) {
  constexpr int kSamples = 24;
  ApproachTally tally;
  for (std::uint64_t number = 1; number <= rounds(400U); ++number)
    EXPECT_EQ(approachDisagreement(number, kSamples, tally), "") << "case " << number;
  if (kHasAddressSanitizer) return;
  EXPECT_GT(tally.contacts, 50U);
  EXPECT_GT(tally.cut_off, 10U);
  EXPECT_GT(tally.kinds.size(), 100U);
}

}  // namespace
}  // namespace test
}  // namespace fcl
