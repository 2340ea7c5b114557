// SPDX-License-Identifier: BSD-3-Clause
//
// Lengths times a power of two: the same pair has the same time of contact, or the query
// says that it is out of range. Tiny meshes and octrees can be early, never late. Safe
// displacements are multiplied too.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "fcl/common/exception.h"
#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "fcl/geometry/octree/octree.h"
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
#include "fcl/narrowphase/continuous_collision.h"
#include "fcl/narrowphase/safe_displacements.h"
#include "sanitizer.h"
#include "test_models.h"

namespace fcl {
namespace test {
namespace {

constexpr double kRefused = -1, kNever = 2;

template <typename S>
using Geometry = std::shared_ptr<CollisionGeometry<S>>;

const std::vector<std::string>& shapeKinds() {
  static const std::vector<std::string> kinds = {
      "sphere", "capsule", "box",      "ellipsoid", "cone",
      "convex", "plane",   "cylinder", "halfspace", "triangle"};
  return kinds;
}

/// A shape whose lengths are times `s`, a power of two.
template <typename S>
Geometry<S> shapeOf(const std::string& kind, S s) {
  using Point = Vector3<S>;
  const S p = S(.3) * s, q = S(.45) * s, r = S(.7) * s;
  if (kind == "sphere") return std::make_shared<Sphere<S>>(q);
  if (kind == "capsule") return std::make_shared<Capsule<S>>(p, r);
  if (kind == "box") return std::make_shared<Box<S>>(p, q, r);
  if (kind == "ellipsoid") return std::make_shared<Ellipsoid<S>>(p, q, r);
  if (kind == "cone") return std::make_shared<Cone<S>>(p, r);
  if (kind == "cylinder") return std::make_shared<Cylinder<S>>(p, r);
  if (kind == "plane") return std::make_shared<Plane<S>>(Point(0, 0, 1), -p);
  if (kind == "halfspace") return std::make_shared<Halfspace<S>>(Point(1, 0, 0), -q);
  if (kind == "triangle")
    return std::make_shared<TriangleP<S>>(Point(-p, -q, 0), Point(r, 0, p),
                                          Point(0, r, 0));
  const auto corners = std::make_shared<std::vector<Point>>(
      std::vector<Point>{{-p, -p, -p}, {q, 0, -p}, {-p, q, -p}, {0, 0, r}});
  const auto faces = std::make_shared<std::vector<int>>(
      std::vector<int>{3, 0, 2, 1, 3, 0, 1, 3, 3, 1, 2, 3, 3, 2, 0, 3});
  return std::make_shared<Convex<S>>(corners, 4, faces);
}

TestMesh times(TestMesh mesh, double s) {
  for (auto& p : mesh.vertices) p *= s;
  return mesh;
}

/// A mesh or an octree whose lengths are times `s`.
Geometry<double> geometryOf(const std::string& kind, double s) {
  const TestMesh ball = makeUvSphere(7, 5, .4);
  if (kind == "mesh") return makeModel<BVHModel<OBBRSS<double>>>(times(ball, s));
  if (kind == "cloth") {
    TestMesh bent = ball;
    for (auto& p : bent.vertices) p[2] += .2 * p[0] * p[1];
    return makeModel<DeformableBVHModel<>>(times(ball, s), times(bent, s));
  }
  if (kind != "octree") return shapeOf<double>(kind, s);
  const auto map = std::make_shared<octomap::OcTree>(.25);
  map->updateNode(octomap::point3d(.1f, .1f, .1f), true);
  map->updateNode(octomap::point3d(.4f, .1f, -.1f), true);
  map->setResolution(.25 * s);
  return std::make_shared<OcTree<double>>(map);
}

template <typename S>
Transform3<S> times(Transform3<S> pose, S s) {
  pose.translation() *= s;
  return pose;
}

template <typename S>
struct Motion {
  Transform3<S> begin, end;
};

template <typename S>
Motion<S> randomMotion(Random& random) {
  const auto pose = [&random] {
    Transform3<S> out = Transform3<S>::Identity();
    const Vector3<double> axis = random.point(1).normalized(), place = random.point(1.5);
    out.linear() = AngleAxis<double>(random.uniform(0, 1.5), axis).matrix().cast<S>();
    out.translation() = place.cast<S>();
    return out;
  };
  return {pose(), pose()};
}

template <typename S>
double timeOf(const Geometry<S>& a, const Motion<S>& motion_a, const Geometry<S>& b,
              const Motion<S>& motion_b, S s, CCDMotionType type, S distance) {
  ContinuousContactRequest<S> request;
  request.ccd_motion_type = type;
  request.min_distance = s * distance;
  request.toc_err = S(1e-9);
  ContinuousContactResult<S> result;
  try {
    continuousCollide(a.get(), times(motion_a.begin, s), times(motion_a.end, s), b.get(),
                      times(motion_b.begin, s), times(motion_b.end, s), request, result);
  } catch (const Exception&) {
    return kRefused;
  }
  if (!result.is_collide) return kNever;
  // Without contacts another way may lead to the same answer.
  ContinuousCollisionRequest<S> plain;
  plain.ccd_motion_type = type;
  plain.toc_err = request.toc_err;
  if (!(distance > 0)) {
    ContinuousCollisionResult<S> alone;
    continuousCollide(a.get(), times(motion_a.begin, s), times(motion_a.end, s), b.get(),
                      times(motion_b.begin, s), times(motion_b.end, s), plain, alone);
    EXPECT_EQ(alone.time_of_contact == 0, result.time_of_contact == 0);
  }
  // The position is of this scale.
  const Vector3<S> p = result.contacts.front().pos;
  EXPECT_LT(p.template lpNorm<Eigen::Infinity>(), S(10) * s);
  return static_cast<double>(result.time_of_contact);
}

template <typename S>
void compareShapes(const std::vector<int>& exponents, int num_scenes) {
  Random random(7);
  int hits = 0;
  for (const std::string& a : shapeKinds())
    for (const std::string& b : shapeKinds())
      for (int i = 0; i < num_scenes; ++i) {
        const auto motion_a = randomMotion<S>(random), motion_b = randomMotion<S>(random);
        const CCDMotionType type = i % 2 == 0 ? CCDM_LINEAR : CCDM_SCREW;
        const S distance = i % 3 == 0 ? S(.05) : S(0);
        const auto at = [&](S s) {
          return timeOf<S>(shapeOf<S>(a, s), motion_a, shapeOf<S>(b, s), motion_b, s,
                           type, distance);
        };
        const double expected = at(1);
        hits += expected > 0 && expected <= 1;
        for (const int exponent : exponents)
          EXPECT_EQ(at(std::ldexp(S(1), exponent)), expected)
              << a << ", " << b << ", times 2^" << exponent;
      }
  EXPECT_GT(hits, 20 * num_scenes);
}

TEST(QueryRange, ShapesHaveTheSameTimeAtEveryScale) {
  compareShapes<double>({-900, -520, -400, -269, -201, -150, -139, -60, 60, 120, 158, 163,
                         171, 185, 199, 300, 460},
                        rounds(8));
}

TEST(QueryRange, ShapesInFloatHaveTheSameTimeAtEveryScale) {
  compareShapes<float>({-110, -40, 40, 110}, rounds(4));
}

TEST(QueryRange, OtherBodiesHaveTheSameTimeOrAreRefused) {
  const std::vector<std::string> others = {"mesh", "cloth", "octree"};
  std::vector<std::string> kinds = others;
  kinds.insert(kinds.end(), shapeKinds().begin(), shapeKinds().end());
  Random random(8);
  int refused = 0, compared = 0;
  for (const std::string& a : others)
    for (const std::string& b : kinds)
      for (int i = 0; i < rounds(6); ++i) {
        const auto motion_a = randomMotion<double>(random),
                   motion_b = randomMotion<double>(random);
        const CCDMotionType type = i % 2 == 0 ? CCDM_LINEAR : CCDM_SCREW;
        const double distance = i % 3 == 0 ? .05 : 0;
        const auto at = [&](double s) {
          return timeOf<double>(geometryOf(a, s), motion_a, geometryOf(b, s), motion_b, s,
                                type, distance);
        };
        const double expected = at(1);
        for (const int exponent : {-500, -300, -200, -171, -150, -130, -90, -50, 50, 90,
                                   120, 145, 165, 180, 250}) {
          const double time = at(std::ldexp(1, exponent));
          ++(time == kRefused ? refused : compared);
          if (time == kRefused)
            EXPECT_GT(exponent, 90) << a << ", " << b;
          else if (exponent < -140)
            EXPECT_LE(time, expected + 1e-9)
                << a << ", " << b << ", times 2^" << exponent;
          else
            EXPECT_NEAR(time, expected, 1e-9)
                << a << ", " << b << ", times 2^" << exponent;
        }
      }
  EXPECT_GT(refused, 100);
  EXPECT_GT(compared, 100);
}

/// Without bounds on squares of lengths, boxes leave out triangles: contacts would be
/// missed.
TEST(QueryRange, TheLeastBodiesAreRightOrRefused) {
  Random random(9);
  int refused = 0, compared = 0;
  for (const char* a : {"mesh", "cloth", "octree"})
    for (const char* b : {"mesh", "cloth", "octree", "sphere", "box", "plane"})
      for (int i = 0; i < rounds(6); ++i) {
        auto motion_a = randomMotion<double>(random);
        const auto motion_b = randomMotion<double>(random);
        if (i % 2 == 0) motion_a.end.linear() = motion_a.begin.linear();
        const double distance = i % 3 == 0 ? .05 : 0;
        const auto at = [&](double s) {
          return timeOf<double>(geometryOf(a, s), motion_a, geometryOf(b, s), motion_b, s,
                                CCDM_LINEAR, distance);
        };
        const double expected = at(1);
        for (const int exponent : {-500, -502, -505, -520, -540, -560, -700, -1000}) {
          const double time = at(std::ldexp(1, exponent));
          if (time == kRefused) {
            ++refused;
            EXPECT_LT(exponent, -500) << a << ", " << b;
          } else {
            ++compared;
            EXPECT_LE(time, expected + 1e-9)
                << a << ", " << b << ", times 2^" << exponent;
          }
        }
      }
  EXPECT_GT(refused, rounds(6) * 60);
  EXPECT_GT(compared, rounds(6) * 18);
}

TEST(QueryRange, ErrorsTellTheLimit) {
  const auto error = [](const std::string& kind, int exponent) {
    const double s = std::ldexp(1, exponent);
    const auto mesh = geometryOf(kind, s), ball = shapeOf<double>("sphere", s);
    const auto still = Transform3<double>::Identity();
    return errorOf([&] {
      ContinuousContactRequest<double> request;
      ContinuousContactResult<double> result;
      continuousCollide(mesh.get(), still, still, ball.get(), still, still, request,
                        result);
    });
  };
  expectMessage(error("mesh", 155), "o1: the mesh has coordinates beyond 2^150");
  expectMessage(error("cloth", 130), "o1: the mesh has coordinates beyond 2^127");
  expectMessage(error("mesh", -600), "coordinates below 2^-500");
  EXPECT_EQ(error("mesh", 140), "");
  EXPECT_EQ(error("cloth", 120), "");
}

TEST(QueryRange, SafeDisplacementsAreMultiplied) {
  Random random(9);
  for (int round = 0; round < rounds(30); ++round) {
    TestMesh mesh = makeTriangleSoup(6, .5, .6, random.next());
    const auto bounds =
        safeSelfDisplacements(makeModel<DeformableBVHModel<>>(mesh).get(), 1., .01);
    for (const int exponent : {-1000, -900, -600, -400, -300, -268, -263, -258, -250,
                               -210, -199, -100, 100, 190, 210, 255, 300, 500}) {
      SCOPED_TRACE(exponent);
      const double s = std::ldexp(1, exponent);
      const auto scaled = safeSelfDisplacements(
          makeModel<DeformableBVHModel<>>(times(mesh, s)).get(), s, .01 * s);
      ASSERT_EQ(scaled.size(), bounds.size());
      for (std::size_t i = 0; i < bounds.size(); ++i) {
        EXPECT_LE(scaled[i], bounds[i] * s);
        EXPECT_GE(scaled[i], bounds[i] * s * (exponent < -950 ? .99 : 1));
      }
    }
  }
}

// The normal of such a triangle has a square that underflows.
TEST(QueryRange, SafeDisplacementsBesideTinyTriangles) {
  Random random(10);
  for (int exponent = -240; exponent > -275; --exponent)
    for (int round = 0; round < 20; ++round) {
      const double s = std::ldexp(1, exponent);
      TestMesh mesh;
      for (int k = 0; k < 3; ++k) {
        const double angle = 2. * k + random.uniform(0, .5);
        mesh.vertices.push_back({s * std::cos(angle), s * std::sin(angle), 0});
      }
      const double height = random.uniform(.5, 2);
      mesh.vertices.push_back({0, 0, height});
      mesh.vertices.push_back({1, 0, height + 1});
      mesh.vertices.push_back({0, 1, height + 1});
      mesh.triangles = {Triangle(0, 1, 2), Triangle(3, 4, 5)};
      const auto bounds =
          safeSelfDisplacements(makeModel<DeformableBVHModel<>>(mesh).get(), 10.);
      EXPECT_LE(bounds[3], .5 * height);
      EXPECT_GE(bounds[3], .499 * height);
    }
}

}  // namespace
}  // namespace test
}  // namespace fcl
