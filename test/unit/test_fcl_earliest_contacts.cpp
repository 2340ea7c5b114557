// SPDX-License-Identifier: BSD-3-Clause
//
// The earliest contacts, as many as a request wants, are the first of the list of all, in
// every field; and a contact names the same triangles in every query.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "fcl/geometry/shape/box.h"
#include "fcl/geometry/shape/sphere.h"
#include "fcl/math/bv/OBBRSS.h"
#include "fcl/narrowphase/continuous_collision.h"
#include "moving_mesh.h"
#include "test_models.h"

namespace fcl {
namespace test {
namespace {

using Model = DeformableBVHModel<OBBRSS<double>>;
using RigidModel = BVHModel<OBBRSS<double>>;
using Geometry = std::shared_ptr<CollisionGeometry<double>>;
using Request = ContinuousContactRequest<double>;
using Result = ContinuousContactResult<double>;
using Contact = ContinuousContact<double>;

struct Scene {
  /// The second one is null for a mesh with itself.
  Geometry o1, o2;
  Transform3<double> tf2_beg = Transform3<double>::Identity(), tf2_end = tf2_beg;
  /// With a mesh that turns or a shape a bracket depends on how the query divides time.
  bool is_straight{true};

  Result ask(const Request& request) const {
    Result result;
    const Transform3<double> still = Transform3<double>::Identity();
    if (o2)
      continuousCollide(o1.get(), still, still, o2.get(), tf2_beg, tf2_end, request,
                        result);
    else
      continuousSelfCollide(o1.get(), request, result);
    return result;
  }
};

/// A sheet at a height. Some of its triangles are there twice, with their vertices in
/// another order too, and all are in a random order.
MovingMesh sheet(Random& random, double z) {
  const int n = 3 + static_cast<int>(random.index(5));
  MovingMesh mesh = still(makeSheet(n, n));
  const std::size_t count = mesh.triangles.size();
  for (std::size_t i = 0; i < count / 6; ++i) {
    const Triangle t = mesh.triangles[random.index(count)];
    mesh.triangles.push_back(random.index(2) ? t : Triangle(t[1], t[2], t[0]));
  }
  for (std::size_t i = mesh.triangles.size(); i > 1; --i)
    std::swap(mesh.triangles[i - 1], mesh.triangles[random.index(i)]);
  const double noise = random.index(2) ? 0.05 : 0, moves = random.index(2) ? 0.2 : 0;
  for (std::size_t i = 0; i < mesh.t0.size(); ++i) {
    mesh.t0[i] += random.point(noise) + Vector3<double>(0, 0, z);
    mesh.t1[i] = mesh.t0[i] + random.point(moves) - Vector3<double>(0, 0, z);
  }
  return mesh;
}

Geometry deforming(const MovingMesh& mesh) {
  return makeModel<Model>(TestMesh{mesh.t0, mesh.triangles},
                          TestMesh{mesh.t1, mesh.triangles});
}

Geometry rigid(const MovingMesh& mesh) {
  return makeModel<RigidModel>(TestMesh{mesh.t0, mesh.triangles});
}

enum class What {
  kPair,
  kSelf,
  kRigid,
  kRigidAndDeforming,
  kTurning,
  kRigidTurning,
  kBox
};

Scene sceneOf(What what, Random& random) {
  const MovingMesh lower = sheet(random, 0), upper = sheet(random, 0.1);
  Scene scene;
  scene.tf2_end.translation() = Vector3<double>(0.05, 0.02, -0.15);
  switch (what) {
    case What::kSelf: {
      MovingMesh both = lower;
      append(both, upper);
      scene.o1 = deforming(both);
      return scene;
    }
    case What::kRigid:
      scene.o1 = rigid(lower);
      scene.o2 = rigid(upper);
      return scene;
    case What::kRigidAndDeforming:
      scene.o1 = rigid(lower);
      scene.o2 = deforming(upper);
      return scene;
    case What::kTurning:
    case What::kRigidTurning:
    case What::kBox:
      scene.is_straight = false;
      scene.tf2_end.linear() =
          AngleAxis<double>(random.uniform(-1, 1), random.point(1).normalized())
              .toRotationMatrix();
      if (what == What::kBox) {
        scene.tf2_beg.translation() = Vector3<double>(0.5, 0.5, 0.3);
        scene.o1 = rigid(lower);
        scene.o2 = std::make_shared<Box<double>>(0.4, 0.5, 0.3);
        return scene;
      }
      scene.o1 = what == What::kTurning ? deforming(lower) : rigid(lower);
      scene.o2 = what == What::kTurning ? deforming(upper) : rigid(upper);
      return scene;
    default:
      scene.o1 = deforming(lower);
      scene.o2 = deforming(upper);
      return scene;
  }
}

bool namesSame(const Contact& x, const Contact& y) {
  return x.kind == y.kind && x.first_on_o1 == y.first_on_o1 && x.vertices == y.vertices;
}

/// Expects the first contacts of a list to be these, to the bit.
void expectFirst(const std::vector<Contact>& found, const std::vector<Contact>& all,
                 std::size_t count) {
  ASSERT_EQ(found.size(), std::min(count, all.size()));
  for (std::size_t i = 0; i < found.size(); ++i) {
    SCOPED_TRACE("contact " + std::to_string(i) + " of " + std::to_string(count));
    const Contact &x = found[i], &y = all[i];
    ASSERT_TRUE(namesSame(x, y));
    ASSERT_EQ(x.b1, y.b1);
    ASSERT_EQ(x.b2, y.b2);
    ASSERT_EQ(x.o1, y.o1);
    ASSERT_EQ(x.o2, y.o2);
    ASSERT_EQ(x.within_tolerance, y.within_tolerance);
    ASSERT_EQ(x.toc_lo, y.toc_lo);
    ASSERT_EQ(x.toc_hi, y.toc_hi);
    ASSERT_TRUE(x.pos == y.pos);
    ASSERT_TRUE(x.normal == y.normal);
  }
}

/// Expects that a contact of both lists names the same triangles.
void expectSameTriangles(const std::vector<Contact>& found,
                         const std::vector<Contact>& all, int& compared) {
  for (const Contact& x : found)
    for (const Contact& y : all) {
      if (!namesSame(x, y)) continue;
      ++compared;
      ASSERT_EQ(x.b1, y.b1);
      ASSERT_EQ(x.b2, y.b2);
    }
}

void expectEarliest(const Scene& scene, Request request, int& compared) {
  const std::vector<Contact> all = scene.ask(request).contacts;
  const std::size_t n = all.size();
  for (const std::size_t count : {std::size_t{1}, std::size_t{2}, n / 3 + 1, n / 2 + 1,
                                  std::max<std::size_t>(n, 2) - 1, n + 1}) {
    request.num_max_contacts = count;
    expectFirst(scene.ask(request).contacts, all, count);
  }
  request.num_max_contacts = n + 1;
  request.num_threads = 2;
  expectFirst(scene.ask(request).contacts, all, n);
  request.query = ContinuousQuery::kFirst;
  const std::vector<Contact> first = scene.ask(request).contacts;
  if (scene.is_straight) expectSameTriangles(first, all, compared);
  request.num_threads = 1;
  for (const std::size_t count : {std::size_t{1}, std::size_t{2}}) {
    request.num_max_contacts = count;
    expectFirst(scene.ask(request).contacts, first, count);
  }
}

TEST(FCL_EARLIEST_CONTACTS, areTheFirstOfAll) {
  Random random(91);
  int compared = 0;
  for (const What what :
       {What::kPair, What::kSelf, What::kRigid, What::kRigidAndDeforming, What::kTurning,
        What::kRigidTurning, What::kBox})
    for (int i = 0; i < 8; ++i) {
      SCOPED_TRACE("scene " + std::to_string(static_cast<int>(what)) + ", " +
                   std::to_string(i));
      const Scene scene = sceneOf(what, random);
      Request request;
      request.toc_err = 1e-6;
      if (i % 2) {
        request.min_distance = i % 4 == 1 ? 0.02 : 0.15;
        request.ignore_initially_closer = i > 4;
      }
      if (i % 4 == 2)
        request.accepts_triangles = [](std::intptr_t x, std::intptr_t y) {
          return (7 * x + 3 * y) % 5 != 0;
        };
      expectEarliest(scene, request, compared);
      if (HasFatalFailure()) return;
    }
  EXPECT_GT(compared, 30);
}

}  // namespace
}  // namespace test
}  // namespace fcl
