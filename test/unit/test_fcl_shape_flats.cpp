// SPDX-License-Identifier: BSD-3-Clause
//
// Meshes against planes and halfspaces that turn: closed forms of the first time of each
// triangle, and how much is looked at for it. And the look at t = 0.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <tuple>
#include <vector>

#include "curved/curved_query.h"
#include "curved/overlap_at_start.h"
#include "fcl/common/exception.h"
#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "fcl/geometry/shape/halfspace.h"
#include "fcl/geometry/shape/plane.h"
#include "fcl/math/bv/OBBRSS.h"
#include "fcl/narrowphase/continuous_collision.h"
#include "mesh_generators.h"
#include "prepare/prepared_motion.h"

namespace fcl {
namespace test {
namespace {

using Pose = Transform3<double>;
using Point = Vector3<double>;
using Request = ContinuousContactRequest<double>;
using Result = ContinuousContactResult<double>;
using Geometry = std::shared_ptr<CollisionGeometry<double>>;

constexpr double kTimeError = 1e-11;
constexpr double kNever = 2;

Pose turnedAboutZ(double angle) {
  Pose pose = Pose::Identity();
  pose.linear() = AngleAxis<double>(angle, Point::UnitZ()).toRotationMatrix();
  return pose;
}

/// 5,000 triangles around a point, with bumps so that no two vertices touch at once.
TestMesh bumpyBall(const Point& center) {
  TestMesh mesh = makeUvSphere(50, 51, 0.5);
  for (Point& p : mesh.vertices)
    p = center + (1 + 0.1 * std::sin(9 * p[0] + 1) * std::sin(7 * p[1] + p[2])) * p;
  return mesh;
}

Geometry modelOf(const TestMesh& mesh) {
  auto model = std::make_shared<BVHModel<OBBRSS<double>>>();
  model->beginModel();
  model->addSubModel(mesh.vertices, mesh.triangles);
  model->endModel();
  return model;
}

Geometry flatOf(const std::string& kind, const Point& normal, double offset) {
  if (kind == "plane") return std::make_shared<Plane<double>>(normal, offset);
  return std::make_shared<Halfspace<double>>(normal, offset);
}

Request requestOf(ContinuousQuery query) {
  Request request;
  request.ccd_motion_type = CCDM_LINEAR;
  request.toc_err = 1e-9;
  request.query = query;
  request.num_max_contacts = 100000;
  return request;
}

double angleOf(const Point& p) { return std::atan2(p[1], p[0]); }
double radiusOf(const Point& p) { return std::hypot(p[0], p[1]); }

class MeshAndFlat : public testing::TestWithParam<std::string> {
 protected:
  /// Expects the first time of each triangle; kNever: none.
  static void expectTimes(const Result& result, const std::vector<double>& times,
                          bool mesh_is_first) {
    std::vector<double> found(times.size(), kNever);
    for (const auto& contact : result.contacts)
      found[static_cast<std::size_t>(mesh_is_first ? contact.b1 : contact.b2)] =
          contact.toc_lo;
    for (std::size_t i = 0; i < times.size(); ++i) {
      EXPECT_LE(found[i], times[i]);
      EXPECT_NEAR(found[i], times[i], kTimeError);
    }
  }

