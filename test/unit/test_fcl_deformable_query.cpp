// SPDX-License-Identifier: BSD-3-Clause
//
// Whole queries against brute force, which is the exact test of every feature pair of the
// scene.
#include "query/deformable_query.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "api/prepared_mesh.h"
#include "elementary/exact.h"
#include "elementary/predicates.h"
#include "fcl/math/bv/OBBRSS.h"
#include "fcl/math/bv/kDOP.h"
#include "fcl/math/bv/kIOS.h"
#include "moving_mesh.h"
#include "placed_mesh.h"
#include "sanitizer.h"
#include "test_models.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

using test::MovingMesh;
using test::PreparedMovingMesh;
using test::Random;
using test::TestMesh;

using Ids = std::vector<std::uint32_t>;
/// Kind, whether the vertex of a VF pair is in mesh b, ids of both features.
using PairName = std::tuple<ContinuousContactKind, bool, Ids, Ids>;
using Contacts = std::map<PairName, ElementaryResult>;

struct Truth {
  Contacts contacts;
  bool has_crossing{false};

  double earliestLo() const {
    double lo = 1;
    for (const auto& [name, r] : contacts) lo = std::min(lo, r.toc_lo);
    return lo;
  }
  double earliestHi() const {
    double hi = 1;
    for (const auto& [name, r] : contacts) hi = std::min(hi, r.toc_hi);
    return hi;
  }
};

Ids sorted(Ids ids) {
  std::sort(ids.begin(), ids.end());
  return ids;
}

/// A mesh as a query uses it, with its triangles by the user's ids.
struct Body {
  const MeshInstance& instance;
  const std::vector<Triangle>& triangles;

  Ids ids(std::size_t i) const {
    const Triangle& t = triangles[i];
    return {static_cast<std::uint32_t>(t[0]), static_cast<std::uint32_t>(t[1]),
            static_cast<std::uint32_t>(t[2])};
  }
};

/// The distinct features of a mesh, from its triangles' ids alone.
struct Features {
  std::set<Ids> vertices, edges, faces;

  explicit Features(const Body& body) {
    for (std::size_t i = 0; i < body.triangles.size(); ++i) {
      const Ids v = body.ids(i);
      for (std::size_t k = 0; k < 3; ++k) {
        vertices.insert({v[k]});
        if (v[k] != v[(k + 1) % 3]) edges.insert(sorted({v[k], v[(k + 1) % 3]}));
      }
      faces.insert(sorted(v));
    }
  }
};

/// All contacts between features xs of x and ys of y, by the exact test.
class BruteForce {
 public:
  BruteForce(const Body& a, const Body& b)
      : a_(a), b_(b), self_(&a == &b), features_a_(a), features_b_(b) {
    test(ContinuousContactKind::kEdgeEdge, features_a_.edges, features_b_.edges, false);
    test(ContinuousContactKind::kVertexFace, features_a_.vertices, features_b_.faces,
         false);
    crossings(a_, features_a_.edges, b_, features_b_.faces);
    if (self_) return;
    test(ContinuousContactKind::kVertexFace, features_b_.vertices, features_a_.faces,
         true);
    crossings(b_, features_b_.edges, a_, features_a_.faces);
  }
  const Truth& truth() const { return truth_; }

 private:
  void test(ContinuousContactKind kind, const std::set<Ids>& xs, const std::set<Ids>& ys,
            bool first_on_b) {
    for (const Ids& x : xs)
      for (const Ids& y : ys) {
        if (kind == ContinuousContactKind::kEdgeEdge && self_ && y < x) continue;
        if (self_ && doShare(x, y)) continue;
        std::vector<VertexPath> p = paths(first_on_b ? b_ : a_, x);
        for (const VertexPath& q : paths(first_on_b ? a_ : b_, y)) p.push_back(q);
        if (areApart(p, x.size())) continue;
        const ElementaryResult r =
            decideExactly(kind, {{&p[0], &p[1], &p[2], &p[3]}}, 1e-12);
        if (r.answer == Answer::kYes) truth_.contacts[{kind, first_on_b, x, y}] = r;
      }
  }

