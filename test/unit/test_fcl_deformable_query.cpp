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

#include "elementary/exact.h"
#include "elementary/predicates.h"
#include "fcl/math/bv/OBBRSS.h"
#include "fcl/math/bv/kDOP.h"
#include "fcl/math/bv/kIOS.h"
#include "moving_mesh.h"
#include "named_contacts.h"
#include "placed_mesh.h"
#include "prepare/prepared_mesh.h"
#include "sanitizer.h"
#include "test_models.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

using test::Body;
using test::Ids;
using test::MovingMesh;
using test::nameOf;
using test::PairName;
using test::PreparedMovingMesh;
using test::query;
using test::Random;
using test::sorted;
using test::TestMesh;

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
  constexpr int kSide = test::kHasAddressSanitizer ? 20 : 40;
  MovingMesh a = test::crumpledSheet(random, kSide, 0.02);
  MovingMesh b = test::crumpledSheet(random, kSide, 0.02);
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
