// SPDX-License-Identifier: BSD-3-Clause
//
// First contacts: what a query leaves out because of a contact that it has found. The
// answer does not depend on it.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "moving_mesh.h"
#include "named_contacts.h"
#include "query/deformable_query.h"
#include "sanitizer.h"
#include "test_models.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

using test::Body;
using test::Ids;
using test::listOf;
using test::MovingMesh;
using test::nameOf;
using test::PairName;
using test::PreparedMovingMesh;
using test::query;
using test::Random;
using test::TestMesh;

/// Tips of triangles that move to faces that come towards them, both as fast as their
/// boxes allow. Each two are far from all others.
struct HeadOn {
  MovingMesh tips, faces;

  void add(const Vector3<double>& center, const Vector3<double>& way, double speed,
           double meeting) {
    const Vector3<double> side =
        way.cross(Vector3<double>(way[1] + 2, way[2] - 3, way[0])).normalized();
    const Vector3<double> other = way.cross(side).normalized();
    const Vector3<double> motion = speed * way;
    const Vector3<double> tip = center - meeting * motion;
    addTriangle(tips, {tip, tip - way + side, tip - way - side}, motion);
    const Vector3<double> middle = center + meeting * motion;
    addTriangle(faces, {middle - side - other, middle + side - other, middle + 2 * other},
                -motion);
  }

  static void addTriangle(MovingMesh& mesh, const std::array<Vector3<double>, 3>& x,
                          const Vector3<double>& motion) {
    const std::size_t n = mesh.t0.size();
    for (const Vector3<double>& p : x) {
      mesh.t0.push_back(p);
      mesh.t1.push_back(p + motion);
    }
    mesh.triangles.emplace_back(n, n + 1, n + 2);
  }

  MovingMesh both() const {
    MovingMesh mesh = tips;
    for (const Triangle& t : faces.triangles)
      mesh.triangles.emplace_back(t[0] + tips.t0.size(), t[1] + tips.t0.size(),
                                  t[2] + tips.t0.size());
    mesh.t0.insert(mesh.t0.end(), faces.t0.begin(), faces.t0.end());
    mesh.t1.insert(mesh.t1.end(), faces.t1.begin(), faces.t1.end());
    return mesh;
  }
};

/// The first contact is the first of all contacts, to the bit.
void expectFirstOfAll(const Body& a, const Body& b, std::size_t count,
                      std::uint64_t& left_out) {
  const QueryAnswer all = query(a, b, QueryOptions());
  ASSERT_GE(all.contacts.size(), count);
  QueryOptions options;
  options.query = ContinuousQuery::kFirst;
  const QueryAnswer first = query(a, b, options);
  ASSERT_FALSE(first.contacts.empty());
  EXPECT_EQ(first.contacts.front().toc_lo, all.first.lo);
  EXPECT_EQ(first.contacts.front().toc_hi, all.first.hi);
  left_out += all.counts.feature_pairs - first.counts.feature_pairs;
}

