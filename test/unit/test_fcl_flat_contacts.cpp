// SPDX-License-Identifier: BSD-3-Clause
//
// Flat sides that come to lie on flat sides: hundreds of pairs of triangles, shapes and
// cells touch at the same time, up to rounding. Against closed forms, and against the
// query for all contacts, which decides each pair.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "bodies/parting_direction.h"
#include "curved/curved_query.h"
#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "fcl/geometry/octree/octree.h"
#include "fcl/geometry/shape/box.h"
#include "fcl/geometry/shape/cylinder.h"
#include "fcl/geometry/shape/halfspace.h"
#include "fcl/geometry/shape/plane.h"
#include "fcl/math/bv/OBBRSS.h"
#include "prepare/prepared_motion.h"
#include "sanitizer.h"
#include "test_models.h"
#include "turning_bodies.h"

namespace fcl {
namespace test {
namespace {

using Point = Vector3<double>;
using Geometry = std::shared_ptr<CollisionGeometry<double>>;
using Pose = Transform3<double>;
using Request = ContinuousContactRequest<double>;
using Result = ContinuousContactResult<double>;

constexpr double kResolution = 0.125;
/// Sheets are lowered from z = 1 to z = -1 on grounds whose top is at z = 0.
constexpr double kWay = 2;

Pose at(double z, double turn) {
  Pose pose = Pose::Identity();
  pose.translation() << 0.013, 0.017, z;
  pose.linear() = AngleAxis<double>(turn, Point::UnitZ()).toRotationMatrix();
  return pose;
}

/// A flat sheet of 1152 triangles with one vertex that is lower by a depth.
TestMesh sheetWithBump(double depth, std::size_t vertex, double z = 0) {
  TestMesh sheet = makeSheet(
      24, 24, [z](double u, double v) { return Point(2 * u - 1, 2 * v - 1, z); });
  sheet.vertices[vertex][2] -= depth;
  return sheet;
}

Geometry rigid(const TestMesh& mesh) { return makeModel<BVHModel<OBBRSS<double>>>(mesh); }

/// Each cell has another weight, so that nothing is pruned.
Geometry floorOfCells() {
  const auto map = std::make_shared<octomap::OcTree>(kResolution);
  for (int x = -12; x < 12; ++x)
    for (int y = -12; y < 12; ++y) {
      const octomap::OcTreeKey key(static_cast<std::uint16_t>(32768 + x),
                                   static_cast<std::uint16_t>(32768 + y), 32767);
      map->setNodeValue(key, 1 + 0.01f * static_cast<float>((x + y) & 7), true);
    }
  map->updateInnerOccupancy();
  return std::make_shared<OcTree<double>>(std::shared_ptr<const octomap::OcTree>(map));
}

struct Ground {
  const char* name;
  Geometry geometry;
  double top;
};

std::vector<Ground> grounds() {
  return {{"cells", floorOfCells(), 0},
          {"box", std::make_shared<Box<double>>(3, 3, 1), 0.5},
          {"cylinder", std::make_shared<Cylinder<double>>(2, 1), 0.5},
          {"halfspace", std::make_shared<Halfspace<double>>(Point(0, 0, 1), 0), 0},
          {"plane", std::make_shared<Plane<double>>(Point(0, 0, -1), 0), 0},
          {"sheet", rigid(sheetWithBump(0, 0)), 0}};
}

struct Scene {
  Geometry sheet;
  Pose begin, end;
  const Ground& ground;

