// SPDX-License-Identifier: BSD-3-Clause
//
// What queries on curved paths cost: the number of spans of turning meshes, and the work
// for parts of a mesh that are tiny or have no extent.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "curved/chord_pairs.h"
#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "fcl/geometry/shape/box.h"
#include "fcl/geometry/shape/cylinder.h"
#include "fcl/geometry/shape/ellipsoid.h"
#include "fcl/geometry/shape/halfspace.h"
#include "fcl/geometry/shape/plane.h"
#include "fcl/geometry/shape/sphere.h"
#include "fcl/math/bv/OBBRSS.h"
#include "fcl/math/motion/interp_motion.h"
#include "fcl/math/motion/spline_motion.h"
#include "fcl/narrowphase/continuous_collision.h"
#include "mesh_generators.h"
#include "test_models.h"
#include "turning_bodies.h"

namespace fcl {
namespace test {
namespace {

using detail::deformable::ChordSearch;
using detail::deformable::MotionPath;
using detail::deformable::QueryOptions;
using Rigid = BVHModel<OBBRSS<double>>;
using Deforming = DeformableBVHModel<>;
using Geometry = std::shared_ptr<CollisionGeometry<double>>;
using Motion = std::shared_ptr<MotionBase<double>>;
using Request = ContinuousContactRequest<double>;
using Result = ContinuousContactResult<double>;

const Vector3<double> kOrigin = Vector3<double>::Zero();

/// Between two poses of which the second is turned by an angle about (0.3, 0.5, 1).
MotionPath turnBy(double angle) {
  const Vector3<double> axis = Vector3<double>(0.3, 0.5, 1).normalized();
  const Matrix3<double> end = AngleAxis<double>(angle, axis).toRotationMatrix();
  detail::deformable::Pose from, to;
  for (int i = 0; i < 9; ++i) to.rotation[i] = end(i / 3, i % 3);
  return MotionPath::interpolation(from, to, {0, 0, 0});
}

/// From minus an angle to an angle.
MotionPath splineBy(double angle) {
  const double still[4][3] = {};
  double turn[4][3] = {};
  const double share[4] = {-2, -1, 1, 2};
  for (int i = 0; i < 4; ++i) turn[i][2] = share[i] * angle;
  return MotionPath::spline(still, turn);
}

/// The number of spans beyond 16 grows in proportion to the angle.
TEST(FCL_MOTION_COSTS, spansOfTurnsGrowInProportion) {
  const Body ball(makeGeodesicSphere(16, 1));
  const BodyOnPath resting(ball, MotionPath::still(detail::deformable::Pose()));
  for (const double distance : {0., 0.01})
    for (const bool is_spline : {false, true}) {
      SCOPED_TRACE(is_spline);
      QueryOptions options;
      options.query = ContinuousQuery::kAll;
      options.min_distance = distance;
      double spans_per_angle = 0;
      for (double angle = 0.1; angle < (is_spline ? 20 : M_PI); angle += 0.1) {
        const BodyOnPath turning(ball, is_spline ? splineBy(angle) : turnBy(angle));
        ASSERT_TRUE(ChordSearch::isFor(turning.body, resting.body, options));
        const int spans = ChordSearch(turning.body, resting.body, options).numSpans();
        ASSERT_GT(spans, 0) << angle;
        if (spans_per_angle == 0 && spans > 16) spans_per_angle = spans / angle;
        if (spans > 16) {
          EXPECT_LE(spans, 1.01 * spans_per_angle * angle + 1) << angle;
        }
      }
    }
}

Motion motionOf(double angle, const Vector3<double>& from, const Vector3<double>& to) {
  const Matrix3<double> unit = Matrix3<double>::Identity(),
                        end = AngleAxis<double>(angle,
                                                Vector3<double>(0.3, 0.5, 1).normalized())
                                  .toRotationMatrix();
  return std::make_shared<InterpMotion<double>>(unit, from, end, to, kOrigin);
}

Motion splineOf(double angle) {
  const Vector3<double> turn(0.3 * angle, 0.5 * angle, angle);
  return std::make_shared<SplineMotion<double>>(kOrigin, kOrigin, kOrigin, kOrigin,
                                                kOrigin, 0.2 * turn, 0.7 * turn, turn);
}

struct Shape {
  std::string name;
  Geometry geometry;
  /// Whether it contains the point (0.2, 0.1, 0) during every turn.
  bool contains_point;
};

std::vector<Shape> shapes() {
  return {
      {"box", std::make_shared<Box<double>>(1, 1, 1), true},
      {"sphere", std::make_shared<Sphere<double>>(0.6), true},
      {"cylinder", std::make_shared<Cylinder<double>>(0.5, 1), true},
      {"ellipsoid", std::make_shared<Ellipsoid<double>>(0.5, 0.6, 0.7), true},
      {"halfspace", std::make_shared<Halfspace<double>>(Vector3<double>(0, 0, 1), 0.5),
       true},
      {"plane", std::make_shared<Plane<double>>(Vector3<double>(0, 0, 1), 0.5), false}};
}

/// Adds triangles whose corners are within `size` of a point.
TestMesh withSpecks(TestMesh mesh, int count, double size, const Vector3<double>& at) {
  Random random(8);
  for (int i = 0; i < count; ++i) {
    const std::size_t first = mesh.vertices.size();
    for (int k = 0; k < 3; ++k) mesh.vertices.push_back(at + random.point(size));
    mesh.triangles.emplace_back(first, first + 1, first + 2);
  }
  return mesh;
}

Geometry modelOf(const TestMesh& mesh, bool deforms) {
  if (!deforms) return makeModel<Rigid>(mesh);
  TestMesh later = mesh;
  for (Vector3<double>& p : later.vertices) p *= 1.001;
  return makeModel<Deforming>(mesh, later);
}

Result ask(const Geometry& a, const Motion& of_a, const Geometry& b, const Motion& of_b,
           const Request& request) {
  Result result;
  continuousCollide(a.get(), of_a.get(), b.get(), of_b.get(), request, result);
  return result;
}

Request allContacts(double distance = 0) {
  Request request;
  request.query = ContinuousQuery::kAll;
  request.num_max_contacts = static_cast<std::size_t>(-1);
  request.min_distance = distance;
  return request;
}

/// The times of the contacts of a mesh with a shape, by triangle.
std::map<std::intptr_t, double> timesOf(const Result& result) {
  std::map<std::intptr_t, double> times;
  for (const auto& contact : result.contacts) times[contact.b1] = contact.toc_lo;
  return times;
}

void expectSpecksCostLittle(const Shape& shape, const TestMesh& ball, double size,
                            bool deforms, double distance) {
  constexpr int kSpecks = 8;
  const Vector3<double> at(0.2, 0.1, 0);
  const Geometry plain = modelOf(ball, deforms),
                 specked = modelOf(withSpecks(ball, kSpecks, size, at), deforms);
  const auto num_triangles = static_cast<std::intptr_t>(ball.triangles.size());
  const Motion still = motionOf(0, kOrigin, kOrigin),
               turn = motionOf(1.5, kOrigin, kOrigin),
               passing = motionOf(1.5, {0.1, 0, 0}, {0.3, 0, 0}), spline = splineOf(2);
  const std::pair<Motion, Motion> motions[] = {
      {still, still}, {still, turn}, {turn, still}, {passing, turn}, {still, spline}};
  for (const auto& [of_mesh, of_shape] : motions) {
    const Request request = allContacts(distance);
    const Result before = ask(plain, of_mesh, shape.geometry, of_shape, request),
                 after = ask(specked, of_mesh, shape.geometry, of_shape, request);
    const auto times = timesOf(after);
    std::size_t num_plain = 0, num_specks = 0;
    for (const auto& [id, time] : times) (id < num_triangles ? num_plain : num_specks)++;
    EXPECT_EQ(num_plain, before.contacts.size());
    for (const auto& [id, time] : timesOf(before)) {
      const auto it = times.find(id);
      if (it == times.end())
        ADD_FAILURE() << "missed: triangle " << id;
      else
        EXPECT_NEAR(it->second, time, 1e-9);
    }
    if (shape.contains_point) {
      EXPECT_EQ(num_specks, static_cast<std::size_t>(kSpecks));
      EXPECT_EQ(after.time_of_contact, 0);
    }
    // The trees differ a little. A speck alone took thousands of pairs before.
    const auto work = [](const Result& r) {
      return r.counts.node_pairs + r.counts.triangle_pairs;
    };
    EXPECT_LE(work(after), work(before) + work(before) / 4 + 60 * kSpecks);
  }
}

TEST(FCL_MOTION_COSTS, partsWithoutExtent) {
  const TestMesh ball = makeUvSphere(24, 25, 1);
  for (const Shape& shape : shapes())
    for (const double size : {0., 1e-10, 1e-6})
      for (const bool deforms : {false, true}) {
        SCOPED_TRACE(shape.name + ", " + std::to_string(size));
        expectSpecksCostLittle(shape, ball, size, deforms, 0);
      }
  expectSpecksCostLittle(shapes()[0], ball, 0, false, 1e-3);
}

/// A mesh of 12 triangles that is tiny beside a shape: inside of it, on its surface, and
/// at a small gap.
TEST(FCL_MOTION_COSTS, tinyMeshBesideLargeShape) {
  constexpr double kTiny = 2e-9, kLarge = 6e3, kMost = 12 * 64;
  const Geometry mesh = modelOf(makeBox({kTiny, kTiny, kTiny}, 1), false);
  const Geometry shape = std::make_shared<Box<double>>(kLarge, kLarge, kLarge);
  for (const double height : {0.1 * kLarge, 0.5 * kLarge, 0.5 * kLarge + 1}) {
    SCOPED_TRACE(height);
    const Vector3<double> at(0.01 * kLarge, 0.02 * kLarge, height);
    for (const auto query : {ContinuousQuery::kAll, ContinuousQuery::kFirst}) {
      Request request = allContacts();
      request.query = query;
      const Result result =
          ask(mesh, motionOf(0, at, at), shape, motionOf(1.5, kOrigin, kOrigin), request);
      EXPECT_LE(result.counts.node_pairs, kMost);
      EXPECT_LE(result.counts.triangle_pairs, kMost);
      if (height < 0.5 * kLarge) {
        EXPECT_EQ(result.time_of_contact, 0);
        if (query == ContinuousQuery::kAll) {
          EXPECT_EQ(result.contacts.size(), 12U);
        }
      }
    }
  }
}

/// A tube that turns in another one, near to it during the whole step: that there is no
/// contact takes all contacts about as long as the first one. Chords took 15 times that.
TEST(FCL_MOTION_COSTS, allContactsOfATubeThatTurnsInATube) {
  constexpr int kSlices = 400, kRings = 100;
  const auto tube = [](double radius) {
    return modelOf(makeRoundTube(kSlices, kRings, [=](double, double) { return radius; }),
                   false);
  };
  const Geometry inner = tube(0.998), outer = tube(1 / std::cos(M_PI / kSlices));
  const Matrix3<double> unit = Matrix3<double>::Identity();
  for (const double degrees : {0.5, 5., 30.}) {
    SCOPED_TRACE(degrees);
    const Matrix3<double> end =
        AngleAxis<double>(degrees * M_PI / 180, Vector3<double>::UnitZ())
            .toRotationMatrix();
    const Motion turning = std::make_shared<InterpMotion<double>>(unit, kOrigin, end,
                                                                  kOrigin, kOrigin),
                 still = std::make_shared<InterpMotion<double>>(unit, kOrigin, unit,
                                                                kOrigin, kOrigin);
    std::size_t tests[2];
    for (const bool all : {false, true}) {
      Request request;
      request.query = all ? ContinuousQuery::kAll : ContinuousQuery::kFirst;
      const Result result = ask(inner, turning, outer, still, request);
      EXPECT_FALSE(result.is_collide);
      EXPECT_TRUE(result.contacts.empty());
      tests[all ? 1 : 0] = result.counts.node_pairs;
    }
    EXPECT_LE(static_cast<double>(tests[1]), 1.05 * static_cast<double>(tests[0]));
  }
}

}  // namespace
}  // namespace test
}  // namespace fcl