// The first contact bounds the distance of pairs that can still matter. The bound is not
// too small: it includes the fastest motion, along an axis or a diagonal, of the mesh or
// of its pose.
TEST(FCL_DEFORMABLE_QUERY_FIRST, firstContactOfWhatRushesIn) {
  constexpr std::size_t kCount = 600;  // several blocks
  std::uint64_t left_out = 0;
  for (std::uint64_t seed = 6000; seed < 6000 + test::rounds(60U); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const auto randomWay = [&random] {
      Vector3<double> way = Vector3<double>::Zero();
      while (way == Vector3<double>::Zero())
        for (int k = 0; k < 3; ++k) way[k] = static_cast<double>(random.index(3)) - 1;
      return way;
    };
    const Vector3<double> one_way = randomWay();
    // The first few meet at nearly the same time.
    const double first = random.uniform(0.01, 0.05);
    HeadOn any, same;
    for (std::size_t i = 0; i < kCount; ++i) {
      const Vector3<double> center(10. * static_cast<double>(i % 8),
                                   10. * static_cast<double>(i / 8 % 8),
                                   10. * static_cast<double>(i / 64));
      const double meeting =
          i % 2 ? first * random.uniform(1, 1.1) : random.uniform(first, 1);
      any.add(center, randomWay(), std::ldexp(1, -static_cast<int>(random.index(6))),
              meeting);
      same.add(center, one_way, 1, meeting);
    }
    const MovingMesh mesh = any.both();
    const PreparedMovingMesh self(mesh), a(any.tips), b(any.faces), c(same.faces);
    // The tips stand still, and their pose moves them.
    MovingMesh still = same.tips;
    still.t1 = still.t0;
    Pose end;
    for (int k = 0; k < 3; ++k) end.translation[k] = one_way[k];
    const PreparedMovingMesh posed(still, Pose(), end);
    const Body body{self.instance(), mesh.triangles};
    const Body body_a{a.instance(), any.tips.triangles},
        body_b{b.instance(), any.faces.triangles},
        body_c{c.instance(), same.faces.triangles},
        body_d{posed.instance(), still.triangles};
    expectFirstOfAll(body, body, kCount, left_out);
    expectFirstOfAll(body_a, body_b, kCount, left_out);
    expectFirstOfAll(body_b, body_a, kCount, left_out);
    expectFirstOfAll(body_c, body_d, kCount, left_out);
    expectFirstOfAll(body_d, body_c, kCount, left_out);
    ASSERT_FALSE(HasFailure());
  }
  EXPECT_GT(left_out, test::rounds(10000U));
}

// A query of a large mesh begins with a few steps in all parts of it.
TEST(FCL_DEFORMABLE_QUERY_FIRST, firstContactOfALargeMesh) {
  constexpr std::size_t kCount = 33000;  // pairs of triangles
  std::uint64_t left_out = 0;
  for (std::uint64_t seed = 6100; seed < 6102; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    HeadOn scene;
    const std::size_t first = random.index(kCount);
    for (std::size_t i = 0; i < kCount; ++i)
      scene.add(
          {10. * static_cast<double>(i % 30), 10. * static_cast<double>(i / 30 % 30),
           10. * static_cast<double>(i / 900)},
          {1, 0, 0}, 1, i == first ? 0.01 : random.uniform(0.02, 1));
    const MovingMesh mesh = scene.both();
    const PreparedMovingMesh prepared(mesh);
    const Body body{prepared.instance(), mesh.triangles};
    expectFirstOfAll(body, body, kCount, left_out);
    ASSERT_FALSE(HasFailure());
  }
  EXPECT_GT(left_out, 10000U);
}

// Of a list that is cut, each part of the query knows what the others have found.
TEST(FCL_DEFORMABLE_QUERY_FIRST, earliestOfManyContacts) {
  Random random(66);
  HeadOn scene;
  for (std::size_t i = 0; i < 8000; ++i)
    scene.add({10. * static_cast<double>(i % 20), 10. * static_cast<double>(i / 20 % 20),
               10. * static_cast<double>(i / 400)},
              {1, 0, 0}, 1, random.uniform(0.02, 1));
  const MovingMesh mesh = scene.both();
  const PreparedMovingMesh prepared(mesh);
  const Body body{prepared.instance(), mesh.triangles};
  const QueryAnswer all = query(body, body, QueryOptions());
  const auto whole = listOf(all);
  for (const std::size_t kept : {1U, 10U, 40U})
    for (const int threads : {1, 4}) {
      QueryOptions options;
      options.max_contacts = kept;
      options.num_threads = threads;
      const QueryAnswer some = query(body, body, options);
      EXPECT_TRUE(some.cut);
      EXPECT_EQ(listOf(some), decltype(whole)(whole.begin(), whole.begin() + kept));
      EXPECT_EQ(some.first.lo, all.first.lo);
      EXPECT_EQ(some.first.hi, all.first.hi);
      EXPECT_LT(some.counts.contacts, all.counts.contacts / 4);
    }
}