  template <typename TimeOf>
  static std::vector<double> timesOf(const TestMesh& mesh, const TimeOf& time_of) {
    std::vector<double> times;
    for (const Triangle& t : mesh.triangles) {
      double first = kNever;
      for (int k = 0; k < 3; ++k) {
        const double time = time_of(mesh.vertices[t[k]]);
        if (time <= 1) first = std::min(first, time);
      }
      times.push_back(first);
    }
    return times;
  }
};

// The plane y = 0 turns about z. The height of a point at the angle a and the distance r
// from the axis is r sin(a - w t); it comes down to d at w t = a - asin(d / r).
TEST_P(MeshAndFlat, AFlatTurnsIntoAMesh) {
  constexpr double kTurn = 2;
  const TestMesh mesh = bumpyBall({0.2, 1.3, 0});
  const Geometry model = modelOf(mesh), flat = flatOf(GetParam(), Point::UnitY(), 0);
  const Pose still = Pose::Identity();
  for (const double distance : {0., 0.1}) {
    Request request = requestOf(ContinuousQuery::kAll);
    request.min_distance = distance;
    const std::vector<double> times = timesOf(mesh, [&](const Point& p) {
      return (angleOf(p) - std::asin(distance / radiusOf(p))) / kTurn;
    });
    Result all, first;
    continuousCollide(flat.get(), still, turnedAboutZ(kTurn), model.get(), still, still,
                      request, all);
    EXPECT_EQ(all.contacts.size(), mesh.triangles.size());
    expectTimes(all, times, false);
    // The mesh turns the other way.
    continuousCollide(model.get(), still, turnedAboutZ(-kTurn), flat.get(), still, still,
                      request, all);
    expectTimes(all, times, true);
    request.query = ContinuousQuery::kFirst;
    continuousCollide(flat.get(), still, turnedAboutZ(kTurn), model.get(), still, still,
                      request, first);
    EXPECT_NEAR(first.time_of_contact, *std::min_element(times.begin(), times.end()),
                kTimeError);
    EXPECT_LT(first.counts.node_pairs, 2000u);
  }
}

// A mesh turns below the plane y = Y. Its vertices come to y = r sin(a + w t), at most r.
TEST_P(MeshAndFlat, AMeshTurnsAndGrazesAFlat) {
  constexpr double kTurn = 2.5;
  const TestMesh mesh = bumpyBall({1.2, -0.4, 0});
  const Geometry model = modelOf(mesh);
  double top = 0;
  for (const Point& p : mesh.vertices) top = std::max(top, radiusOf(p));
  const Pose still = Pose::Identity();
  for (const double share : {1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-9})
    for (const bool touches : {false, true}) {
      SCOPED_TRACE(touches ? -share : share);
      const double height = top * (touches ? 1 - share : 1 + share);
      const Geometry flat = flatOf(GetParam(), -Point::UnitY(), -height);
      Result result;
      continuousCollide(model.get(), still, turnedAboutZ(kTurn), flat.get(), still, still,
                        requestOf(ContinuousQuery::kFirst), result);
      EXPECT_EQ(result.is_collide, touches);
      EXPECT_LT(result.counts.node_pairs, 10000u);
      if (!touches) continue;
      const std::vector<double> times = timesOf(mesh, [height](const Point& p) {
        if (radiusOf(p) < height) return kNever;
        return (std::asin(height / radiusOf(p)) - angleOf(p)) / kTurn;
      });
      const double time = *std::min_element(times.begin(), times.end());
      EXPECT_LE(result.time_of_contact, time + 1e-15);
      // A graze is early by at most sqrt(2 tau / kappa).
      EXPECT_NEAR(result.time_of_contact, time, 1e-7);
    }
}

template <typename BV>
Geometry deformingModelOf(const TestMesh& mesh) {
  auto model = std::make_shared<DeformableBVHModel<BV>>();
  model->beginModel();
  model->addSubModel(mesh.vertices, mesh.triangles);
  model->endModel();
  std::vector<Point> moved = mesh.vertices;
  for (Point& p : moved) p *= 1 + 0.2 * std::sin(5 * p[0] + p[2]);
  model->beginUpdateModel();
  model->updateSubModel(moved);
  model->endUpdateModel();
  return model;
}

Pose randomPose(Random& random, double way) {
  Pose pose = Pose::Identity();
  pose.linear() =
      AngleAxis<double>(random.uniform(0, 3), random.point(1).normalized()).matrix();
  pose.translation() = random.point(way);
  return pose;
}

/// What the look at t = 0 says, and what the query says without it.
struct Look {
  bool is_touch;
  double time;