  void crossings(const Body& m, const std::set<Ids>& edges, const Body& n,
                 const std::set<Ids>& faces) {
    for (const Ids& x : edges)
      for (const Ids& y : faces) {
        if (self_ && doShare(x, y)) continue;
        const auto e = paths(m, x), f = paths(n, y);
        truth_.has_crossing |= isCrossing(e[0].t0, e[1].t0, f[0].t0, f[1].t0, f[2].t0);
      }
  }

  static bool doShare(const Ids& x, const Ids& y) {
    return std::any_of(x.begin(), x.end(), [&y](std::uint32_t id) {
      return std::find(y.begin(), y.end(), id) != y.end();
    });
  }
  static std::vector<VertexPath> paths(const Body& body, const Ids& ids) {
    std::vector<VertexPath> p;
    for (const std::uint32_t id : ids) p.push_back(body.instance.frames[id]);
    return p;
  }
  /// Whether one axis separates the first n points from all others at both ends of the
  /// step, in the same direction. It uses comparisons only, so that it is exact.
  static bool areApart(const std::vector<VertexPath>& p, std::size_t n) {
    for (int k = 0; k < 3; ++k) {
      bool below = true, above = true;
      for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = n; j < p.size(); ++j) {
          below &= p[i].t0[k] < p[j].t0[k] && p[i].t1[k] < p[j].t1[k];
          above &= p[i].t0[k] > p[j].t0[k] && p[i].t1[k] > p[j].t1[k];
        }
      if (below || above) return true;
    }
    return false;
  }

  const Body& a_;
  const Body& b_;
  bool self_;
  Features features_a_, features_b_;
  Truth truth_;
};

PairName nameOf(const FeatureContact& c, bool self) {
  const std::uint32_t* v = c.vertices;
  if (c.kind == ContinuousContactKind::kVertexFace)
    return {c.kind, !c.first_on_a, {v[0]}, sorted({v[1], v[2], v[3]})};
  Ids x = sorted({v[0], v[1]}), y = sorted({v[2], v[3]});
  if (self && y < x) std::swap(x, y);
  return {c.kind, false, x, y};
}

/// The contacts of a self-collision, by name, with their brackets.
std::vector<std::tuple<double, double, PairName>> listOf(const QueryAnswer& answer) {
  std::vector<std::tuple<double, double, PairName>> list;
  for (const FeatureContact& c : answer.contacts)
    list.emplace_back(c.toc_lo, c.toc_hi, nameOf(c, true));
  return list;
}

bool hasAll(const Ids& triangle, const Ids& ids) {
  return std::all_of(ids.begin(), ids.end(), [&triangle](std::uint32_t id) {
    return std::find(triangle.begin(), triangle.end(), id) != triangle.end();
  });
}

/// Every contact exists and is listed once, with a bracket of its time and the triangles
/// that have it, the earliest first.
void expectTrueContacts(const QueryAnswer& answer, const Truth& truth, const Body& a,
                        const Body& b, double toc_err) {
  const bool self = &a == &b;
  std::set<PairName> met;
  for (const FeatureContact& c : answer.contacts) {
    const PairName name = nameOf(c, self);
    EXPECT_TRUE(met.insert(name).second) << "reported twice";
    const auto found = truth.contacts.find(name);
    ASSERT_NE(found, truth.contacts.end()) << "not a contact";
    EXPECT_LE(c.toc_lo, found->second.toc_hi);
    EXPECT_GE(c.toc_hi, found->second.toc_lo);
    EXPECT_LE(c.toc_hi - c.toc_lo, toc_err);
    const auto& [kind, first_on_b, x, y] = name;
    const Ids s = a.ids(static_cast<std::size_t>(c.triangles[0]));
    const Ids t = b.ids(static_cast<std::size_t>(c.triangles[1]));
    EXPECT_TRUE((hasAll(s, first_on_b ? y : x) && hasAll(t, first_on_b ? x : y)) ||
                (self && kind == ContinuousContactKind::kEdgeEdge && hasAll(s, y) &&
                 hasAll(t, x)));
  }
  EXPECT_TRUE(std::is_sorted(answer.contacts.begin(), answer.contacts.end(), isEarlier));
}