  Result ask(const Request& request, bool is_swapped = false) const {
    Pose place = Pose::Identity();
    place.translation()[2] = -ground.top;
    Result result;
    if (is_swapped)
      continuousCollide(ground.geometry.get(), place, place, sheet.get(), begin, end,
                        request, result);
    else
      continuousCollide(sheet.get(), begin, end, ground.geometry.get(), place, place,
                        request, result);
    return result;
  }
};

Request requestOf(ContinuousQuery query, double distance = 0) {
  Request request;
  request.query = query;
  request.ccd_motion_type = CCDM_LINEAR;
  request.min_distance = distance;
  return request;
}

/// @return the number of pairs that a query for the first contact decides one by one
std::uint64_t numPairs(const Scene& scene, const Pose& place, bool is_swapped,
                       double distance) {
  using namespace detail;
  using deformable::PreparedMotion;
  const auto moving = movingGeometry(scene.sheet.get(), scene.begin, scene.end,
                                     PathKind::kTurn),
             resting = movingGeometry(scene.ground.geometry.get(), place, place,
                                      PathKind::kTurn);
  const PreparedMotion sheet(PlacedGeometry<double>(moving), "o1", 1e-4, 1),
      ground(PlacedGeometry<double>(resting), "o2", 1e-4, 1, sheet.body().size());
  const auto &a = is_swapped ? ground : sheet, &b = is_swapped ? sheet : ground;
  deformable::QueryOptions options;
  options.query = ContinuousQuery::kFirst;
  options.min_distance = distance;
  return queryCurved(a.body(), b.body(), curvedOptionsOf(a.body(), b.body(), options))
      .counts.triangle_pairs;
}

/// @return the largest number of pairs that were decided one by one
std::uint64_t expectFirst(const Scene& scene, double time, double distance = 0) {
  Pose place = Pose::Identity();
  place.translation()[2] = -scene.ground.top;
  std::uint64_t num_pairs = 0;
  for (const bool is_swapped : {false, true}) {
    const Result first =
        scene.ask(requestOf(ContinuousQuery::kFirst, distance), is_swapped);
    EXPECT_TRUE(first.is_collide);
    EXPECT_LE(first.time_of_contact, time + 1e-15);
    EXPECT_NEAR(first.time_of_contact, time, 1e-11);
    num_pairs = std::max(num_pairs, numPairs(scene, place, is_swapped, distance));
  }
  Request all = requestOf(ContinuousQuery::kAll, distance);
  all.t_max = std::min(1., time + 1e-6);
  EXPECT_NEAR(scene.ask(all).time_of_contact, time, 1e-11);
  return num_pairs;
}

// The bump touches first, however small it is. What the other pairs would give is late.
TEST(FlatContacts, TheLowestVertexIsFirst) {
  Random random(1);
  for (const Ground& ground : grounds())
    for (const double turn : {0., 1.})
      for (const double depth : {1e-3, 1e-6, 1e-9, 1e-11, 0.}) {
        // Sheets that do not turn are decided exactly.
        if (turn == 0 && ground.name == std::string("sheet")) continue;
        SCOPED_TRACE(std::string(ground.name) + ", turn " + std::to_string(turn) +
                     ", depth " + std::to_string(depth));
        const std::size_t vertex = 25 * (3 + random.index(18)) + 3 + random.index(18);
        const Scene scene{rigid(sheetWithBump(depth, vertex)), at(1, 0), at(-1, turn),
                          ground};
        EXPECT_LT(expectFirst(scene, (1 - depth) / kWay), 400u);
        expectFirst(scene, (1 - depth - 0.01) / kWay, 0.01);
      }
}

TEST(FlatContacts, SheetsThatDeform) {
  Random random(2);
  for (const Ground& ground : grounds())
    for (const double depth : {1e-3, 1e-6, 1e-9, 0.}) {
      SCOPED_TRACE(std::string(ground.name) + ", depth " + std::to_string(depth));
      const std::size_t vertex = 25 * (3 + random.index(18)) + 3 + random.index(18);
      const auto cloth = makeModel<DeformableBVHModel<KDOP<double, 16>>>(
          sheetWithBump(0, vertex, 1.1), sheetWithBump(depth, vertex, -0.9));
      // It turns as well, or else two meshes are decided exactly.
      const Scene scene{cloth, at(0, 0), at(0, 0.5), ground};
      EXPECT_LT(expectFirst(scene, 1.1 / (2 + depth)), 400u);
    }
}

/// Turns about an axis that is tilted from the vertical.
Pose tilted(double z, double tilt, double turn) {
  Pose pose = Pose::Identity();
  pose.translation()[2] = z;
  pose.linear() =
      (AngleAxis<double>(tilt, Point::UnitY()) * AngleAxis<double>(turn, Point::UnitZ()))
          .toRotationMatrix();
  return pose;
}

// Nothing is accelerated along the axis of a turn.
TEST(FlatContacts, SheetsThatTurnAboveAGround) {
  const Geometry sheet = rigid(sheetWithBump(0, 0)),
                 cloth = makeModel<DeformableBVHModel<KDOP<double, 16>>>(
                     sheetWithBump(0, 0, 0.1), sheetWithBump(0, 0, 0));
  for (const Ground& ground : grounds())
    for (const Geometry& mesh : {sheet, cloth})
      for (const double tilt : {0., 1e-5}) {
        SCOPED_TRACE(ground.name);
        const Scene scene{mesh, tilted(1e-3, tilt, -1), tilted(1e-3, tilt, 1), ground};
        const Result result = scene.ask(requestOf(ContinuousQuery::kFirst));
        EXPECT_FALSE(result.is_collide);
        EXPECT_LT(result.counts.node_pairs, 300u);
      }
}

// A bar turns about its end. The axis is tilted, so that the other end comes down.
TEST(FlatContacts, BarsThatTurnAboutATiltedAxis) {
  constexpr double kHalfWidth = 0.01, kFrom = -2, kTurn = 1.5;
  const auto frame = [](double z) {
    return makeSheet(
        20, 1, [z](double u, double v) { return Point(u, kHalfWidth * (2 * v - 1), z); });
  };
  const Geometry bar = rigid(frame(0));
  for (const Ground& ground : grounds())
    for (const double tilt : {1e-1, 1e-2, 1e-3, 1e-5})
      for (const double share : {0.1, 0.5, 0.8}) {
        SCOPED_TRACE(std::string(ground.name) + ", tilt " + std::to_string(tilt));
        // The corner ahead is at the height z - r sin(tilt) cos(angle).
        const double ahead = std::atan(kHalfWidth), radius = std::hypot(1, kHalfWidth),
                     z = share * radius * std::sin(tilt),
                     time = (-kFrom - ahead - std::acos(share)) / kTurn;
        const Scene scene{bar, tilted(z, tilt, kFrom), tilted(z, tilt, kFrom + kTurn),
                          ground};
        const Result first = scene.ask(requestOf(ContinuousQuery::kFirst));
        EXPECT_TRUE(first.is_collide);
        // The height rounds, and so does the time.
        const double rounding = 1e-15 / tilt;
        EXPECT_LE(first.time_of_contact, time + rounding);
        EXPECT_NEAR(first.time_of_contact, time, 1e-11 + 400 * rounding);
      }
}

using detail::deformable::BodyTolerance;
using detail::deformable::ConvexShape;
using detail::deformable::FlatShape;
using detail::deformable::MovingBody;
using detail::deformable::PartingDirection;
using detail::deformable::Vec;

/// A turn of about a radian near a place.
ReferenceMotion turnNear(const Point& place, Random& random) {
  ReferenceMotion motion;
  motion.turn(random.point(1) + Point(0, 0, 2), random.uniform(0.5, 1.5));
  motion.end.translation() = random.point(0.5);
  motion.move(place);
  return motion;
}

/// The least and the greatest coordinate of the vertices along a direction.
std::array<double, 2> rangeOf(const Body& body, const RealPose& pose,
                              const RealVector& direction) {
  Real least = HUGE_VAL, most = -HUGE_VAL;
  for (const Point& x : body.mesh.vertices) {
    const Real along = direction.dot(pose * x);
    least = std::min(least, along);
    most = std::max(most, along);
  }
  return {static_cast<double>(least), static_cast<double>(most)};
}

/// Sets a direction so often that all triangles may be looked at.
void setDirection(const Point& direction, PartingDirection& parting) {
  const Point n = direction.normalized();
  for (int i = 0; i < 100; ++i) parting.set({n[0], n[1], n[2]});
}

TEST(FlatContacts, GapsOfMeshes) {
  Random random(4);
  const Body ball(makeIcosphere(2, 0.5));
  const ReferenceMotion motion_a = turnNear(Point(0, 0, 0), random),
                        motion_b = turnNear(Point(0, 0, 5), random);
  const BodyOnPath a(ball, motion_a.path()), b(ball, motion_b.path());
  const BodyTolerance tolerance(a.body, b.body, 0.25);
  PartingDirection parting(a.body, b.body, tolerance);
  Point direction;
  for (int i = 0; i < rounds(2000); ++i) {
    if (i % rounds(500) == 0) {
      direction = (random.point(0.3) + Point(0, 0, 1)).normalized();
      setDirection(direction, parting);
    }
    const double t[2] = {random.uniform(0, 1), 0.5};
    double gap[2];
    ASSERT_TRUE(parting.areApart(a.body.root(), b.body.root(), t, gap));
    for (auto end : {0, 1}) {
      const RealVector n = direction.cast<Real>();
      const double expected = rangeOf(ball, motion_b.at(t[end]), n)[0] -
                              rangeOf(ball, motion_a.at(t[end]), n)[1];
      EXPECT_NEAR(gap[end], expected - 0.25, 1e-11);
    }
  }
}

TEST(FlatContacts, GapsBesidePlanes) {
  Random random(5);
  const Body ball(makeIcosphere(1, 0.5));
  int num_apart = 0;
  for (const double side : {1., -1.})
    for (const bool is_first : {false, true}) {
      const ReferenceMotion motion = turnNear(Point(0, 0, 4 * side), random),
                            turn = turnNear(Point(0, 0, 0), random);
      const BodyOnPath moving(ball, motion.path());
      const ConvexShape plane = ConvexShape::flat({Vec{0, 0, 1}, 0.5, false}, 9);
      const MovingBody flat(plane, turn.path());
      const MovingBody &a = is_first ? flat : moving.body,
                       &b = is_first ? moving.body : flat;
      PartingDirection parting(a, b, BodyTolerance(a, b, 0));
      setDirection(Point(0, 0, is_first ? side : -side), parting);
      for (int i = 0; i < 100; ++i) {
        const double t[2] = {random.uniform(0, 0.3), random.uniform(0, 0.3)};
        double gap[2];
        if (!parting.areApart(a.root(), b.root(), t, gap)) continue;
        ++num_apart;
        for (auto end : {0, 1}) {
          const RealPose pose = turn.at(t[end]);
          const RealVector up = pose.rotation * RealVector(0, 0, 1);
          const auto range = rangeOf(ball, motion.at(t[end]), up);
          const auto foot = static_cast<double>(up.dot(pose * Point(0, 0, 0.5)));
          EXPECT_NEAR(gap[end], side > 0 ? range[0] - foot : foot - range[1], 1e-11);
        }
      }
    }
  EXPECT_GT(num_apart, 300);
}

// A plane turns over, so that its normal points to the ball first and away from it then.
// What is known of the ball along the normal at a time is not used for the other side.
TEST(FlatContacts, GapsBesideAPlaneThatTurnsOver) {
  for (const double offset : {50., -50.})
    for (const bool is_first : {false, true}) {
      SCOPED_TRACE(offset);
      TestMesh mesh = makeIcosphere(1, 0.5);
      for (auto& x : mesh.vertices) x += Point(0, 0, offset);
      const Body ball(mesh);
      ReferenceMotion still, turn;
      still.beginning.translation() = still.end.translation() = Point(0, 0, 4 - offset);
      turn.turn(Point(1, 0, 0), 2.6);
      const BodyOnPath moving(ball, still.path());
      const ConvexShape plane = ConvexShape::flat({Vec{0, 0, 1}, 0.5, false}, 9);
      const MovingBody flat(plane, turn.path());
      const MovingBody &a = is_first ? flat : moving.body,
                       &b = is_first ? moving.body : flat;
      PartingDirection parting(a, b, BodyTolerance(a, b, 0));
      setDirection(Point(0, 0, is_first ? 1 : -1), parting);
      const double above[2] = {0, 0.2}, under[2] = {0.9, 1}, over[2] = {0, 1};
      double gap[2];
      for (int i = 0; i < 2; ++i) {
        EXPECT_TRUE(parting.areApart(a.root(), b.root(), above, gap));
        EXPECT_NEAR(gap[0], 3, 1e-11);
        EXPECT_FALSE(parting.areApart(a.root(), b.root(), over, gap)) << gap[0];
        EXPECT_TRUE(parting.areApart(a.root(), b.root(), under, gap));
      }
    }
}

// The gap of two parts is at least a parabola.
TEST(FlatContacts, GapsThatStayPositive) {
  Random random(3);
  for (int i = 0; i < 1000; ++i) {
    const double gap[2] = {std::pow(10, random.uniform(-12, 0)),
                           std::pow(10, random.uniform(-12, 0))},
                 deviation = std::pow(10, random.uniform(-12, 0));
    double least = std::min(gap[0], gap[1]);
    for (double s = 0; s <= 1; s += 1e-4)
      least =
          std::min(least, (1 - s) * gap[0] + s * gap[1] - 4 * deviation * s * (1 - s));
    const bool stays = detail::deformable::staysPositive(gap, deviation);
    if (least < 0) {
      EXPECT_FALSE(stays);
    }
    if (stays) {
      EXPECT_GT(least, 0);
    }
    EXPECT_TRUE(detail::deformable::staysPositive(gap, std::min(gap[0], gap[1]) / 2));
  }
}

}  // namespace
}  // namespace test
}  // namespace fcl