  Look(const Geometry& a, const Pose (&pose_a)[2], const Geometry& b,
       const Pose (&pose_b)[2]) {
    using namespace detail;
    using deformable::PreparedMotion;
    const auto moving_a = movingGeometry(a.get(), pose_a[0], pose_a[1], PathKind::kTurn),
               moving_b = movingGeometry(b.get(), pose_b[0], pose_b[1], PathKind::kTurn);
    const PreparedMotion mesh(PlacedGeometry<double>(moving_a), "o1", 1e-6, 1),
        flat(PlacedGeometry<double>(moving_b), "o2", 1e-6, 1, mesh.body().size());
    is_touch = overlapDeeplyAtStart(mesh.body(), flat.body());
    EXPECT_EQ(overlapDeeplyAtStart(flat.body(), mesh.body()), is_touch);
    deformable::QueryOptions options;
    options.query = ContinuousQuery::kFirst;
    const auto answer = queryCurved(mesh.body(), flat.body(),
                                    curvedOptionsOf(mesh.body(), flat.body(), options));
    time = answer.contacts.empty() ? kNever : answer.contacts[0].toc_lo;
  }
};

// Poses in which the lowest vertex is at a depth below the flat.
TEST_P(MeshAndFlat, TheLookAtTheBeginningChangesNoAnswer) {
  const TestMesh mesh = bumpyBall({0.2, 0.1, 0.3});
  const std::vector<Geometry> models = {modelOf(mesh),
                                        deformingModelOf<AABB<double>>(mesh),
                                        deformingModelOf<OBBRSS<double>>(mesh)};
  Random random(41);
  int touching = 0, found = 0;
  for (const double depth : {0.5, 0.1, 1e-3, 1e-9, 1e-12, 1e-14, 1e-15, 1e-16, 0., -1e-16,
                             -1e-15, -1e-14, -1e-12, -1e-9, -1e-3, -0.3})
    for (int round = 0; round < 30; ++round) {
      SCOPED_TRACE(depth);
      const Geometry& model = models[static_cast<std::size_t>(round % 3)];
      const Pose pose[2] = {randomPose(random, 4), randomPose(random, 4)};
      const Point n = random.point(1).normalized();
      double lowest = 1e9;
      for (const Point& p : mesh.vertices) lowest = std::min(lowest, n.dot(pose[0] * p));
      Pose flat_pose[2] = {randomPose(random, 4), randomPose(random, 4)};
      const Point in_flat = flat_pose[0].linear().transpose() * n;
      const double offset = lowest + depth - n.dot(flat_pose[0].translation());
      const Geometry flat = flatOf(GetParam(), in_flat, offset);
      const Look look(model, pose, flat, flat_pose);
      touching += depth >= 1e-3;
      found += look.is_touch;
      if (depth >= 1e-12) {
        EXPECT_EQ(look.time, 0);
      }
      if (depth <= 1e-9) {
        EXPECT_FALSE(look.is_touch);
      }
      ContinuousCollisionRequest<double> request;
      request.ccd_motion_type = CCDM_LINEAR;
      request.toc_err = 1e-6;
      ContinuousCollisionResult<double> result;
      continuousCollide(model.get(), pose[0], pose[1], flat.get(), flat_pose[0],
                        flat_pose[1], request, result);
      EXPECT_EQ(result.is_collide ? double{result.time_of_contact} : kNever, look.time);
    }
  // The way down the tree may end beside the one vertex that is below.
  EXPECT_GT(found, touching / 3);
}

INSTANTIATE_TEST_SUITE_P(, MeshAndFlat, testing::Values("plane", "halfspace"),
                         [](const testing::TestParamInfo<std::string>& info) {
                           return info.param;
                         });

/// FCL's constructors make the normal a unit vector; a program that writes it may not.
TEST(FCL_SHAPE_FLATS, normalsOfAllLengths) {
  const auto ball = std::make_shared<Sphere<double>>(0.5);
  Pose begin = Pose::Identity(), end = Pose::Identity();
  begin.translation()[0] = 4;
  const Pose still = Pose::Identity();
  for (int exponent = -1060; exponent <= 1020; exponent += 20) {
    Halfspace<double> half(Point::UnitX(), 1);
    const double size = std::ldexp(1, exponent);
    half.n *= size;
    half.d *= size;
    Request request = requestOf(ContinuousQuery::kFirst);
    Result result;
    continuousCollide(ball.get(), begin, end, &half, still, still, request, result);
    ASSERT_TRUE(result.is_collide) << exponent;
    EXPECT_NEAR(result.time_of_contact, 2.5 / 4, kTimeError) << exponent;
  }
}

/// The difference of their offsets would not be finite.
TEST(FCL_SHAPE_FLATS, offsetsBeyondTheRange) {
  const Pose still = Pose::Identity();
  const Halfspace<double> below(Point::UnitZ(), -1e308), above(-Point::UnitZ(), -1e308),
      near(-Point::UnitZ(), -1);
  Result result;
  for (const auto& [o1, o2, name] :
       {std::make_tuple(&below, &above, "o1"), std::make_tuple(&near, &above, "o2")}) {
    try {
      continuousCollide(o1, still, still, o2, still, still, Request(), result);
      ADD_FAILURE() << name;
    } catch (const Exception& error) {
      EXPECT_EQ(std::string(error.what()).find(name), 0U) << error.what();
    }
  }
}

}  // namespace
}  // namespace test
}  // namespace fcl