QueryAnswer query(const Body& a, const Body& b, const QueryOptions& options) {
  return &a == &b ? querySelf(a.instance, options)
                  : queryPair(a.instance, b.instance, options);
}

void expectAll(const Body& a, const Body& b, const Truth& truth) {
  QueryOptions options;
  options.toc_err = 1e-6;
  const QueryAnswer all = query(a, b, options);
  expectTrueContacts(all, truth, a, b, options.toc_err);
  EXPECT_EQ(all.contacts.size(), truth.contacts.size());
  EXPECT_FALSE(all.cut);
  EXPECT_EQ(all.hasCrossing(), truth.has_crossing);
  const StageCounts& n = all.counts;
  EXPECT_EQ(n.feature_pairs, n.box_culled + n.mask_culled + n.filter_culled +
                                 n.solver_culled + n.exact_culled + n.contacts);
  EXPECT_LE(n.exact_culled, n.exact_tests);
  if (a.instance.hasOwners() && b.instance.hasOwners()) {
    EXPECT_EQ(n.contacts, truth.contacts.size());
  }
}

void expectEarliest(const Body& a, const Body& b, const Truth& truth,
                    std::size_t max_contacts) {
  QueryOptions options;
  options.query = ContinuousQuery::kFirst;
  options.max_contacts = max_contacts;
  options.toc_err = 1e-6;
  const QueryAnswer first = query(a, b, options);
  expectTrueContacts(first, truth, a, b, options.toc_err);
  EXPECT_EQ(first.hasCrossing(), truth.has_crossing);
  ASSERT_EQ(first.contacts.empty(), truth.contacts.empty());
  if (truth.contacts.empty()) return;
  EXPECT_LE(first.contacts.front().toc_lo, truth.earliestHi());
  EXPECT_GE(first.contacts.front().toc_lo, truth.earliestLo() - options.toc_err);
}

void expectKEarliest(const Body& a, const Body& b, const Truth& truth, std::size_t k) {
  SCOPED_TRACE("at most " + std::to_string(k));
  QueryOptions options;
  options.max_contacts = k;
  options.toc_err = 1e-6;
  const QueryAnswer some = query(a, b, options);
  expectTrueContacts(some, truth, a, b, options.toc_err);
  EXPECT_EQ(some.contacts.size(), std::min(k, truth.contacts.size()));
  EXPECT_EQ(some.cut, truth.contacts.size() > k);
  EXPECT_EQ(some.hasCrossing(), truth.has_crossing);
  if (some.contacts.empty()) return;
  std::set<PairName> kept;
  for (const FeatureContact& c : some.contacts) kept.insert(nameOf(c, &a == &b));
  for (const auto& [name, r] : truth.contacts)
    if (!kept.count(name)) {
      EXPECT_GE(r.toc_hi, some.contacts.back().toc_lo);
    }
}

/// All kinds of queries against brute force; returns the number of contacts.
std::size_t expectRightAnswers(const Body& a, const Body& b) {
  const Truth truth = BruteForce(a, b).truth();
  expectAll(a, b, truth);
  expectEarliest(a, b, truth, static_cast<std::size_t>(-1));
  expectEarliest(a, b, truth, 1);
  const std::size_t total = truth.contacts.size();
  for (const std::size_t k : {std::size_t{1}, total / 2, total, total + 1})
    if (k > 0) expectKEarliest(a, b, truth, k);

  QueryOptions any;
  any.query = ContinuousQuery::kAny;
  const QueryAnswer answer = query(a, b, any);
  EXPECT_EQ(answer.hasCrossing() || !answer.contacts.empty(),
            truth.has_crossing || total > 0);
  QueryOptions stop;
  stop.only_time = true;
  EXPECT_EQ(query(a, b, stop).hasCrossing(), truth.has_crossing);
  return total;
}

