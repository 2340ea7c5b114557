// SPDX-License-Identifier: BSD-3-Clause
//
// Small cases of users' reports, each with its time in closed form or from dense sampling
// of exact discrete tests, on every BV type and with shapes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <type_traits>
#include <vector>

#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "fcl/geometry/shape/box.h"
#include "fcl/geometry/shape/sphere.h"
#include "fcl/math/bv/OBBRSS.h"
#include "fcl/math/motion/interp_motion.h"
#include "fcl/math/motion/spline_motion.h"
#include "fcl/narrowphase/collision.h"
#include "fcl/narrowphase/continuous_collision.h"
#include "test_models.h"

namespace fcl {
namespace test {
namespace {

using Vector = Vector3<double>;
using Pose = Transform3<double>;
using Geometry = std::shared_ptr<CollisionGeometry<double>>;
using Request = ContinuousCollisionRequest<double>;
using Result = ContinuousCollisionResult<double>;
using ContactRequest = ContinuousContactRequest<double>;

constexpr double kPi = 3.14159265358979323846;
constexpr double kTocErr = 1e-6;
const Pose kOrigin = Pose::Identity();

Pose at(double x, double y, double z, double angle = 0, Vector axis = Vector::UnitZ()) {
  Pose pose = Pose::Identity();
  pose.translation() = Vector(x, y, z);
  pose.linear() = AngleAxis<double>(angle, axis).toRotationMatrix();
  return pose;
}

/// A mesh in a model of each BV type.
std::vector<Geometry> models(const TestMesh& mesh) {
  return {makeModel<BVHModel<OBBRSS<double>>>(mesh),
          makeModel<BVHModel<OBB<double>>>(mesh),
          makeModel<BVHModel<RSS<double>>>(mesh),
          makeModel<BVHModel<kIOS<double>>>(mesh),
          makeModel<BVHModel<AABB<double>>>(mesh),
          makeModel<BVHModel<KDOP<double, 16>>>(mesh),
          makeModel<BVHModel<KDOP<double, 18>>>(mesh),
          makeModel<BVHModel<KDOP<double, 24>>>(mesh),
          makeModel<DeformableBVHModel<>>(mesh)};
}

/// A box of the full sides in a model of each BV type, and as a shape.
std::vector<Geometry> boxes(double x, double y, double z) {
  std::vector<Geometry> all = models(makeBox({x / 2, y / 2, z / 2}));
  all.push_back(std::make_shared<Box<double>>(x, y, z));
  return all;
}

/// Expects the time, to the last digit that is given, in both orders of the objects.
void expectTime(const Geometry& a, const Pose& a_from, const Pose& a_to,
                const Geometry& b, const Pose& b_from, const Pose& b_to, double time,
                double digit, CCDMotionType type) {
  Request request;
  request.ccd_motion_type = type;
  request.toc_err = kTocErr;
  Result result, swapped;
  continuousCollide(a.get(), a_from, a_to, b.get(), b_from, b_to, request, result);
  continuousCollide(b.get(), b_from, b_to, a.get(), a_from, a_to, request, swapped);
  EXPECT_EQ(result.is_collide, time < 1);
  EXPECT_EQ(swapped.is_collide, time < 1);
  EXPECT_NEAR(result.time_of_contact, time, digit);
  EXPECT_NEAR(swapped.time_of_contact, time, digit);
}

constexpr CCDMotionType kTurningTypes[] = {CCDM_LINEAR, CCDM_SCREW};

TEST(ReportedCases, ABarTurnsToAPost) {
  const double side = 1.3 / std::sqrt(2.0);
  const Pose post = at(side, side, 0);
  const auto bars = boxes(4, .1, .5), posts = boxes(.1, .1, 1);
  for (std::size_t i = 0; i < bars.size(); ++i)
    for (const auto type : kTurningTypes) {
      const auto& other = posts[(i + 1) % posts.size()];
      for (const auto& b : {posts[i], other, posts.back()})
        expectTime(bars[i], kOrigin, at(0, 0, 0, kPi / 2), b, post, post, .440951,
                   kTocErr, type);
    }
}

TEST(ReportedCases, ALinkTurnsPastASmallBox) {
  const double angle = kPi / 6;
  const Pose place = at(.96 * std::cos(angle), .96 * std::sin(angle), 0);
  const auto links = models(moved(makeBox({.5, .05, .05}), .5, 0, 0));
  const auto obstacles = boxes(.06, .06, .06);
  for (const auto& link : links)
    for (const auto type : kTurningTypes)
      for (const auto& obstacle : {obstacles.front(), obstacles.back()})
        expectTime(link, kOrigin, at(0, 0, 0, kPi / 3), obstacle, place, place, .410569,
                   kTocErr, type);
}

TEST(ReportedCases, SpheresOnSplines) {
  const Vector a[] = {{7.55, 8, 0}, {4.183333, 8, 0}, {.816667, 8, 0}, {-2.55, 8, 0}};
  const Vector b[] = {
      {-.032564, 8, 0}, {1.25792, 8, 0}, {3.051563, 8, 0}, {4.627592, 8, 0}};
  const Vector turn(0, 0, 3.141593), none = Vector::Zero();
  const auto spline = [](const Vector* p, const Vector& r) {
    return std::make_shared<SplineMotion<double>>(p[0], p[1], p[2], p[3], r, r, r, r);
  };
  const auto sphere = std::make_shared<Sphere<double>>(1);
  const ContinuousCollisionObject<double> o1(sphere, spline(a, turn)),
      o2(sphere, spline(b, none));
  Request request;
  request.toc_err = kTocErr;
  Result result;
  collide(&o1, &o2, request, result);
  EXPECT_TRUE(result.is_collide);
  EXPECT_NEAR(result.time_of_contact, .170078, kTocErr);
}

TEST(ReportedCases, ABallFliesThroughAnOpenRoom) {
  TestMesh room;
  room.vertices = {{-3, 0, -2}, {0, 0, -2}, {0, 0, 2}, {-3, 0, 2},
                   {1, -2, -2}, {1, 2, -2}, {1, 2, 2}, {1, -2, 2}};
  room.triangles = {{0, 1, 2}, {0, 2, 3}, {4, 5, 6}, {4, 6, 7}};
  const Geometry ball = std::make_shared<Sphere<double>>(.25);
  const Pose from = at(-.78131, .3092001, 0), to = at(4 - .78131, .3092001 - .3, 0);
  for (const auto& model : models(room))
    expectTime(ball, from, to, model, kOrigin, kOrigin, .198237, kTocErr, CCDM_TRANS);
}

TEST(ReportedCases, ABoxPassesABox) {
  const auto small = boxes(1, 1, 1);
  for (const auto& large : boxes(2, 2, 2))
    for (const auto& b : {small.front(), small.back()})
      expectTime(large, at(-10, 0, 0), at(10, 0, 0), b, kOrigin, kOrigin, .425, kTocErr,
                 CCDM_TRANS);
}

TEST(ReportedCases, OneCommonMotionOfTwoBoxesIsNoContact) {
  const auto box = boxes(.1, .1, .1);
  const Pose a = at(1, 0, 0), b = at(1, .102, 0);
  const Pose turn = at(0, 0, 0, kPi / 3);
  for (std::size_t i = 0; i < box.size(); ++i) {
    const auto& other = box[(i + 1) % box.size()];
    expectTime(box[i], a, at(2, 0, 0), other, b, at(2, .102, 0), 1, 0, CCDM_TRANS);
    expectTime(box[i], a, turn * a, other, b, turn * b, 1, 0, CCDM_SCREW);
  }
}

TEST(ReportedCases, AFastBallAndAThinWall) {
  const double radius = .05;
  TestMesh sphere = makeUvSphere(16, 9, radius);
  sphere.vertices.push_back(Vector(radius, 0, 0));
  const int last = static_cast<int>(sphere.vertices.size()) - 1;
  sphere.triangles.emplace_back(0, 1, last);
  std::vector<Geometry> balls = models(sphere);
  balls.push_back(std::make_shared<Sphere<double>>(radius));
  const auto walls = boxes(.01, 2, 2);
  for (const auto& ball : balls)
    for (const auto& wall : {walls.front(), walls.back()})
      expectTime(ball, at(-5, 0, 0), at(5, 0, 0), wall, kOrigin, kOrigin, .4945, kTocErr,
                 CCDM_TRANS);
}

TEST(ReportedCases, AClothFallsOnABallThatMayTurn) {
  const auto cloth_at = [](double z) {
    return makeSheet(40, 40,
                     [z](double u, double v) { return Vector(2 * u - 1, 2 * v - 1, z); });
  };
  const Geometry cloth =
      makeModel<DeformableBVHModel<OBBRSS<double>>>(cloth_at(1), cloth_at(-1));
  const Geometry ball = std::make_shared<Sphere<double>>(.5);
  const Pose turned = at(0, 0, 0, kPi / 2, Vector::UnitX());
  for (const Pose& end : {kOrigin, turned})
    for (const auto type : {CCDM_TRANS, CCDM_LINEAR, CCDM_SCREW})
      expectTime(cloth, kOrigin, kOrigin, ball, kOrigin, end, .25, kTocErr, type);
}

TEST(ReportedCases, ALargeStepTowardsASmallGap) {
  for (const double toc_err : {1e-4, 1e-9})
    for (const auto& cube : boxes(1, 1, 1))
      for (const auto& rest : boxes(1, 1, 1)) {
        Request request;
        request.toc_err = toc_err;
        Result result;
        continuousCollide(cube.get(), kOrigin, at(0, 0, -1e5), rest.get(), at(0, 0, -2),
                          at(0, 0, -2), request, result);
        ASSERT_TRUE(result.is_collide);
        EXPECT_LE(result.time_of_contact, 1e-5);
        EXPECT_GE(result.time_of_contact, .8e-5);
      }
}

TEST(ReportedCases, TwoLayersTheTightestToleranceAndTheLoosest) {
  Random random(5);
  const auto noise = [&random](double size) {
    double sum = 0;
    for (int i = 0; i < 12; ++i) sum += random.uniform(-.5, .5);
    return size * sum;
  };
  TestMesh scene = makeSheet(60, 60), end;
  const TestMesh upper = moved(scene, .0037, .0023, 1e-6);
  const std::size_t num_lower = scene.vertices.size();
  append(scene, upper);
  end = scene;
  for (std::size_t i = num_lower; i < scene.vertices.size(); ++i) {
    scene.vertices[i][2] += noise(1e-8);
    end.vertices[i] =
        scene.vertices[i] + Vector(noise(1e-3), noise(1e-3), -.05 + noise(.005));
  }
  const auto model = makeModel<DeformableBVHModel<>>(scene, end);
  ContactRequest request;
  request.query = ContinuousQuery::kFirst;
  request.toc_err = 1e-4;
  const auto loose = selfContacts<double>(*model, request);
  request.toc_err = 1e-9;
  const auto tight = selfContacts<double>(*model, request);
  ASSERT_FALSE(tight.contacts.empty());
  ASSERT_FALSE(loose.contacts.empty());
  EXPECT_LE(loose.time_of_contact, tight.contacts[0].toc_hi);
  EXPECT_GE(loose.time_of_contact, .875 * tight.time_of_contact);
  const auto is_listed = [&](const ContinuousContact<double>& c) {
    return nameOf(c) == nameOf(tight.contacts[0]);
  };
  EXPECT_TRUE(std::any_of(loose.contacts.begin(), loose.contacts.end(), is_listed));
  EXPECT_LT(loose.contacts.size(), 20u);
}

TEST(ReportedCases, CubesOverlapAtThePosesOfTheContact) {
  Random random(8);
  const auto cube = boxes(1, 1, 1);
  const auto& a = cube.front();
  int num_contacts = 0;
  for (int i = 0; i < 1000; ++i) {
    Vector from;
    do from = random.point(1);
    while (from.norm() > 1 || from.norm() < .1);
    from *= 3 / from.norm();
    const Vector to = random.point(.3);
    Result result;
    continuousCollide(a.get(), at(from[0], from[1], from[2]), at(to[0], to[1], to[2]),
                      a.get(), kOrigin, kOrigin, Request(), result);
    ASSERT_TRUE(result.is_collide);
    CollisionResult<double> overlap;
    num_contacts += collide(a.get(), result.contact_tf1, a.get(), result.contact_tf2,
                            CollisionRequest<double>(), overlap) > 0;
  }
  EXPECT_EQ(num_contacts, 1000);
}

TEST(ReportedCases, ParallelTrianglesAtADistance) {
  TestMesh low, high;
  low.vertices = {{0, 0, 0}, {1, 0, 0}, {.5, std::sqrt(.75), 0}};
  low.triangles = {{0, 1, 2}};
  high = moved(low, 0, 0, 1);
  ContactRequest request;
  request.min_distance = .2222;
  request.toc_err = kTocErr;
  const auto result =
      pairContacts<double>(*makeModel<DeformableBVHModel<>>(low),
                           *makeModel<DeformableBVHModel<>>(high, low), request);
  EXPECT_TRUE(result.is_collide);
  EXPECT_NEAR(result.time_of_contact, .7778, kTocErr);
}

TEST(ReportedCases, AllCrossingsOfTwoSheets) {
  const int n = 10;
  TestMesh scene = makeSheet(n, n, [](double u, double v) { return Vector(u, v, .013); });
  append(scene, makeSheet(n, n, [](double u, double v) { return Vector(.0071, u, v); }));
  const auto model = makeModel<DeformableBVHModel<>>(scene);
  ContactRequest request;
  request.enable_crossings = true;
  const auto result = selfContacts<double>(*model, request);
  EXPECT_TRUE(result.initially_crossing);
  EXPECT_EQ(result.time_of_contact, 0);

  // Each sheet is flat, so that an edge crosses a triangle if its ends are on both sides
  // of the plane, and the point between them is in the triangle.
  const auto side = [](double ax, double ay, double bx, double by, double px, double py) {
    return (bx - ax) * (py - ay) - (by - ay) * (px - ax);
  };
  std::size_t count = 0;
  for (const auto& edge : uniqueEdges(scene.triangles))
    for (const Triangle& t : scene.triangles) {
      const Vector &p = scene.vertices[edge[0]], &q = scene.vertices[edge[1]];
      const Vector corners[] = {scene.vertices[t[0]], scene.vertices[t[1]],
                                scene.vertices[t[2]]};
      const int axis =
          corners[0][2] == corners[1][2] && corners[1][2] == corners[2][2] ? 2 : 0;
      const double plane = corners[0][axis];
      if ((p[axis] - plane) * (q[axis] - plane) >= 0) continue;
      const Vector x = p + (plane - p[axis]) / (q[axis] - p[axis]) * (q - p);
      const int u = axis == 2 ? 0 : 1, v = axis == 2 ? 1 : 2;
      int signs = 0;
      for (int k = 0; k < 3; ++k) {
        const Vector &a = corners[k], &b = corners[(k + 1) % 3];
        signs += side(a[u], a[v], b[u], b[v], x[u], x[v]) > 0 ? 1 : -1;
      }
      count += std::abs(signs) == 3;
    }
  EXPECT_GE(count, 20u);
  EXPECT_EQ(result.crossings.size(), count);
}

}  // namespace
}  // namespace test
}  // namespace fcl
