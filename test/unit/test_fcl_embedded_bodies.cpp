// SPDX-License-Identifier: BSD-3-Clause
//
// A closed part of a mesh that stays star-shaped has no contact with itself. Round bodies
// are proved. Queries give the same answers with such bodies left out and without.
#include "self_culling/embedded_bodies.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "brute_force.h"
#include "moving_mesh.h"
#include "query/deformable_query.h"
#include "sanitizer.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

using test::MovingMesh;
using test::PreparedMovingMesh;
using test::Random;

const double kPi = std::acos(-1.0);

/// Turns, scales and moves the second frame.
void move(MovingMesh& mesh, double angle, double scale, Random& random) {
  const AngleAxis<double> turn(angle, random.point(1).normalized());
  const Vector3<double> away = random.point(5);
  for (auto& p : mesh.t1) p = turn * (scale * p) + away;
}

std::size_t bodiesOf(const MovingMesh& mesh) {
  const PreparedMovingMesh prepared(mesh);
  const EmbeddedRegions found = findEmbeddedBodies(prepared.tree(), kernels(), 1);
  return static_cast<std::size_t>(std::count(found.nodes.begin(), found.nodes.end(), 1));
}

/// A closed surface that winds `turns` times around the z axis.
test::TestMesh windingSphere(int slices, int stacks, int turns) {
  test::TestMesh mesh;
  for (int j = 1; j < stacks; ++j)
    for (int i = 0; i < slices; ++i) {
      const double u = 2 * kPi * turns * i / slices, v = kPi * j / stacks;
      mesh.vertices.emplace_back(std::sin(v) * std::cos(u), std::sin(v) * std::sin(u),
                                 std::cos(v));
    }
  const std::size_t top = mesh.vertices.size(), bottom = top + 1;
  mesh.vertices.emplace_back(0, 0, 1);
  mesh.vertices.emplace_back(0, 0, -1);
  const auto at = [slices](int i, int j) {
    return static_cast<std::size_t>(j * slices + i % slices);
  };
  for (int i = 0; i < slices; ++i) {
    mesh.triangles.emplace_back(top, at(i, 0), at(i + 1, 0));
    for (int j = 0; j + 2 < stacks; ++j) {
      mesh.triangles.emplace_back(at(i, j), at(i, j + 1), at(i + 1, j));
      mesh.triangles.emplace_back(at(i + 1, j), at(i, j + 1), at(i + 1, j + 1));
    }
    mesh.triangles.emplace_back(bottom, at(i + 1, stacks - 2), at(i, stacks - 2));
  }
  return mesh;
}

TEST(FCL_EMBEDDED_BODIES, roundBodiesAreProved) {
  constexpr std::uint64_t kSeed = 370;
  Random random(kSeed);
  for (int i = 0; i < test::rounds(100); ++i) {
    SCOPED_TRACE("seed " + std::to_string(kSeed) + ", " + std::to_string(i));
    MovingMesh mesh = still(i % 3 == 0   ? test::makeUvSphere(12, 9, 2)
                            : i % 3 == 1 ? windingSphere(12, 9, 1)
                                         : test::makeBox({1, 0.5, 2}, 4));
    // A body with bumps, of either orientation.
    for (auto& p : mesh.t0) p *= 1 + 0.1 * std::sin(3 * p[0] + 2 * p[1]);
    mesh.t1 = mesh.t0;
    if (i % 2)
      for (Triangle& t : mesh.triangles) t.set(t[0], t[2], t[1]);
    move(mesh, 0.5, random.uniform(0.5, 2), random);
    EXPECT_EQ(bodiesOf(mesh), 1U);
    MovingMesh many;
    for (int k = 0; k < 3; ++k) append(many, mesh);
    append(many, still(test::makeSheet(9, 9)));
    EXPECT_EQ(bodiesOf(many), 3U);
    ASSERT_FALSE(HasFailure());
  }
}

TEST(FCL_EMBEDDED_BODIES, whatIsNoBodyIsNotProved) {
  const MovingMesh ball = still(windingSphere(24, 9, 1));
  ASSERT_EQ(bodiesOf(ball), 1U);
  // It winds twice, so that each direction meets it twice.
  EXPECT_EQ(bodiesOf(still(windingSphere(24, 9, 2))), 0U);
  EXPECT_EQ(bodiesOf(still(windingSphere(48, 9, 3))), 0U);
  for (std::size_t i = 0; i < ball.triangles.size(); i += 7) {
    MovingMesh open = ball, turned = ball, twice = ball;
    open.triangles.erase(open.triangles.begin() + static_cast<std::ptrdiff_t>(i));
    EXPECT_EQ(bodiesOf(open), 0U);
    Triangle& t = turned.triangles[i];
    t.set(t[0], t[2], t[1]);
    EXPECT_EQ(bodiesOf(turned), 0U);
    twice.triangles.push_back(ball.triangles[i]);
    EXPECT_EQ(bodiesOf(twice), 0U);
  }
  // It turns inside out.
  MovingMesh inverted = ball;
  for (auto& p : inverted.t1) p *= -0.3;
  EXPECT_EQ(bodiesOf(inverted), 0U);
  MovingMesh not_finite = ball;
  not_finite.t1[5][1] = 1e300;
  EXPECT_EQ(bodiesOf(not_finite), 0U);
}