/// Small triangles at random places, some of which share vertices. In every third mesh
/// coordinates are on a coarse grid. With defects: some triangles repeat a vertex, some
/// are equal to others with another order of vertices, and one vertex has no triangle.
MovingMesh smallSoup(Random& random, std::size_t count, double step,
                     bool with_defects = true) {
  MovingMesh mesh;
  const bool on_grid = random.index(3) == 0;
  const auto add = [&](const Vector3<double>& p) {
    mesh.t0.push_back(p);
    mesh.t1.push_back(p + random.point(step));
    if (on_grid)
      for (auto* q : {&mesh.t0.back(), &mesh.t1.back()})
        for (int k = 0; k < 3; ++k) (*q)[k] = std::round(4 * (*q)[k]) / 4;
    return mesh.t0.size() - 1;
  };
  if (with_defects) add(random.point(1));
  while (mesh.triangles.size() < count) {
    const Vector3<double> center = random.point(1);
    std::size_t v[3];
    for (auto& id : v) id = add(center + random.point(0.4));
    mesh.triangles.emplace_back(v[0], v[1], v[2]);
    const std::size_t w = add(center + random.point(0.4));
    switch (with_defects ? random.index(6) : 3) {
      case 0:
        mesh.triangles.emplace_back(v[1], v[0], w);
        mesh.triangles.emplace_back(v[0], v[1], w);
        break;
      case 1:
        mesh.triangles.emplace_back(v[2], v[2], w);
        break;
      case 2:
        mesh.triangles.emplace_back(v[2], v[1], v[0]);
        break;
      default:
        mesh.triangles.emplace_back(v[2], w, v[1]);
    }
  }
  return mesh;
}

TEST(FCL_DEFORMABLE_QUERY, selfAgainstBruteForce) {
  std::size_t contacts = 0;
  for (std::uint64_t seed = 1000; seed < 1000 + test::rounds(300U); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const MovingMesh mesh =
        seed % 2
            ? smallSoup(random, 20 + random.index(20), 0.4)
            : test::crumpledSheet(random, 3 + static_cast<int>(random.index(2)), 0.25);
    const PreparedMovingMesh prepared(mesh);
    const Body body{prepared.instance(), mesh.triangles};
    contacts += expectRightAnswers(body, body);
    ASSERT_FALSE(HasFailure());
  }
  EXPECT_GT(contacts, test::rounds(1000U));
}

/// Moves some vertices far away, in one frame or in both.
void letFly(Random& random, double far, std::size_t count, MovingMesh& mesh) {
  const std::size_t frames = 1 + random.index(3);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t id = random.index(mesh.t0.size());
    const Vector3<double> away = far * random.point(1);
    if (frames & 1U) mesh.t0[id] += away;
    if (frames & 2U) mesh.t1[id] += away;
  }
}

TEST(FCL_DEFORMABLE_QUERY, flyingVerticesAgainstBruteForce) {
  std::size_t contacts = 0;
  for (std::uint64_t seed = 4000; seed < 4000 + test::rounds(60U); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const double far = std::pow(10, random.uniform(1, 40));
    MovingMesh a = test::crumpledSheet(random, 4, 0.25),
               b = test::crumpledSheet(random, 3, 0.25);
    letFly(random, far, 1 + random.index(3), a);
    if (seed % 3 == 0) letFly(random, far, 1, b);
    Pose beginning, end;
    if (seed % 2)
      for (int k = 0; k < 3; ++k) {
        beginning.translation[k] = random.uniform(-0.2, 0.2);
        end.translation[k] = random.uniform(-0.2, 0.2);
      }
    const PreparedMovingMesh pa(a, beginning, end), pb(b);
    const Body body_a{pa.instance(), a.triangles}, body_b{pb.instance(), b.triangles};
    contacts += expectRightAnswers(body_a, body_a) + expectRightAnswers(body_a, body_b);
    ASSERT_FALSE(HasFailure());
  }
  EXPECT_GT(contacts, test::rounds(500U));
}

