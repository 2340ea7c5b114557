// SPDX-License-Identifier: BSD-3-Clause
//
// All contacts of meshes that turn, found along chords (curved/chord_pairs.h): they are
// those that are found on the true paths from the beginning. A query with a callback
// takes the true paths.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "fcl/math/bv/OBBRSS.h"
#include "fcl/math/motion/interp_motion.h"
#include "fcl/math/motion/screw_motion.h"
#include "fcl/math/motion/spline_motion.h"
#include "fcl/narrowphase/continuous_collision.h"
#include "mesh_generators.h"
#include "test_models.h"

namespace fcl {
namespace test {
namespace {

using Rigid = BVHModel<OBBRSS<double>>;
using Deforming = DeformableBVHModel<>;
using Geometry = std::shared_ptr<CollisionGeometry<double>>;
using Motion = std::shared_ptr<MotionBase<double>>;
using Request = ContinuousContactRequest<double>;
using Result = ContinuousContactResult<double>;

const Vector3<double> kOrigin = Vector3<double>::Zero();

TestMesh bumpyBall(double phase) {
  TestMesh mesh = makeGeodesicSphere(12, 1);
  for (Vector3<double>& p : mesh.vertices)
    p *= 1 + 0.05 * std::sin(7 * p[0] + phase) * std::sin(5 * p[1]) * std::sin(6 * p[2]);
  return mesh;
}

/// A sheet of 800 triangles above the ball, in waves.
TestMesh sheetAt(double height, double phase) {
  return makeSheet(20, 20, [&](double u, double v) {
    const double x = 2.4 * (u - 0.5), y = 2.4 * (v - 0.5);
    return Vector3<double>(x, y,
                           height - 0.3 * (x * x + y * y) +
                               0.05 * std::sin(5 * x + phase) * std::sin(6 * y));
  });
}

/// Two meshes and their motions.
struct Scene {
  Geometry a, b;
  Motion motion_a, motion_b;
};

Motion motionBetween(const Matrix3<double>& begin, const Vector3<double>& from,
                     const Matrix3<double>& end, const Vector3<double>& to) {
  return std::make_shared<InterpMotion<double>>(begin, from, end, to, kOrigin);
}

Motion randomMotion(Random& random, double angle, const Vector3<double>& at,
                    const Vector3<double>& way) {
  const auto turn = [&random](double by) -> Matrix3<double> {
    return AngleAxis<double>(by, random.point(1).normalized()).toRotationMatrix();
  };
  const Matrix3<double> begin = turn(1), end = turn(angle) * begin;
  return motionBetween(begin, at, end, at + way);
}

/// How far they turn is between 1e-4 and 2.
Scene randomScene(Random& random, int number) {
  Scene scene;
  const auto motionAt = [&](const Vector3<double>& at, const Vector3<double>& way) {
    return randomMotion(random, std::pow(10, random.uniform(-4, 0.3)), at, way);
  };
  const double away = number % 5 == 4 ? 1e3 : 0;
  const Vector3<double> far(away, -away, away);
  scene.b = makeModel<Rigid>(bumpyBall(1));
  scene.motion_b = motionAt(far, random.point(0.2));
  const Matrix3<double> unit = Matrix3<double>::Identity();
  // Most are just above the ball, some cross it at the beginning.
  const double height = random.uniform(0.9, 1.4);
  switch (number % 4) {
    case 0:  // a sheet that deforms
      scene.a = makeModel<Deforming>(sheetAt(height, 0),
                                     sheetAt(height - 0.2, random.uniform(0, 1)));
      scene.motion_a = motionBetween(unit, far, unit, far);
      break;
    case 1:  // one that is moved while it deforms
      scene.a = makeModel<Deforming>(sheetAt(height, 0), sheetAt(height - 0.1, 1));
      scene.motion_a = motionBetween(unit, far, unit, far - Vector3<double>(0, 0, 0.1));
      break;
    case 2:  // one that turns while it deforms
      scene.a = makeModel<Deforming>(sheetAt(height, 0), sheetAt(height - 0.1, 1));
      scene.motion_a = motionAt(far, random.point(0.1));
      break;
    default:  // two rigid meshes
      scene.a = makeModel<Rigid>(bumpyBall(2));
      scene.motion_a = motionAt(far + 1.02 * (1 + height) * random.point(1).normalized(),
                                random.point(0.3));
  }
  return scene;
}

Result ask(const Scene& scene, const Request& request) {
  Result result;
  continuousCollide(scene.a.get(), scene.motion_a.get(), scene.b.get(),
                    scene.motion_b.get(), request, result);
  return result;
}

using Name = std::array<int, 6>;

/// A contact by what it is, and its time. Of a vertex between two edges either may be
/// named: they are equally near.
std::map<Name, double> namesOf(const Result& result) {
  std::map<Name, double> out;
  for (const auto& contact : result.contacts) {
    Name name{static_cast<int>(contact.kind), contact.first_on_o1, 0, 0, 0, 0};
    for (int k = 0; k < 4; ++k) name[2 + k] = contact.vertices[k];
    const int fixed = contact.kind == ContinuousContactKind::kVertexFace ? 3 : 6;
    std::sort(name.begin() + fixed, name.end());
    EXPECT_TRUE(out.emplace(name, contact.toc_lo).second) << "a contact comes twice";
  }
  return out;
}

/// @return whether the query without a callback took another way
bool expectSame(const Scene& scene, Request request) {
  const Result found = ask(scene, request);
  request.accepts_triangles = [](std::intptr_t, std::intptr_t) { return true; };
  const Result truth = ask(scene, request);
  EXPECT_EQ(found.is_collide, truth.is_collide);
  EXPECT_NEAR(found.time_of_contact, truth.time_of_contact, 1e-9);
  EXPECT_EQ(found.initially_crossing, truth.initially_crossing);
  EXPECT_EQ(found.crossings.size(), truth.crossings.size());
  const auto found_names = namesOf(found), true_names = namesOf(truth);
  EXPECT_EQ(found_names.size(), true_names.size());
  for (const auto& [name, time] : true_names) {
    const auto it = found_names.find(name);
    if (it == found_names.end())
      ADD_FAILURE() << "missed at " << time << ", kind " << name[0];
    else
      EXPECT_NEAR(it->second, time, 1e-9);
  }
  return found.counts.node_pairs != truth.counts.node_pairs;
}

TEST(FCL_MOTION_CHORDS, contactsAreThoseOfTheTruePaths) {
  Random random(4711);
  int num_contacts = 0, num_crossings = 0, num_other_way = 0;
  constexpr int kScenes = 48;
  for (int i = 0; i < kScenes; ++i) {
    SCOPED_TRACE(i);
    const Scene scene = randomScene(random, i);
    Request request;
    request.query = ContinuousQuery::kAll;
    request.num_max_contacts = static_cast<std::size_t>(-1);
    request.enable_crossings = i % 3 == 0;
    if (i % 4 == 1) request.t_max = random.uniform(0.2, 0.9);
    if (i % 6 >= 4) request.min_distance = 0.02;
    num_other_way += expectSame(scene, request);
    const Result result = ask(scene, request);
    num_contacts += static_cast<int>(result.contacts.size());
    num_crossings += static_cast<int>(result.crossings.size());
  }
  EXPECT_GT(num_contacts, 10000);
  EXPECT_GT(num_crossings, 100);
  EXPECT_GT(num_other_way, kScenes / 2);
}

/// A body that turns by up to pi, or several times along a spline, about a point at rest.
Motion largeTurn(Random& random, int kind, const Vector3<double>& at) {
  const Vector3<double> axis = random.point(1).normalized();
  if (kind == 2) {
    // From one full turn to the opposite one.
    const Vector3<double> turn = 2 * M_PI * axis;
    return std::make_shared<SplineMotion<double>>(at, at, at, at, -2 * turn, -turn, turn,
                                                  2 * turn);
  }
  const double angle = random.uniform(2.4, 3.14);
  const Matrix3<double> unit = Matrix3<double>::Identity(),
                        end = AngleAxis<double>(angle, axis).toRotationMatrix();
  if (kind == 0) return motionBetween(unit, at, end, at);
  Transform3<double> from = Transform3<double>::Identity(), to = from;
  from.translation() = at;
  to.linear() = end;
  to.translation() = at + 0.1 * axis;
  return std::make_shared<ScrewMotion<double>>(from, to);
}

TEST(FCL_MOTION_CHORDS, contactsOfLargeTurns) {
  Random random(143);
  int num_other_way = 0;
  constexpr int kScenes = 12;
  for (int i = 0; i < kScenes; ++i) {
    SCOPED_TRACE(i);
    const int kind = i % 3;
    Scene scene;
    scene.b = makeModel<Rigid>(bumpyBall(1));
    scene.motion_b = largeTurn(random, kind, kOrigin);
    // The balls touch with their bumps. In every fourth scene one deforms and turns.
    const Vector3<double> at = random.uniform(2.02, 2.06) * random.point(1).normalized();
    scene.a = makeModel<Rigid>(bumpyBall(2));
    if (i % 4 == 3) scene.a = makeModel<Deforming>(bumpyBall(2), bumpyBall(2.2));
    scene.motion_a = i % 2 == 0 ? motionBetween(Matrix3<double>::Identity(), at,
                                                Matrix3<double>::Identity(), at)
                                : largeTurn(random, (kind + 1) % 3, at);
    Request request;
    request.query = ContinuousQuery::kAll;
    request.num_max_contacts = static_cast<std::size_t>(-1);
    if (i % 5 == 4) request.min_distance = 0.01;
    if (i % 4 == 2) request.t_max = random.uniform(0.3, 0.9);
    num_other_way += expectSame(scene, request);
  }
  // None of them takes the true paths, unless these show at once that the balls are
  // apart.
  EXPECT_GT(num_other_way, kScenes - 3);
}

/// Just before and after a contact. Chords list pairs by time, up to a rounding.
TEST(FCL_MOTION_CHORDS, noContactBeginsAfterTheLastTime) {
  Random random(88);
  int num_asked = 0;
  for (int i = 0; i < 12; ++i) {
    const Scene scene = randomScene(random, i);
    Request request;
    request.query = ContinuousQuery::kAll;
    request.num_max_contacts = static_cast<std::size_t>(-1);
    if (i % 2 == 1) request.min_distance = 0.02;
    const Result all = ask(scene, request);
    for (std::size_t k = 0; k < all.contacts.size(); k += 1 + all.contacts.size() / 4) {
      if (all.contacts[k].toc_lo == 0) continue;
      request.t_max = all.contacts[k].toc_lo * (1 - std::ldexp(1, -42));
      for (const auto& contact : ask(scene, request).contacts)
        EXPECT_LE(contact.toc_lo, request.t_max) << i << ", " << k;
      ++num_asked;
    }
  }
  EXPECT_GT(num_asked, 20);
}

/// The earliest ones are kept, and the answer does not depend on the number of threads.
TEST(FCL_MOTION_CHORDS, fewerContactsAndMoreThreads) {
  Random random(12);
  int num_cut = 0;
  for (int i = 0; i < 8; ++i) {
    const Scene scene = randomScene(random, i);
    Request request;
    request.query = ContinuousQuery::kAll;
    request.num_max_contacts = static_cast<std::size_t>(-1);
    const Result all = ask(scene, request);
    request.num_threads = 4;
    const Result threads = ask(scene, request);
    ASSERT_EQ(threads.contacts.size(), all.contacts.size());
    for (std::size_t k = 0; k < all.contacts.size(); ++k) {
      EXPECT_EQ(threads.contacts[k].toc_lo, all.contacts[k].toc_lo);
      EXPECT_EQ(threads.contacts[k].toc_hi, all.contacts[k].toc_hi);
      EXPECT_EQ(threads.contacts[k].vertices, all.contacts[k].vertices);
    }
    request.num_max_contacts = 5;
    const Result few = ask(scene, request);
    if (all.contacts.size() <= 5) continue;
    ++num_cut;
    EXPECT_TRUE(few.contacts_cut);
    ASSERT_EQ(few.contacts.size(), 5U);
    for (std::size_t k = 0; k < 5; ++k)
      EXPECT_EQ(few.contacts[k].toc_lo, all.contacts[k].toc_lo);
  }
  EXPECT_GT(num_cut, 2);
}

}  // namespace
}  // namespace test
}  // namespace fcl
