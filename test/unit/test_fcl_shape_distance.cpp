// SPDX-License-Identifier: BSD-3-Clause
//
// ContinuousContactRequest::ignore_initially_closer with shapes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "fcl/geometry/bvh/BVH_model.h"
#include "fcl/geometry/shape/box.h"
#include "fcl/geometry/shape/capsule.h"
#include "fcl/geometry/shape/cone.h"
#include "fcl/geometry/shape/cylinder.h"
#include "fcl/geometry/shape/ellipsoid.h"
#include "fcl/geometry/shape/halfspace.h"
#include "fcl/geometry/shape/plane.h"
#include "fcl/geometry/shape/sphere.h"
#include "fcl/math/bv/OBBRSS.h"
#include "fcl/narrowphase/continuous_collision.h"
#include "mesh_generators.h"

namespace fcl {
namespace test {
namespace {

using Pose = Transform3<double>;
using Point = Vector3<double>;
using Request = ContinuousContactRequest<double>;
using Result = ContinuousContactResult<double>;
using Geometry = std::shared_ptr<CollisionGeometry<double>>;

constexpr double kRadius = 0.25, kDistance = 0.2, kGap = 0.05;
/// The share by which a pair must come nearer (doc/thickness.md).
constexpr double kShare = 1e-4;

struct Moving {
  Geometry geometry;
  Pose begin, end;
};

Pose at(double x, double y, double z) {
  Pose pose = Pose::Identity();
  pose.translation() << x, y, z;
  return pose;
}

Geometry ballGeometry() { return std::make_shared<Sphere<double>>(kRadius); }

TestMesh floorTriangles() {
  return makeSheet(8, 8,
                   [](double u, double v) { return Point(4 * u - 2, 4 * v - 2, 0); });
}

Geometry floorMesh() {
  const TestMesh sheet = floorTriangles();
  auto model = std::make_shared<BVHModel<OBBRSS<double>>>();
  model->beginModel();
  model->addSubModel(sheet.vertices, sheet.triangles);
  model->endModel();
  return model;
}

/// What reaches up to `top` on the z axis.
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
      {"plane", std::make_shared<Plane<double>>(Point(0, 0, 1), 0.25), 0.25},
      {"halfspace", std::make_shared<Halfspace<double>>(Point(0, 0, 1), 0.125), 0.125},
      {"mesh", floorMesh(), 0}};
}

Request requestOf(ContinuousQuery query) {
  Request request;
  request.query = query;
  request.toc_err = 1e-9;
  request.ccd_motion_type = CCDM_SCREW;
  request.num_max_contacts = 1000;
  request.min_distance = kDistance;
  request.ignore_initially_closer = true;
  return request;
}

/// Asks in both orders, and expects the same.
Result ask(const Moving& a, const Moving& b, const Request& request) {
  Result results[2];
  continuousCollide(a.geometry.get(), a.begin, a.end, b.geometry.get(), b.begin, b.end,
                    request, results[0]);
  continuousCollide(b.geometry.get(), b.begin, b.end, a.geometry.get(), a.begin, a.end,
                    request, results[1]);
  EXPECT_EQ(results[0].is_collide, results[1].is_collide);
  EXPECT_NEAR(results[0].time_of_contact, results[1].time_of_contact, 1e-11);
  return results[0];
}

class InitiallyCloser : public testing::TestWithParam<ContinuousQuery> {};

TEST_P(InitiallyCloser, CountsOnlyWhenItComesNearer) {
  const Request request = requestOf(GetParam());
  for (const Target& target : targets()) {
    SCOPED_TRACE(target.name);
    const Moving still{target.geometry, at(0, 0, 0), at(0, 0, 0)};
    const auto move = [&](double gap, double way) {
      const double z = target.top + kRadius + gap;
      return ask({ballGeometry(), at(0, 0, z), at(0, 0, z + way)}, still, request);
    };
    EXPECT_FALSE(move(kGap, 0.5).is_collide);
    EXPECT_FALSE(move(kGap, 0).is_collide);
    EXPECT_FALSE(move(kGap, -0.9 * kShare * kGap).is_collide);
    const Result nearer = move(kGap, -0.5);
    EXPECT_TRUE(nearer.is_collide);
    EXPECT_GT(nearer.time_of_contact, 0);
    EXPECT_NEAR(nearer.time_of_contact, 2 * kShare * kGap, 1e-11);
    // What overlaps or touches at the beginning is a contact then.
    for (const double gap : {0., -0.01, -0.3}) {
      if (gap < 0 && target.name == "mesh") continue;
      EXPECT_EQ(move(gap, 0.5).time_of_contact, 0);
    }
    // What begins further apart meets at the distance.
    const Result far = move(2 * kDistance, -2 * kDistance);
    EXPECT_TRUE(far.is_collide);
    EXPECT_NEAR(far.time_of_contact, 0.5, 1e-11);
  }
}

// Both turn about the z axis of the world, in which they are at rest to each other.
TEST_P(InitiallyCloser, PairsThatTurnTogetherAreNoContacts) {
  Pose turn = Pose::Identity();
  turn.linear() = AngleAxis<double>(1.5, Point::UnitZ()).toRotationMatrix();
  for (const Target& target : targets()) {
    SCOPED_TRACE(target.name);
    const Pose base = at(0.5, 0.25, 0),
               ball = base * at(0, 0, target.top + kRadius + kGap);
    const Result result =
        ask({ballGeometry(), ball, turn * ball}, {target.geometry, base, turn * base},
            requestOf(GetParam()));
    EXPECT_FALSE(result.is_collide) << result.time_of_contact;
  }
}

TEST_P(InitiallyCloser, ParallelFlats) {
  const auto flat = [](double z) { return at(0, 0, z); };
  const Geometry plane = std::make_shared<Plane<double>>(Point(0, 0, 1), 0.),
                 below = std::make_shared<Halfspace<double>>(Point(0, 0, 1), 0.);
  for (const Geometry& other : {plane, below}) {
    const auto move = [&](double gap, double way) {
      return ask({plane, flat(gap), flat(gap + way)}, {other, flat(0), flat(0)},
                 requestOf(GetParam()));
    };
    EXPECT_FALSE(move(kGap, 0.5).is_collide);
    EXPECT_FALSE(move(kGap, 0).is_collide);
    EXPECT_NEAR(move(kGap, -0.5).time_of_contact, 2 * kShare * kGap, 1e-11);
    EXPECT_EQ(move(0, 0.5).time_of_contact, 0);
    EXPECT_NEAR(move(2 * kDistance, -2 * kDistance).time_of_contact, 0.5, 1e-11);
  }
}

INSTANTIATE_TEST_SUITE_P(, InitiallyCloser,
                         testing::Values(ContinuousQuery::kAll, ContinuousQuery::kFirst,
                                         ContinuousQuery::kAny),
                         [](const testing::TestParamInfo<ContinuousQuery>& info) {
                           switch (info.param) {
                             case ContinuousQuery::kAll:
                               return "all";
                             case ContinuousQuery::kFirst:
                               return "first";
                             default:
                               return "any";
                           }
                         });

/// The distance of a point from a triangle in the plane z = 0.
double distanceOf(const Point& p, const Point (&x)[3]) {
  bool is_above = true;
  double least = 1e300;
  for (int k = 0; k < 3; ++k) {
    const Point edge = x[(k + 1) % 3] - x[k], from = p - x[k];
    is_above &= edge.cross(from)[2] * edge.cross(x[(k + 2) % 3] - x[k])[2] >= 0;
    const double along = std::min(std::max(from.dot(edge) / edge.squaredNorm(), 0.), 1.);
    least = std::min(least, (from - along * edge).norm());
  }
  return is_above ? std::abs(p[2]) : least;
}

// A ball slides over a floor. It comes nearer to some triangles that begin nearer than
// the distance, not to the one below it, and reaches others at the distance.
TEST(InitiallyCloserTriangles, HaveTheirOwnDistances) {
  const TestMesh mesh = floorTriangles();
  const Geometry floor = floorMesh();
  const Point begin(0.1, 0.2, kRadius + kGap), end(1.3, 0.7, kRadius + kGap);
  const Result result =
      ask({ballGeometry(), at(begin[0], begin[1], begin[2]), at(end[0], end[1], end[2])},
          {floor, at(0, 0, 0), at(0, 0, 0)}, requestOf(ContinuousQuery::kAll));
  std::map<std::intptr_t, double> found;
  for (const auto& contact : result.contacts) found[contact.b2] = contact.toc_lo;
  int own = 0, reached = 0, ignored = 0;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const Triangle& t = mesh.triangles[i];
    const Point corners[3] = {mesh.vertices[t[0]], mesh.vertices[t[1]],
                              mesh.vertices[t[2]]};
    const auto gap = [&](double time) {
      return distanceOf(begin + time * (end - begin), corners) - kRadius;
    };
    const bool is_near = gap(0) <= kDistance;
    const double limit = is_near ? gap(0) * (1 - kShare) : kDistance;
    // The distance from a convex set is convex in the time.
    constexpr int kSamples = 1000;
    int first = 0;
    while (first <= kSamples && gap(1. * first / kSamples) > limit) ++first;
    const auto contact = found.find(static_cast<std::intptr_t>(i));
    ASSERT_EQ(contact != found.end(), first <= kSamples) << i;
    if (first > kSamples) {
      ignored += is_near;
      continue;
    }
    double lo = 1. * (first - 1) / kSamples, hi = 1. * first / kSamples;
    for (int round = 0; round < 50; ++round)
      (gap(0.5 * (lo + hi)) > limit ? lo : hi) = 0.5 * (lo + hi);
    // Its own distance is less by twice the tolerance.
    if (!is_near) {
      EXPECT_LE(contact->second, hi);
    }
    EXPECT_NEAR(contact->second, hi, 1e-9);
    ++(is_near ? own : reached);
  }
  EXPECT_GT(own, 2);
  EXPECT_GT(reached, 5);
  EXPECT_GT(ignored, 0);
}

}  // namespace
}  // namespace test
}  // namespace fcl