// If a simulation loses a vertex, a query takes only little longer: the boxes of all
// other triangles still separate them.
TEST(FCL_DEFORMABLE_QUERY, flyingVerticesCostLittle) {
  constexpr std::uint64_t kSeed = 5000;
  Random random(kSeed);
  MovingMesh a = test::crumpledSheet(random, 40, 0.02);
  MovingMesh b = test::crumpledSheet(random, 40, 0.02);
  for (auto* points : {&b.t0, &b.t1})
    for (auto& p : *points) p[2] += 0.01;
  // In random order, except for the first.
  for (MovingMesh* mesh : {&a, &b})
    for (std::size_t i = mesh->triangles.size() - 1; i > 1; --i)
      std::swap(mesh->triangles[i], mesh->triangles[1 + random.index(i)]);
  Pose beginning, end;
  beginning.translation[0] = 0.3;
  end.translation[0] = 0.1;
  const auto boxesOf = [&](const MovingMesh& x, const MovingMesh& y) {
    const PreparedMovingMesh px(x), py(y, beginning, end);
    return std::array<std::uint64_t, 4>{
        querySelf(px.instance(), QueryOptions()).counts.node_pairs,
        querySelf(py.instance(), QueryOptions()).counts.node_pairs,
        queryPair(px.instance(), py.instance(), QueryOptions()).counts.node_pairs,
        queryPair(py.instance(), px.instance(), QueryOptions()).counts.node_pairs};
  };
  const auto usual = boxesOf(a, b);
  for (const double far : {10., 1e3, 1e5, 1e7, 1e9, 1e15, 1e30}) {
    MovingMesh flying_a = a, flying_b = b;
    letFly(random, far, 2, flying_a);
    letFly(random, far, 1, flying_b);
    // The vertex is far away when the tree is built, in the first triangle: below all
    // others and above.
    for (int k = 0; k < 3; ++k) {
      flying_a.t0[a.triangles[0][0]][k] -= far;
      flying_b.t0[b.triangles[0][0]][k] += far;
    }
    const auto counts = boxesOf(flying_a, flying_b);
    for (std::size_t i = 0; i < counts.size(); ++i)
      EXPECT_LT(counts[i], 2 * usual[i]) << "seed " << kSeed << ", " << far << ", " << i;
    // The whole mesh jumps. A box at t = 1 still has the size that rounds there.
    MovingMesh jumping = a;
    const double size = std::min(far, 1e9);
    for (auto& p : jumping.t1) p += Vector3<double>(size, -size, size);
    EXPECT_LT(boxesOf(jumping, b)[0], 2 * usual[0]) << "seed " << kSeed << ", " << far;
  }
}

// The same for a mesh with FCL's own tree.
TEST(FCL_DEFORMABLE_QUERY, farVerticesOfARigidMeshCostLittle) {
  const TestMesh near = test::bentSheet(24);
  const auto sheet = test::makeModel<BVHModel<KDOP<double, 16>>>(near);
  const auto boxesOf = [&](const TestMesh& mesh, auto volume) {
    const auto model = test::makeModel<BVHModel<decltype(volume)>>(mesh);
    const Transform3<double> still = Transform3<double>::Identity();
    Transform3<double> begin = still, end = still;
    begin.translation() << 0.02, 0.1, 0.05;
    end.translation() << 0.02, 0.1, -0.02;
    const test::PlacedMesh px(*model, begin, end, "x"), py(*sheet, still, still, "y");
    return std::array<std::uint64_t, 2>{
        queryPair(px.instance(), py.instance(), QueryOptions()).counts.node_pairs,
        queryPair(py.instance(), px.instance(), QueryOptions()).counts.node_pairs};
  };
  for (const double far : {1e3, 1e5, 1e7, 1e9}) {
    TestMesh mesh = near;
    mesh.vertices[near.vertices.size() / 3] +=
        Vector3<double>(far, -0.2 * far, 0.5 * far);
    const auto expectLittle = [&](auto volume) {
      const auto usual = boxesOf(near, volume), counts = boxesOf(mesh, volume);
      for (std::size_t i = 0; i < counts.size(); ++i)
        EXPECT_LT(counts[i], 2 * usual[i]) << far << ", " << i;
    };
    expectLittle(AABB<double>());
    expectLittle(KDOP<double, 16>());
    expectLittle(OBBRSS<double>());
  }
}

