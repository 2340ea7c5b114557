// SPDX-License-Identifier: BSD-3-Clause
//
// A cloth that deforms, at rest or in a frame that turns, and a shape that turns, against
// dense sampling by other code: the first contact of each triangle.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "fcl/math/motion/interp_motion.h"
#include "fcl/narrowphase/continuous_collision.h"
#include "posed_shape.h"
#include "test_models.h"

namespace fcl {
namespace test {
namespace {

using Pose = Transform3<double>;
using Point = Vector3<double>;
using Result = ContinuousContactResult<double>;

/// Samples of [0, 1]. libccd is wrong by about 1e-6 in a distance.
constexpr int kSamples = 40;
constexpr double kTimeError = 1e-5;

struct Path {
  Pose begin, end;

  Pose at(double t) const {
    const InterpMotion<double> motion(begin.linear(), begin.translation(), end.linear(),
                                      end.translation(), Point::Zero());
    motion.integrate(t);
    Pose pose;
    motion.getCurrentTransform(pose);
    return pose;
  }
};

Path randomPath(Random& random, double way, double angle) {
  Path path{Pose::Identity(), Pose::Identity()};
  const Point about = randomDirection(random);
  path.begin.linear() = AngleAxis<double>(random.uniform(0, 3), about).toRotationMatrix();
  path.end.linear() =
      AngleAxis<double>(angle, randomDirection(random)) * path.begin.linear();
  path.begin.translation() = random.uniform(0, way) * randomDirection(random);
  path.end.translation() =
      path.begin.translation() + random.uniform(0, way) * randomDirection(random);
  return path;
}

/// A sheet of two random waves, of which the one becomes the other.
struct Cloth {
  TestMesh frame[2];
  Path path;

  Cloth(Random& random, const Path& moves) : path(moves) {
    for (TestMesh& mesh : frame) {
      const double z = random.uniform(-1, 1), height = random.uniform(0.1, 0.3);
      const Point shift = random.point(0.2);
      mesh = makeSheet(5, 5, [&](double u, double v) -> Point {
        return Point(2.4 * u - 1.2, 2.4 * v - 1.2,
                     z + height * std::sin(5 * u) * std::cos(4 * v)) +
               shift;
      });
    }
  }

  std::shared_ptr<DeformableBVHModel<>> model() const {
    auto out = std::make_shared<DeformableBVHModel<>>();
    out->beginModel();
    out->addSubModel(frame[0].vertices, frame[0].triangles);
    out->endModel();
    out->updateFrames(frame[0].vertices.front().data(), frame[1].vertices.front().data(),
                      frame[0].vertices.size());
    return out;
  }

  Point vertex(std::size_t i, double t) const {
    return (1 - t) * frame[0].vertices[i] + t * frame[1].vertices[i];
  }

  PosedShape triangle(std::size_t i, double t) const {
    const Triangle& ids = frame[0].triangles[i];
    PosedShape out =
        posedTriangle(vertex(ids[0], t), vertex(ids[1], t), vertex(ids[2], t));
    out.pose = path.at(t);
    return out;
  }
};

struct Scene {
  Cloth cloth;
  PosedShape shape;
  Path path;

  PosedShape shapeAt(double t) const {
    PosedShape out = shape;
    out.pose = path.at(t);
    return out;
  }

  /// The first time at which each triangle is found to touch; only those that do.
  std::map<std::intptr_t, double> sampledContacts() const {
    std::map<std::intptr_t, double> first;
    for (int sample = 0; sample <= kSamples; ++sample) {
      const double hi = static_cast<double>(sample) / kSamples;
      const PosedShape placed = shapeAt(hi);
      for (std::size_t i = 0; i < cloth.frame[0].triangles.size(); ++i) {
        const auto number = static_cast<std::intptr_t>(i);
        if (first.count(number) || !touches(cloth.triangle(i, hi), placed)) continue;
        first[number] = sample == 0 ? 0 : refined(i, hi - 1. / kSamples, hi);
      }
    }
    return first;
  }

 private:
  double refined(std::size_t i, double lo, double hi) const {
    for (int round = 0; round < 20; ++round) {
      const double middle = 0.5 * (lo + hi);
      (touches(cloth.triangle(i, middle), shapeAt(middle)) ? hi : lo) = middle;
    }
    return hi;
  }