/// Adds a sphere that is scaled about a point beside its center by a factor below 0: all
/// its vertices meet there, but for rounding.
void addCollapse(const Vector3<double>& center, double factor, MovingMesh& mesh) {
  const TestMesh sphere = test::makeUvSphere(8, 5, 1);
  const std::size_t first = mesh.t0.size();
  const Vector3<double> about = center + Vector3<double>(.1, .05, .07);
  for (const Vector3<double>& p : sphere.vertices) {
    mesh.t0.push_back(center + p);
    mesh.t1.push_back(about + factor * (mesh.t0.back() - about));
  }
  for (const Triangle& t : sphere.triangles)
    mesh.triangles.emplace_back(first + t[0], first + t[1], first + t[2]);
}

/// Compares the time of a query that asks for nothing else with that of all contacts.
/// @return exact tests of the query for the time, and of that for all contacts
std::array<std::uint64_t, 2> expectTimeAlone(const MeshInstance& a, const Body& body) {
  const QueryAnswer all = query(body, body, QueryOptions());
  EXPECT_FALSE(all.contacts.empty());
  QueryOptions options;
  options.query = ContinuousQuery::kFirst;
  options.max_contacts = 1;
  options.only_time = true;
  const QueryAnswer alone = querySelf(a, options);
  EXPECT_GT(alone.first.lo, 0);
  EXPECT_LE(alone.first.lo, all.first.hi);
  EXPECT_GE(alone.first.lo, all.first.lo - options.toc_err);
  EXPECT_GE(alone.first.hi, all.first.lo);
  EXPECT_LE(alone.first.hi - alone.first.lo, options.toc_err);
  for (const int threads : {2, 4}) {
    options.num_threads = threads;
    const QueryAnswer again = querySelf(a, options);
    EXPECT_EQ(again.first.lo, alone.first.lo);
    EXPECT_EQ(again.first.hi, alone.first.hi);
  }
  return {alone.counts.exact_tests, all.counts.exact_tests};
}

// Where all meets at one place, integers have to decide each pair. For the time alone
// a few are enough.
TEST(FCL_DEFORMABLE_QUERY_FIRST, timeAloneOfWhatMeetsAtOnePlace) {
  for (const double factor : {-0.3, -0.7, -1., -2., 0.}) {
    SCOPED_TRACE("factor " + std::to_string(factor));
    MovingMesh mesh;
    addCollapse({0, 0, 0}, factor, mesh);
    const PreparedMovingMesh prepared(mesh);
    const auto [alone, all] =
        expectTimeAlone(prepared.instance(), Body{prepared.instance(), mesh.triangles});
    EXPECT_GT(all, 1000U);
    EXPECT_LT(alone, all / 100);
  }
}

// The list of first contacts has the pairs of all contacts, whose brackets may be
// shorter. Of a list that is cut, few pairs are decided.
TEST(FCL_DEFORMABLE_QUERY_FIRST, firstContactsOfWhatMeetsAtOnePlace) {
  std::vector<double> factors = {0, -0.7, -0.3, -1, -2};
  if (test::kHasAddressSanitizer) factors.resize(2);
  for (const double factor : factors) {
    SCOPED_TRACE("factor " + std::to_string(factor));
    MovingMesh mesh;
    addCollapse({0, 0, 0}, factor, mesh);
    const PreparedMovingMesh prepared(mesh);
    const Body body{prepared.instance(), mesh.triangles};
    const QueryAnswer all = query(body, body, QueryOptions());
    QueryOptions options;
    options.query = ContinuousQuery::kFirst;
    const QueryAnswer first = query(body, body, options);
    // All meets within a few units in the last place.
    ASSERT_EQ(first.contacts.size(), all.contacts.size());
    std::set<PairName> pairs;
    for (const FeatureContact& c : all.contacts) pairs.insert(nameOf(c, true));
    for (const FeatureContact& c : first.contacts) {
      EXPECT_EQ(pairs.count(nameOf(c, true)), 1U);
      EXPECT_LE(c.toc_lo, all.first.hi);
      EXPECT_GE(c.toc_hi, all.first.lo);
      EXPECT_LE(c.toc_hi - c.toc_lo, options.toc_err);
    }
    auto expected = listOf(first);
    for (const std::size_t kept : {500U, 7U, 1U})
      for (const int threads : {1, 4}) {
        options.max_contacts = kept;
        options.num_threads = threads;
        const QueryAnswer cut = query(body, body, options);
        EXPECT_TRUE(cut.cut);
        expected.resize(kept);
        EXPECT_EQ(listOf(cut), expected);
        if (kept == 1) {
          EXPECT_LT(cut.counts.exact_tests, all.counts.exact_tests / 20);
        }
      }
  }
}