// Pairs that the kernel for eight pairs leaves unclear are decided before the solver.
TEST(FCL_DEFORMABLE_QUERY, filterDecidesJustAboveASlope) {
  // A tip 2^-50 above a slope: the volume, 2^-46, is a twentieth of what doubles may
  // lose.
  constexpr double kGap = 0x1p-50;
  MovingMesh tip, slope;
  tip.t0 = {{1, 1, 2 + kGap}, {0.5, 1, 9}, {1.5, 1, 9}};
  tip.t1 = {{1, 1, 2 + 2 * kGap}, {0.5, 1, 9}, {1.5, 1, 9}};
  slope.t0 = slope.t1 = {{0, 0, 0}, {4, 0, 4}, {0, 4, 4}};
  tip.triangles = slope.triangles = {Triangle(0, 1, 2)};
  const auto counts = [&slope](const MovingMesh& mesh) {
    const PreparedMovingMesh a(mesh), b(slope);
    return queryPair(a.instance(), b.instance(), QueryOptions()).counts;
  };
  const StageCounts above = counts(tip);
  EXPECT_GE(above.filter_culled, 1U);
  EXPECT_EQ(above.box_culled + above.filter_culled, above.feature_pairs);
  tip.t0[0][2] = 2;
  EXPECT_EQ(counts(tip).contacts, 1U);
}

