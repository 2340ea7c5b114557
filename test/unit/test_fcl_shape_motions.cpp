// SPDX-License-Identifier: BSD-3-Clause
//
// Every pair of shapes, and of a mesh and a shape, in random motions against dense
// sampling by other code. The report fcl_ccd_shapes does the same for a finer mesh.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "fcl/math/bv/OBBRSS.h"
#include "fcl/math/motion/interp_motion.h"
#include "fcl/narrowphase/continuous_collision.h"
#include "posed_shape.h"
#include "sanitizer.h"
#include "test_models.h"

namespace fcl {
namespace test {
namespace {

using Pose = Transform3<double>;
using Point = Vector3<double>;

/// A shape, or the triangles of a mesh, and its motion.
struct Body {
  std::shared_ptr<CollisionGeometry<double>> geometry;
  std::vector<PosedShape> parts;
  Pose begin, end;

  void place(double t) {
    const InterpMotion<double> motion(begin.linear(), begin.translation(), end.linear(),
                                      end.translation(), Point::Zero());
    motion.integrate(t);
    Pose pose;
    motion.getCurrentTransform(pose);
    for (PosedShape& part : parts) part.pose = pose;
  }

  /// How far a point is from the body.
  double outside(const Point& p) const {
    double least = 2;
    for (const PosedShape& part : parts) least = std::min(least, part.outside(p));
    return least;
  }
};

Pose randomPose(Random& random) {
  Pose pose = Pose::Identity();
  pose.linear() =
      AngleAxis<double>(random.uniform(0, 3), randomDirection(random)).toRotationMatrix();
  pose.translation() = random.uniform(0, 2) * randomDirection(random);
  return pose;
}

Body randomBody(const std::string& kind, Random& random) {
  Body body;
  if (kind == "mesh") {
    const TestMesh mesh = makeUvSphere(7, 5, random.uniform(0.3, 0.7));
    for (const Triangle& t : mesh.triangles)
      body.parts.push_back(
          posedTriangle(mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]));
    auto model = std::make_shared<BVHModel<OBBRSS<double>>>();
    model->beginModel();
    model->addSubModel(mesh.vertices, mesh.triangles);
    model->endModel();
    body.geometry = model;
  } else {
    body.parts.push_back(randomShape(kind, random));
    body.geometry = body.parts.front().geometry;
  }
  body.begin = body.end = randomPose(random);
  body.end.linear() = AngleAxis<double>(random.uniform(0, 3), randomDirection(random))
                          .toRotationMatrix() *
                      body.begin.linear();
  body.end.translation() += random.uniform(0, 2) * randomDirection(random);
  return body;
}

bool overlapAt(double t, Body& a, Body& b) {
  a.place(t);
  b.place(t);
  for (const PosedShape& x : a.parts)
    for (const PosedShape& y : b.parts)
      if (!areFar(x, y) && overlap(x, y)) return true;
  return false;
}

/// The first sample at which the bodies overlap, made finer; 2: none.
double firstOverlap(Body& a, Body& b) {
  constexpr int kSamples = 60;
  for (int i = 0; i <= kSamples; ++i) {
    double hi = static_cast<double>(i) / kSamples;
    if (!overlapAt(hi, a, b)) continue;
    double lo = hi - 1. / kSamples;
    for (int round = 0; i > 0 && round < 20; ++round) {
      const double middle = 0.5 * (lo + hi);
      (overlapAt(middle, a, b) ? hi : lo) = middle;
    }
    return hi;
  }
  return 2;
}

struct Pair {
  std::string kind[2];
  std::uint64_t seed;
};

std::vector<Pair> allPairs() {
  const std::vector<std::string> kinds = {"sphere", "capsule",   "box",    "ellipsoid",
                                          "cone",   "cylinder",  "convex", "triangle",
                                          "plane",  "halfspace", "mesh"};
  std::vector<Pair> pairs;
  for (const auto& a : kinds)
    for (const auto& b : kinds) {
      const bool flat = a == "plane" || a == "halfspace";
      if (a == "mesh" && b == "mesh") continue;
      if (flat && (b == "plane" || b == "halfspace")) continue;
      pairs.push_back({{a, b}, pairs.size() + 1});
    }
  return pairs;
}

/// What a request without contacts says, which looks at the beginning first.
double timeAlone(const Body& a, const Body& b) {
  ContinuousCollisionRequest<double> request;
  request.ccd_motion_type = CCDM_LINEAR;
  request.toc_err = 1e-6;
  ContinuousCollisionResult<double> result;
  continuousCollide(a.geometry.get(), a.begin, a.end, b.geometry.get(), b.begin, b.end,
                    request, result);
  if (result.is_collide && result.time_of_contact == 0) {
    EXPECT_TRUE(result.contact_tf1.isApprox(a.begin));
    EXPECT_TRUE(result.contact_tf2.isApprox(b.begin));
  }
  return result.is_collide ? result.time_of_contact : 2;
}

class ShapePairs : public testing::TestWithParam<Pair> {};

TEST_P(ShapePairs, AgreeWithDenseSampling) {
  const Pair& pair = GetParam();
  Random random(pair.seed);
  ContinuousContactRequest<double> request;
  request.ccd_motion_type = CCDM_LINEAR;
  request.toc_err = 1e-6;
  request.query = ContinuousQuery::kFirst;
  request.enable_contact = true;
  request.num_max_contacts = 1000;
  for (int i = 0; i < (kHasAddressSanitizer ? 5 : 200); ++i) {
    SCOPED_TRACE(i);
    Body a = randomBody(pair.kind[0], random), b = randomBody(pair.kind[1], random);
    ContinuousContactResult<double> result;
    continuousCollide(a.geometry.get(), a.begin, a.end, b.geometry.get(), b.begin, b.end,
                      request, result);
    const double alone = timeAlone(a, b);
    EXPECT_EQ(alone == 0, result.is_collide && result.time_of_contact == 0);
    EXPECT_EQ(alone == 0, timeAlone(b, a) == 0);
    const double first = firstOverlap(a, b);
    if (first <= 1) {
      EXPECT_TRUE(result.is_collide);
      EXPECT_LE(result.time_of_contact, first + 1e-5);
    }
    if (!result.is_collide) continue;
    // The contact is on both surfaces.
    ASSERT_FALSE(result.contacts.empty());
    const auto& contact = result.contacts.front();
    a.place(contact.toc_lo);
    b.place(contact.toc_lo);
    EXPECT_LT(a.outside(contact.pos), 1e-9);
    EXPECT_LT(b.outside(contact.pos), 1e-9);
  }
}

INSTANTIATE_TEST_SUITE_P(, ShapePairs, testing::ValuesIn(allPairs()),
                         [](const testing::TestParamInfo<Pair>& info) {
                           return info.param.kind[0] + "_" + info.param.kind[1];
                         });

}  // namespace
}  // namespace test
}  // namespace fcl