// Other pairs are left out when the triangles have another order. The bracket of the
// first contact stays, also that of the whole list.
TEST(FCL_DEFORMABLE_QUERY_FIRST, firstContactInAnyOrder) {
  Random random(63);
  for (const double noise : {0., 1e-9, 1e-6, 1e-3})
    for (const double toc_err : {1e-2, 1e-4, 1e-9})
      for (const bool only_time : {true, false}) {
        SCOPED_TRACE(std::to_string(noise) + ", " + std::to_string(toc_err) + ", " +
                     std::to_string(only_time));
        MovingMesh mesh;
        addCollapse({0, 0, 0}, -random.uniform(0, 3), mesh);
        for (Vector3<double>& p : mesh.t1) p += random.point(noise);
        QueryOptions options;
        options.query = ContinuousQuery::kFirst;
        options.only_time = only_time;
        options.toc_err = toc_err;
        std::set<std::pair<double, double>> brackets;
        for (int order = 0; order < (test::kHasAddressSanitizer ? 2 : 6); ++order) {
          if (only_time || order > 0) options.max_contacts = 1;
          const PreparedMovingMesh prepared(mesh);
          const TimeBracket first = querySelf(prepared.instance(), options).first;
          brackets.emplace(first.lo, first.hi);
          for (std::size_t i = mesh.triangles.size() - 1; i > 0; --i)
            std::swap(mesh.triangles[i], mesh.triangles[random.index(i + 1)]);
        }
        EXPECT_EQ(brackets.size(), 1U);
      }
}

// The contact that the first steps in all parts of a large mesh find is found again.
TEST(FCL_DEFORMABLE_QUERY_FIRST, timeAloneOfALargeMesh) {
  HeadOn scene;
  for (std::size_t i = 0; i < 33000; ++i)
    scene.add({10. * static_cast<double>(i % 30), 10. * static_cast<double>(i / 30 % 30),
               10. * static_cast<double>(i / 900)},
              {1, 0, 0}, 1, 0.95);
  MovingMesh mesh = scene.both();
  addCollapse({-10, 0, 0}, -2, mesh);
  const PreparedMovingMesh prepared(mesh);
  expectTimeAlone(prepared.instance(), Body{prepared.instance(), mesh.triangles});
}

/// Loose triangles, each of which moves as a whole.
MovingMesh movingTriangles(Random& random, int count, double size, double step) {
  const TestMesh soup = test::makeTriangleSoup(count, 0.5, size, random.index(1U << 30));
  MovingMesh mesh{soup.vertices, soup.vertices, soup.triangles};
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const Vector3<double> motion = random.point(step);
    for (int k = 0; k < 3; ++k) mesh.t1[mesh.id(i, k)] += motion;
  }
  return mesh;
}

// The part of the traversal that is left out depends on when the first contact is found,
// and on the width of its bracket. The first crossing that is met does not depend on it.
TEST(FCL_DEFORMABLE_QUERY_FIRST, namesTheSameCrossingWhateverIsLeftOut) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    Random random(seed);
    const MovingMesh mesh =
        movingTriangles(random, 1500 + static_cast<int>(random.index(1500)),
                        random.uniform(0.03, 0.1), 0.3);
    const PreparedMovingMesh prepared(mesh);
    QueryOptions options;
    options.query = ContinuousQuery::kFirst;
    const auto crossing = [&](int num_threads, double toc_err) {
      options.num_threads = num_threads;
      options.toc_err = toc_err;
      const QueryAnswer answer = querySelf(prepared.instance(), options);
      EXPECT_TRUE(answer.hasCrossing());
      return std::make_tuple(
          Ids(answer.crossings.front().edge, answer.crossings.front().edge + 2),
          Ids(answer.crossings.front().face, answer.crossings.front().face + 3));
    };
    const auto expected = crossing(1, 1e-6);
    for (const double toc_err : {0.5, 1e-3, 1e-6})
      for (const int num_threads : {1, 2})
        ASSERT_EQ(crossing(num_threads, toc_err), expected)
            << "seed " << seed << ", " << num_threads << " threads, " << toc_err;
  }
}