  static bool touches(const PosedShape& triangle, const PosedShape& placed) {
    return !areFar(triangle, placed) && overlap(triangle, placed);
  }
};

Result ask(const Scene& scene, bool cloth_first, ContinuousQuery query) {
  ContinuousContactRequest<double> request;
  request.ccd_motion_type = CCDM_LINEAR;
  request.toc_err = 1e-6;
  request.query = query;
  Result result;
  const auto model = scene.cloth.model();
  const Path &a = scene.cloth.path, &b = scene.path;
  const CollisionGeometry<double>* shape = scene.shape.geometry.get();
  if (cloth_first)
    continuousCollide(model.get(), a.begin, a.end, shape, b.begin, b.end, request,
                      result);
  else
    continuousCollide(shape, b.begin, b.end, model.get(), a.begin, a.end, request,
                      result);
  return result;
}

/// The distance of a point from the hull of some vertices of a triangle, which contains
/// the point up to that.
double outsideFeature(const Point& p, const std::vector<Point>& feature) {
  if (feature.size() == 3)
    return posedTriangle(feature[0], feature[1], feature[2]).outside(p);
  const Point way = feature.back() - feature.front();
  const double square = way.squaredNorm(),
               along = square > 0 ? (p - feature.front()).dot(way) / square : 0;
  return (p - feature.front() - std::min(std::max(along, 0.), 1.) * way).norm();
}

/// The contact is of the surfaces, of the feature that it names, and its normal parts the
/// two just before.
void expectTouches(const Scene& scene, const ContinuousContact<double>& contact,
                   bool cloth_first) {
  const auto number = static_cast<std::size_t>(cloth_first ? contact.b1 : contact.b2);
  EXPECT_EQ(cloth_first ? contact.b2 : contact.b1, -1);
  EXPECT_EQ(contact.first_on_o1, cloth_first);
  ASSERT_LT(number, scene.cloth.frame[0].triangles.size());
  const PosedShape triangle = scene.cloth.triangle(number, contact.toc_lo),
                   placed = scene.shapeAt(contact.toc_lo);
  EXPECT_LT(triangle.outside(contact.pos), 1e-9);
  EXPECT_LT(placed.outside(contact.pos), 1e-9);
  const Triangle& ids = scene.cloth.frame[0].triangles[number];
  std::vector<Point> feature;
  for (int k = 0; k < contact.numVertices(); ++k) {
    const auto id =
        static_cast<std::size_t>(contact.vertices[static_cast<std::size_t>(k)]);
    EXPECT_TRUE(id == ids[0] || id == ids[1] || id == ids[2]);
    feature.push_back(triangle.pose * scene.cloth.vertex(id, contact.toc_lo));
  }
  ASSERT_FALSE(feature.empty());
  if (contact.toc_lo == 0) return;
  EXPECT_LT(outsideFeature(contact.pos, feature), 1e-9);
  const Point n = (cloth_first ? 1 : -1) * contact.normal;
  EXPECT_NEAR(n.norm(), 1, 1e-12);
  double cloth_most = -std::numeric_limits<double>::infinity();
  for (const Point& p : triangle.points)
    cloth_most = std::max(cloth_most, n.dot(triangle.pose * p));
  if (placed.isFlat()) {
    const Point up = placed.pose.linear() * placed.normal;
    EXPECT_LT(up.cross(n).norm(), 1e-6);
    if (placed.kind == "halfspace") {
      EXPECT_LT(n.dot(up), 0);
    }
  } else {
    EXPECT_LT(cloth_most, n.dot(placed.support(-n)) + 1e-8);
  }
}

class ShapeAndCloth : public testing::TestWithParam<std::string> {
 protected:
  static void compare(const Scene& scene, bool cloth_first, int& contacts) {
    const Result all = ask(scene, cloth_first, ContinuousQuery::kAll);
    std::map<std::intptr_t, double> times;
    for (const auto& contact : all.contacts) {
      EXPECT_TRUE(
          times.insert({cloth_first ? contact.b1 : contact.b2, contact.toc_lo}).second);
      expectTouches(scene, contact, cloth_first);
    }
    for (const auto& [triangle, time] : scene.sampledContacts()) {
      const auto found = times.find(triangle);
      ASSERT_NE(found, times.end()) << "triangle " << triangle << " at " << time;
      EXPECT_LE(found->second, time + kTimeError);
    }
    const Result first = ask(scene, cloth_first, ContinuousQuery::kFirst);
    EXPECT_EQ(first.is_collide, !times.empty());
    contacts += static_cast<int>(times.size());
    if (times.empty()) return;
    EXPECT_NEAR(first.time_of_contact, all.contacts.front().toc_lo, 1e-6);
    expectTouches(scene, first.contacts.front(), cloth_first);
  }
};

TEST_P(ShapeAndCloth, EachTriangleHasItsFirstContact) {
  const std::string& kind = GetParam();
  Random random(7);
  int contacts = 0;
  for (int i = 0; i < 4; ++i) {
    SCOPED_TRACE(i);
    const bool cloth_turns = i >= 2;
    const Cloth cloth(random, cloth_turns
                                  ? randomPath(random, 0.5, random.uniform(0.2, 2))
                                  : Path{Pose::Identity(), Pose::Identity()});
    const PosedShape shape = randomShape(kind, random);
    const Scene scene{cloth, shape, randomPath(random, 1, random.uniform(0.2, 2.5))};
    compare(scene, i % 2 == 0, contacts);
  }
  EXPECT_GT(contacts, 10);
}

INSTANTIATE_TEST_SUITE_P(, ShapeAndCloth,
                         testing::Values("sphere", "capsule", "box", "ellipsoid", "cone",
                                         "cylinder", "convex", "triangle", "plane",
                                         "halfspace"),
                         [](const testing::TestParamInfo<std::string>& info) {
                           return info.param;
                         });

}  // namespace
}  // namespace test
}  // namespace fcl