// A ball in another one: each of them is a body, both together are none.
TEST(FCL_EMBEDDED_BODIES, bodiesInBodies) {
  MovingMesh mesh = still(windingSphere(12, 9, 1));
  append(mesh, still(test::makeUvSphere(12, 9, 0.5)));
  EXPECT_EQ(bodiesOf(mesh), 2U);
}

// Whatever is proved touches itself nowhere.
TEST(FCL_EMBEDDED_BODIES, provedBodiesHaveNoContact) {
  constexpr std::uint64_t kSeed = 371;
  Random random(kSeed);
  int proved = 0, with_contacts = 0;
  for (int i = 0; i < test::manyRounds(150); ++i) {
    SCOPED_TRACE("seed " + std::to_string(kSeed) + ", " + std::to_string(i));
    MovingMesh mesh = still(windingSphere(8, 7, 1));
    const double most = i % 2 ? 0.5 : 0.15;
    const double shake = random.uniform(0, most), step = random.uniform(0, most);
    for (auto& p : mesh.t0) p += random.point(shake);
    for (std::size_t k = 0; k < mesh.t0.size(); ++k)
      mesh.t1[k] = mesh.t0[k] + random.point(step);
    move(mesh, random.uniform(0, 1), random.uniform(0.5, 2), random);
    const bool has_contact =
        !test::bruteForceSelfContacts({mesh.t0, mesh.t1, mesh.triangles}).empty();
    const bool is_body = bodiesOf(mesh) == 1;
    EXPECT_FALSE(is_body && has_contact);
    proved += is_body;
    with_contacts += has_contact;
    ASSERT_FALSE(HasFailure());
  }
  EXPECT_GT(proved, test::rounds(24));
  EXPECT_GT(with_contacts, test::rounds(24));
}

/// Balls that meet, on a sheet.
MovingMesh meetingBalls(Random& random) {
  MovingMesh mesh = still(test::makeSheet(12, 12));
  for (int i = 0; i < 12; ++i) {
    MovingMesh ball = still(windingSphere(10, 8, 1));
    const Vector3<double> at = random.point(1);
    for (auto& p : ball.t0) p = 0.3 * p + at;
    ball.t1 = ball.t0;
    const Vector3<double> away = random.point(1);
    for (auto& p : ball.t1) p += away;
    append(mesh, ball);
  }
  return mesh;
}

QueryAnswer answerOf(const MeshInstance& mesh, ContinuousQuery query, bool with_bodies,
                     int num_threads = 1) {
  QueryOptions options;
  options.query = query;
  options.leaves_out_regions = with_bodies;
  options.num_threads = num_threads;
  return querySelf(mesh, options);
}

std::vector<std::uint64_t> bitsOf(const QueryAnswer& answer) {
  std::vector<std::uint64_t> out;
  for (const FeatureContact& c : answer.contacts) {
    out.push_back(static_cast<std::uint64_t>(c.kind));
    for (const std::uint32_t v : c.vertices) out.push_back(v);
    for (const std::int32_t t : c.triangles) out.push_back(static_cast<std::uint64_t>(t));
    for (const double x : {c.toc_lo, c.toc_hi}) {
      std::uint64_t bits;
      std::memcpy(&bits, &x, sizeof(bits));
      out.push_back(bits);
    }
  }
  return out;
}

TEST(FCL_EMBEDDED_BODIES, queriesAnswerTheSame) {
  constexpr std::uint64_t kSeed = 372;
  Random random(kSeed);
  std::size_t contacts = 0;
  for (int i = 0; i < test::rounds(12); ++i) {
    SCOPED_TRACE("seed " + std::to_string(kSeed) + ", " + std::to_string(i));
    const MovingMesh mesh = meetingBalls(random);
    EXPECT_EQ(bodiesOf(mesh), 12U);
    const PreparedMovingMesh prepared(mesh);
    for (const ContinuousQuery query : {ContinuousQuery::kAll, ContinuousQuery::kFirst}) {
      const QueryAnswer without = answerOf(prepared.instance(), query, false);
      for (const int num_threads : {1, 3}) {
        const QueryAnswer with = answerOf(prepared.instance(), query, true, num_threads);
        EXPECT_EQ(bitsOf(with), bitsOf(without));
        EXPECT_EQ(with.hasCrossing(), without.hasCrossing());
        EXPECT_LT(with.counts.node_pairs, without.counts.node_pairs);
      }
      contacts += without.counts.contacts;
    }
    ASSERT_FALSE(HasFailure());
  }
  EXPECT_GT(contacts, test::rounds(2000U));
}

TEST(FCL_EMBEDDED_BODIES, doNotDependOnThreadsOrKernels) {
  constexpr std::uint64_t kSeed = 373;
  Random random(kSeed);
  const MovingMesh mesh = meetingBalls(random);
  const PreparedMovingMesh prepared(mesh);
  const EmbeddedRegions one = findEmbeddedBodies(prepared.tree(), kernels(), 1);
  EXPECT_EQ(std::count(one.nodes.begin(), one.nodes.end(), 1), 12);
  for (const Kernels* k : allKernels())
    for (const int num_threads : {1, 3}) {
      const EmbeddedRegions other = findEmbeddedBodies(prepared.tree(), *k, num_threads);
      EXPECT_EQ(other.nodes, one.nodes) << k->name;
      EXPECT_EQ(other.interior, one.interior) << k->name;
    }
}

}  // namespace
}  // namespace deformable
}  // namespace detail
}  // namespace fcl