/// Each triangle is cut into nine, and gets two others like it, one closely above the
/// other. Most of the nine own less than all of their edges.
MovingMesh withLayers(const MovingMesh& mesh) {
  MovingMesh out;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
    for (int layer = 0; layer < 3; ++layer) {
      const auto corner = [&](const std::vector<Vector3<double>>& x, int k) {
        return x[mesh.id(i, k)];
      };
      const Vector3<double> v = corner(mesh.t0, 1) - corner(mesh.t0, 0),
                            w = corner(mesh.t0, 2) - corner(mesh.t0, 0),
                            up = 1e-4 * layer * v.cross(w).normalized(),
                            motion = corner(mesh.t1, 0) - corner(mesh.t0, 0);
      std::size_t rows[4][4] = {};
      for (int r = 0; r < 4; ++r)
        for (int k = 0; k <= r; ++k) {
          rows[r][k] = out.t0.size();
          out.t0.push_back(corner(mesh.t0, 0) + (r - k) / 3. * v + k / 3. * w + up);
          out.t1.push_back(out.t0.back() + motion);
        }
      for (int r = 0; r < 3; ++r)
        for (int k = 0; k <= r; ++k) {
          out.triangles.emplace_back(rows[r][k], rows[r + 1][k], rows[r + 1][k + 1]);
          if (k < r)
            out.triangles.emplace_back(rows[r][k], rows[r + 1][k + 1], rows[r][k + 1]);
        }
    }
  return out;
}

/// Adds a triangle that moves.
void addTriangle(const Vector3<double> (&corners)[3], const Vector3<double>& motion,
                 MovingMesh& mesh) {
  const std::size_t first = mesh.t0.size();
  for (const Vector3<double>& c : corners) {
    mesh.t0.push_back(c);
    mesh.t1.push_back(c + motion);
  }
  mesh.triangles.emplace_back(first, first + 1, first + 2);
}

// A contact that was found leaves out pairs that do not meet before it, but no crossing,
// wherever it is, even if nothing else is left.
TEST(FCL_DEFORMABLE_QUERY_FIRST, findsTheOnlyCrossingBehindAnEarlyContact) {
  int scenes = 0;
  for (std::uint64_t seed = 1; seed <= test::rounds(30U); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    MovingMesh mesh = withLayers(movingTriangles(random, 400, 0.02, 1e-3));
    if (querySelf(PreparedMovingMesh(mesh).instance(), QueryOptions()).hasCrossing())
      continue;
    ++scenes;
    const Vector3<double> x(0.02, 0, 0), y(0, 0.02, 0), z(0, 0, 0.02), rest(0, 0, 0);
    const Vector3<double> contact = random.point(0.5), crossing = random.point(0.5);
    addTriangle({contact, contact + x, contact + y}, rest, mesh);
    addTriangle({contact + 1e-3 * z, contact + x + z, contact + y + z}, -0.1 * z, mesh);
    addTriangle({crossing + 2 * x, crossing + 2 * y, crossing}, rest, mesh);
    const Vector3<double> inside = crossing + 0.5 * (x + y);
    // The crossing is between the first edges of both.
    addTriangle({inside - z, inside + z, inside + 3 * x + z}, rest, mesh);
    const PreparedMovingMesh prepared(mesh);
    QueryOptions options;
    options.query = ContinuousQuery::kFirst;
    const QueryAnswer answer = querySelf(prepared.instance(), options);
    EXPECT_TRUE(answer.hasCrossing());
    EXPECT_TRUE(isEarly(answer.contacts[0].toc_hi));
    EXPECT_GT(answer.counts.plane_culled, 1000U);
  }
  EXPECT_GE(scenes, test::rounds(10));
}

}  // namespace
}  // namespace deformable
}  // namespace detail
}  // namespace fcl