TEST(FCL_DEFORMABLE_QUERY, pairAgainstBruteForce) {
  std::size_t contacts = 0;
  for (std::uint64_t seed = 2000; seed < 2000 + test::rounds(300U); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const MovingMesh a = smallSoup(random, 20, 0.3);
    const MovingMesh b =
        seed % 2 ? smallSoup(random, 20, 0.3) : test::crumpledSheet(random, 3, 0.3);
    Pose beginning, end;
    if (seed % 3 == 0)
      for (int k = 0; k < 3; ++k) {
        beginning.translation[k] = random.uniform(-0.2, 0.2);
        end.translation[k] = random.uniform(-0.2, 0.2);
      }
    const PreparedMovingMesh pa(a, beginning, end), pb(b);
    contacts +=
        expectRightAnswers({pa.instance(), a.triangles}, {pb.instance(), b.triangles});
    ASSERT_FALSE(HasFailure());
  }
  EXPECT_GT(contacts, test::rounds(1000U));
}

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
TEST(FCL_DEFORMABLE_QUERY, firstContactOfWhatRushesIn) {
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
TEST(FCL_DEFORMABLE_QUERY, firstContactOfALargeMesh) {
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
TEST(FCL_DEFORMABLE_QUERY, earliestOfManyContacts) {
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
TEST(FCL_DEFORMABLE_QUERY, timeAloneOfWhatMeetsAtOnePlace) {
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
TEST(FCL_DEFORMABLE_QUERY, firstContactsOfWhatMeetsAtOnePlace) {
  for (const double factor : {-0.3, -0.7, -1., -2., 0.}) {
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
TEST(FCL_DEFORMABLE_QUERY, firstContactInAnyOrder) {
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
        for (int order = 0; order < 6; ++order) {
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
TEST(FCL_DEFORMABLE_QUERY, timeAloneOfALargeMesh) {
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

template <typename S>
Transform3<S> pose(Random& random, const Matrix3<S>& rotation, double step) {
  Transform3<S> tf = Transform3<S>::Identity();
  tf.linear() = rotation;
  tf.translation() = random.point(step).template cast<S>();
  return tf;
}

/// Plain FCL models through PreparedMesh: rigid against rigid and against deforming, in
/// rotated poses, with a motion of the first.
template <typename BV>
void expectRightAnswersOfModels(std::uint64_t first_seed) {
  using S = typename BV::S;
  using Model = BVHModel<BV>;
  std::size_t contacts = 0;
  for (std::uint64_t seed = first_seed; seed < first_seed + 16; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const auto randomRotation = [&random](bool turned) -> Matrix3<S> {
      if (!turned) return Matrix3<S>::Identity();
      return AngleAxis<S>(static_cast<S>(random.uniform(0, 3)),
                          random.point(1).template cast<S>().normalized())
          .toRotationMatrix();
    };
    const MovingMesh mesh_a = smallSoup(random, 18, 0.2, false),
                     mesh_b = smallSoup(random, 18, 0.2, false);
    const auto a = test::makeModel<Model>({mesh_a.t0, mesh_a.triangles});
    const auto b = seed % 2 ? test::makeModel<Model>({mesh_b.t0, mesh_b.triangles})
                            : test::makeModel<Model>({mesh_b.t0, mesh_b.triangles},
                                                     {mesh_b.t1, mesh_b.triangles});
    EXPECT_EQ(meshKindOf<S>(*a), MeshKind::kRigid);
    EXPECT_EQ(meshKindOf<S>(*b), seed % 2 ? MeshKind::kRigid : MeshKind::kDeforming);
    const Matrix3<S> rotation_a = randomRotation(seed % 4 < 2),
                     rotation_b = randomRotation(seed % 8 < 4);
    const Transform3<S> a_beg = pose<S>(random, rotation_a, 0.3),
                        a_end = pose<S>(random, rotation_a, 0.5);
    const Transform3<S> b_beg = pose<S>(random, rotation_b, 0.3);
    const test::PlacedMesh pa(*a, a_beg, a_end, "a"), pb(*b, b_beg, b_beg, "b");
    // Nothing is computed for a rigid mesh.
    EXPECT_FALSE(pa.instance().hasOwners());
    EXPECT_EQ(pa.instance().tree, nullptr);
    for (std::size_t i = 0; i < mesh_a.t0.size(); ++i) {
      const Vector3<double> expected =
          a_end.template cast<double>() * mesh_a.t0[i].cast<S>().template cast<double>();
      for (int k = 0; k < 3; ++k)
        EXPECT_NEAR(pa.instance().frames[i].t1[k], expected[k], 1e-14);
    }
    const Body body_a{pa.instance(), mesh_a.triangles},
        body_b{pb.instance(), mesh_b.triangles};
    contacts += expectRightAnswers(body_a, body_b);
    contacts += expectRightAnswers(body_b, body_a);
    ASSERT_FALSE(testing::Test::HasFailure());
  }
  EXPECT_GT(contacts, 200U);
}

template <typename BV>
class FCL_DEFORMABLE_QUERY_MODELS : public testing::Test {};
using Volumes = testing::Types<AABB<double>, OBB<double>, RSS<double>, kIOS<double>,
                               OBBRSS<double>, KDOP<double, 16>, KDOP<double, 18>,
                               KDOP<double, 24>, OBBRSS<float>, KDOP<float, 16>>;
TYPED_TEST_SUITE(FCL_DEFORMABLE_QUERY_MODELS, Volumes, );

TYPED_TEST(FCL_DEFORMABLE_QUERY_MODELS, plainModelsAgainstBruteForce) {
  expectRightAnswersOfModels<TypeParam>(3000);
}

/// A rigid mesh of the given triangles, and two triangles that fall through it.
std::size_t expectRightAnswersOfRigidMesh(const std::vector<Triangle>& triangles) {
  const MovingMesh needles{{{1, 1, 1}, {1.5, 1, 2}, {1, 1.25, 2}, {1, -1, 5}, {1, 1, 5}},
                           {},
                           {{0, 1, 2}, {0, 3, 4}}};
  using Model = BVHModel<OBBRSS<double>>;
  const auto a =
      test::makeModel<Model>({{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {0, 0, 4}}, triangles});
  const auto b = test::makeModel<Model>({needles.t0, needles.triangles});
  const Transform3<double> begin = Transform3<double>::Identity();
  Transform3<double> end = begin;
  end.translation() = Vector3<double>(-2, 0, -2);
  const test::PlacedMesh pa(*a, begin, begin, "a"), pb(*b, begin, end, "b");
  return expectRightAnswers({pa.instance(), triangles},
                            {pb.instance(), needles.triangles});
}

// Lists of any length, some empty. Times at both ends, all equal, or in groups.
TEST(FCL_DEFORMABLE_QUERY, contactsOfAllTasksInOrder) {
  const auto keyOf = [](const FeatureContact& c) {
    return std::make_tuple(c.toc_lo, c.kind, !c.first_on_a,
                           Ids(c.vertices, c.vertices + 4), c.toc_hi);
  };
  constexpr std::uint64_t kSeed = 73;
  Random random(kSeed);
  for (int round = 0; round < 200; ++round) {
    std::vector<std::deque<FeatureContact>> lists(random.index(6));
    std::vector<decltype(keyOf(FeatureContact()))> expected;
    for (auto& list : lists) {
      list.resize(random.index(3) * random.index(40));
      for (FeatureContact& c : list) {
        c.kind = random.index(2) ? ContinuousContactKind::kVertexFace
                                 : ContinuousContactKind::kEdgeEdge;
        c.first_on_a = random.index(2) != 0;
        for (auto& v : c.vertices) v = static_cast<std::uint32_t>(random.index(4));
        const double crowd = random.uniform(0.5, 0.5 + 1e-6);
        const double times[] = {0, 1, 0.25, crowd, random.uniform(0, 1)};
        c.toc_lo = times[round % 3 ? random.index(5) : 2];
        c.toc_hi = c.toc_lo + 1e-4 * static_cast<double>(c.vertices[0]);
        expected.push_back(keyOf(c));
      }
    }
    std::sort(expected.begin(), expected.end());
    const SortedContacts sorted(std::move(lists));
    ASSERT_EQ(sorted.size(), expected.size());
    for (std::size_t i = 0; i < sorted.size(); ++i)
      ASSERT_EQ(keyOf(sorted[i]), expected[i]) << "seed " << kSeed << ", " << round;
  }
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
TEST(FCL_DEFORMABLE_QUERY, namesTheSameCrossingWhateverIsLeftOut) {
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
TEST(FCL_DEFORMABLE_QUERY, findsTheOnlyCrossingBehindAnEarlyContact) {
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

// A prepared mesh owns each feature once; a rigid one meets it repeatedly. In both there
// is one face for each set of ids.
TEST(FCL_DEFORMABLE_QUERY, rigidMeshWithDuplicateFaces) {
  EXPECT_GT(expectRightAnswersOfRigidMesh({{0, 1, 2}, {2, 1, 0}, {1, 2, 0}}), 0U);
}

// An "edge" from a vertex to itself is not an edge. The needle's edge meets vertex 3 at t
// = 0.5.
TEST(FCL_DEFORMABLE_QUERY, rigidMeshWithRepeatedIds) {
  EXPECT_GT(expectRightAnswersOfRigidMesh({{0, 1, 2}, {0, 0, 3}, {3, 3, 3}}), 0U);
}

}  // namespace
}  // namespace deformable
}  // namespace detail
}  // namespace fcl
