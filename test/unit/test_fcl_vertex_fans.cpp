// SPDX-License-Identifier: BSD-3-Clause
//
// Which vertices have a fan. Pairs in an embedded fan are culled, and this never changes
// the answer of a query.
#include "mesh/vertex_fans.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "elementary/elementary.h"
#include "elementary/exact.h"
#include "elementary/predicates.h"
#include "moving_mesh.h"
#include "query/deformable_query.h"
#include "self_culling/embedded_fans.h"
#include "traverse.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

using test::MovingMesh;
using test::PreparedMovingMesh;
using test::Random;

using Face = std::array<std::uint32_t, 3>;

std::vector<TreeTriangle> treeTriangles(const std::vector<Face>& faces) {
  std::vector<TreeTriangle> out;
  for (const Face& f : faces) {
    TreeTriangle t{};
    std::copy(f.begin(), f.end(), t.place);
    out.push_back(t);
  }
  return out;
}

struct Fan {
  std::vector<std::uint32_t> spokes;
  bool is_closed;
};

Fan fanOf(const std::vector<Face>& faces, std::uint32_t place, std::size_t vertices) {
  const VertexFans fans(treeTriangles(faces), vertices);
  EXPECT_EQ(fans.size(), vertices);
  const VertexFan fan = fans[place];
  return {{fan.spokes, fan.spokes + fan.count}, fan.is_closed};
}

/// Spokes 1 ... count around vertex 0.
std::vector<Face> wheel(std::uint32_t count, bool closed) {
  std::vector<Face> faces;
  for (std::uint32_t i = 1; i < count; ++i) faces.push_back({0, i, i + 1});
  if (closed) faces.push_back({0, count, 1});
  return faces;
}

/// Changes the order of corners and of triangles, which does not change a mesh.
void mix(std::vector<Face>& faces, Random& random) {
  for (std::size_t i = faces.size(); i > 1; --i)
    std::swap(faces[i - 1], faces[random.index(i)]);
  for (Face& f : faces)
    std::rotate(f.begin(), f.begin() + static_cast<int>(random.index(3)), f.end());
}

// Short and long fans.
TEST(FCL_VERTEX_FANS, openAndClosed) {
  Random random(91);
  std::vector<std::uint32_t> counts;
  for (std::uint32_t count = 2; count <= 2 * VertexFans::kShort; ++count)
    counts.push_back(count);
  counts.insert(counts.end(), {100, 255, 256, 257, 1000});
  for (const std::uint32_t count : counts)
    for (const bool closed : {false, true}) {
      if (closed && count < 3) continue;
      SCOPED_TRACE(std::to_string(count) + (closed ? " closed" : " open"));
      for (int i = 0; i < 10; ++i) {
        std::vector<Face> faces = wheel(count, closed);
        mix(faces, random);
        Fan fan = fanOf(faces, 0, count + 1);
        EXPECT_EQ(fan.is_closed, closed);
        ASSERT_EQ(fan.spokes.size(), count);
        // A closed fan may begin at any spoke.
        if (closed)
          std::rotate(fan.spokes.begin(),
                      std::find(fan.spokes.begin(), fan.spokes.end(), 1U),
                      fan.spokes.end());
        for (std::uint32_t k = 0; k < count; ++k) EXPECT_EQ(fan.spokes[k], k + 1);
      }
    }
}

TEST(FCL_VERTEX_FANS, theOtherWayRound) {
  std::vector<Face> faces = wheel(5, true);
  for (Face& f : faces) std::swap(f[1], f[2]);
  const Fan fan = fanOf(faces, 0, 6);
  EXPECT_TRUE(fan.is_closed);
  EXPECT_EQ(fan.spokes.size(), 5U);
}

TEST(FCL_VERTEX_FANS, vertexWithoutTriangles) {
  EXPECT_TRUE(fanOf({{1, 2, 3}}, 0, 4).spokes.empty());
  EXPECT_EQ(VertexFans().size(), 0U);
  EXPECT_EQ(VertexFans(treeTriangles({}), 0).size(), 0U);
}

TEST(FCL_VERTEX_FANS, oneTriangle) {
  const Fan fan = fanOf({{2, 0, 1}}, 0, 3);
  EXPECT_FALSE(fan.is_closed);
  EXPECT_EQ(fan.spokes, (std::vector<std::uint32_t>{1, 2}));
}

// Triangles that are not a fan, in every order.
TEST(FCL_VERTEX_FANS, noFan) {
  struct Case {
    const char* name;
    std::vector<Face> faces;
  };
  const std::vector<Face> closed = wheel(4, true);
  const auto with = [](std::vector<Face> faces, const std::vector<Face>& more) {
    faces.insert(faces.end(), more.begin(), more.end());
    return faces;
  };
  const Case kCases[] = {
      {"two open sheets", {{0, 1, 2}, {0, 3, 4}}},
      {"two longer open sheets", {{0, 1, 2}, {0, 2, 3}, {0, 4, 5}, {0, 5, 6}}},
      {"two closed sheets", with(closed, {{0, 5, 6}, {0, 6, 7}, {0, 7, 5}})},
      {"a closed and an open sheet", with(closed, {{0, 5, 6}})},
      {"three triangles on an edge", {{0, 1, 2}, {0, 2, 3}, {0, 2, 4}}},
      {"three triangles on an edge of a closed fan", with(closed, {{0, 1, 5}})},
      {"a closed fan that a triangle ends in", with(closed, {{0, 5, 1}})},
      {"an opposite winding", {{0, 1, 2}, {0, 3, 2}}},
      {"an opposite winding in a closed fan", {{0, 1, 2}, {0, 2, 3}, {0, 1, 3}}},
      {"a face twice", {{0, 1, 2}, {0, 1, 2}}},
      {"a face twice in a closed fan", with(closed, {{0, 1, 2}})},
      {"a face and its back", {{0, 1, 2}, {0, 2, 1}}},
      {"a repeated vertex", {{0, 0, 1}, {0, 1, 2}}},
  };
  // Each alone, and with a wheel that makes the fan long.
  Random random(92);
  for (const Case& c : kCases) {
    SCOPED_TRACE(c.name);
    for (int i = 0; i < 30; ++i) {
      std::vector<Face> faces = c.faces;
      if (i % 2) {
        faces = wheel(20, i % 4 == 1);
        for (Face f : c.faces) {
          for (std::uint32_t& v : f) v += v == 0 ? 0 : 20;
          faces.push_back(f);
        }
      }
      mix(faces, random);
      EXPECT_TRUE(fanOf(faces, 0, 30).spokes.empty());
    }
  }
  // Long fans that are spoiled by only one triangle.
  for (const Face& last : {Face{0, 1, 20}, Face{0, 5, 6}, Face{0, 6, 5}, Face{0, 5, 7},
                           Face{0, 7, 5}, Face{0, 0, 21}, Face{0, 21, 22}})
    for (const bool closed : {false, true}) {
      SCOPED_TRACE(std::to_string(last[1]) + " " + std::to_string(last[2]));
      std::vector<Face> faces = with(wheel(20, closed), {last});
      mix(faces, random);
      EXPECT_TRUE(fanOf(faces, 0, 23).spokes.empty());
    }
}

// The other vertices of a wheel have fans of their own. A vertex without a fan does not
// disturb its neighbours.
TEST(FCL_VERTEX_FANS, neighbours) {
  std::vector<Face> faces = wheel(6, true);
  faces.push_back({0, 7, 8});
  const VertexFans fans(treeTriangles(faces), 9);
  EXPECT_EQ(fans[0].count, 0U);
  for (std::uint32_t i = 1; i <= 6; ++i) {
    EXPECT_EQ(fans[i].count, 3U) << i;
    EXPECT_FALSE(fans[i].is_closed);
    EXPECT_EQ(fans[i].spokes[1], 0U);
  }
  EXPECT_EQ(fans[7].count, 2U);
}

using Ids = std::vector<std::uint32_t>;
using Name = std::tuple<ContinuousContactKind, Ids, Ids>;

Ids sorted(Ids ids) {
  std::sort(ids.begin(), ids.end());
  return ids;
}

bool doShare(const Ids& x, const Ids& y) {
  return std::any_of(x.begin(), x.end(), [&y](std::uint32_t id) {
    return std::find(y.begin(), y.end(), id) != y.end();
  });
}

struct Truth {
  std::set<Name> contacts;
  bool has_crossing{false};
};

/// Every two features that share no vertex, by the exact tests.
Truth bruteForce(const MovingMesh& mesh, const MeshInstance& instance) {
  std::set<Ids> features[4];  // by the number of vertices
  for (const Triangle& t : mesh.triangles) {
    Ids v;
    for (int k = 0; k < 3; ++k) v.push_back(static_cast<std::uint32_t>(t[k]));
    for (std::size_t k = 0; k < 3; ++k) {
      features[1].insert({v[k]});
      features[2].insert(sorted({v[k], v[(k + 1) % 3]}));
    }
    features[3].insert(sorted(v));
  }
  Truth truth;
  const auto test = [&](ContinuousContactKind kind, const Ids& x, const Ids& y) {
    std::vector<VertexPath> p;
    for (const Ids* ids : {&x, &y})
      for (const std::uint32_t id : *ids) p.push_back(instance.frames[id]);
    if (decideExactly(kind, {{&p[0], &p[1], &p[2], &p[3]}}, 1e-3).answer == Answer::kYes)
      truth.contacts.insert({kind, x, y});
  };
  for (const Ids& x : features[1])
    for (const Ids& y : features[3])
      if (!doShare(x, y)) test(ContinuousContactKind::kVertexFace, x, y);
  for (const Ids& x : features[2])
    for (const Ids& y : features[2])
      if (x < y && !doShare(x, y)) test(ContinuousContactKind::kEdgeEdge, x, y);
  for (const Ids& x : features[2])
    for (const Ids& y : features[3]) {
      if (doShare(x, y)) continue;
      const VertexPath p[5] = {instance.frames[x[0]], instance.frames[x[1]],
                               instance.frames[y[0]], instance.frames[y[1]],
                               instance.frames[y[2]]};
      truth.has_crossing |= isCrossing(p[0].t0, p[1].t0, p[2].t0, p[3].t0, p[4].t0);
    }
  return truth;
}

Name nameOf(const FeatureContact& c) {
  const std::uint32_t* v = c.vertices;
  if (c.kind == ContinuousContactKind::kVertexFace)
    return {c.kind, {v[0]}, sorted({v[1], v[2], v[3]})};
  Ids x = sorted({v[0], v[1]}), y = sorted({v[2], v[3]});
  if (y < x) std::swap(x, y);
  return {c.kind, x, y};
}

/// The motions of a mesh.
enum class Motion { kNone, kSmall, kLarge, kFold, kFlatten, kToGrid };
constexpr std::size_t kMotions = 6;

void move(MovingMesh& mesh, Motion motion, Random& random) {
  const Vector3<double> normal = random.point(1).normalized();
  const double depth = random.uniform(-0.3, 0.3), back = random.uniform(1.5, 2.5);
  mesh.t1.clear();
  for (const auto& p : mesh.t0) {
    const double above = normal.dot(p) - depth;
    switch (motion) {
      case Motion::kNone:
        mesh.t1.push_back(p);
        break;
      case Motion::kSmall:
        mesh.t1.push_back(p + random.point(0.05));
        break;
      case Motion::kLarge:
        mesh.t1.push_back(p + random.point(1));
        break;
      case Motion::kFold:  // what is above a plane goes below it, more or less mirrored
        mesh.t1.push_back(above > 0 ? p - back * above * normal : p);
        break;
      case Motion::kFlatten:  // nearly or exactly flat
        mesh.t1.push_back(p - (random.index(2) ? 1 : 1 - 1e-12) * above * normal);
        break;
      case Motion::kToGrid: {
        Vector3<double> q;
        for (int k = 0; k < 3; ++k) q[k] = std::round(2 * p[k]) / 2;
        mesh.t1.push_back(q);
      }
    }
  }
}

/// A cone of `count` triangles that goes `turns` times around its axis.
MovingMesh cone(Random& random, std::size_t count, double turns, bool closed,
                double height, double noise) {
  MovingMesh mesh;
  mesh.t0.push_back(random.point(noise));
  for (std::size_t i = 0; i < count; ++i) {
    const double angle =
        6.283185307179586 * turns * static_cast<double>(i) / static_cast<double>(count);
    const double r = random.uniform(0.5, 1);
    mesh.t0.push_back(
        Vector3<double>(r * std::cos(angle), r * std::sin(angle), -height * r) +
        random.point(noise));
  }
  for (std::size_t i = 1; i < count; ++i) mesh.triangles.emplace_back(0, i, i + 1);
  if (closed) mesh.triangles.emplace_back(0, count, 1);
  return mesh;
}

/// Adds the first frame of a mesh.
void append(MovingMesh& mesh, const MovingMesh& other, const Vector3<double>& at) {
  const std::size_t first = mesh.t0.size();
  for (const auto& p : other.t0) mesh.t0.push_back(p + at);
  for (const Triangle& t : other.triangles)
    mesh.triangles.emplace_back(first + t[0], first + t[1], first + t[2]);
}

MovingMesh solid(const test::TestMesh& mesh) {
  MovingMesh out;
  out.t0 = mesh.vertices;
  out.triangles = mesh.triangles;
  return out;
}

MovingMesh randomMesh(Random& random) {
  switch (random.index(6)) {
    case 0:
      return solid(test::makeIcosphere(random.index(3) == 0, 1));
    case 1:
      return solid(test::makeUvSphere(3 + static_cast<int>(random.index(3)),
                                      2 + static_cast<int>(random.index(2)), 1));
    case 2:
      return solid(test::makeBox(Vector3<double>(1, 0.5, 0.25), 1));
    case 3: {
      MovingMesh sheet = solid(test::makeSheet(3, 2));
      for (auto& p : sheet.t0) p += random.point(0.05);
      return sheet;
    }
    default:
      break;
  }
  // Steep cones, flat ones, and cones that go around less or more than once.
  const double kTurns[] = {1, 1, 1, 2, 0.3, 0.9, 1.1, 1.5};
  const double turns = kTurns[random.index(8)];
  const bool closed = turns == 1 || turns == 2;
  const double kHeights[] = {0, 1e-9, 0.3, 3, -0.5};
  const double kNoise[] = {0, 1e-12, 0.01, 0.1};
  return cone(random, 4 + random.index(8), turns, closed, kHeights[random.index(5)],
              kNoise[random.index(4)]);
}

/// Expects that the contacts of a mesh with itself are those of all pairs of features.
struct CullingCheck {
  std::uint64_t culled{0}, contacts{0};
  int crossing{0}, culled_by[kMotions] = {};

  void check(const MovingMesh& mesh, Motion motion) {
    const PreparedMovingMesh prepared(mesh);
    const Truth truth = bruteForce(mesh, prepared.instance());
    const QueryAnswer answer = querySelf(prepared.instance(), QueryOptions());
    std::set<Name> found;
    for (const FeatureContact& c : answer.contacts)
      EXPECT_TRUE(found.insert(nameOf(c)).second) << "reported twice";
    EXPECT_EQ(found, truth.contacts);
    EXPECT_EQ(answer.hasCrossing(), truth.has_crossing);
    EXPECT_EQ(answer.counts.contacts, truth.contacts.size());
    culled += answer.counts.fan_culled;
    culled_by[static_cast<std::size_t>(motion)] += answer.counts.fan_culled > 0;
    contacts += truth.contacts.size();
    crossing += truth.has_crossing;
  }
};

// Closed and open meshes that move a little or a lot, fold, become flat and cross, and
// the same in reversed time.
TEST(FCL_VERTEX_FANS, cullingChangesNoAnswer) {
  constexpr std::uint64_t kSeed = 93;
  Random random(kSeed);
  CullingCheck all;
  for (int i = 0; i < 360; ++i) {
    const auto motion = static_cast<Motion>(i % int{kMotions});
    SCOPED_TRACE("seed " + std::to_string(kSeed) + ", " + std::to_string(i));
    MovingMesh mesh = randomMesh(random);
    move(mesh, motion, random);
    for (const bool reversed : {false, true}) {
      if (reversed) std::swap(mesh.t0, mesh.t1);
      all.check(mesh, motion);
      ASSERT_FALSE(HasFailure());
    }
  }
  EXPECT_GT(all.culled, 2000U);
  EXPECT_GT(all.contacts, 2000U);
  EXPECT_GT(all.crossing, 20);
  for (const int n : all.culled_by) EXPECT_GT(n, 5);
}

/// The number of nodes that lie in a fan. All triangles of such a node have the fan's
/// vertex.
std::size_t countNodesInFans(const MovingKdopTree& tree,
                             const std::vector<std::uint8_t>& embedded) {
  const std::vector<std::uint32_t> centers = findNodesInFans(tree, embedded);
  if (centers.empty()) return 0;
  EXPECT_EQ(centers.size(), tree.numNodes());
  std::size_t count = 0;
  const auto last = static_cast<std::uint32_t>(tree.triangles().size());
  for (std::size_t i = 0; i < centers.size(); ++i) {
    const std::uint32_t center = centers[i];
    if (center == MovingKdopNode::kNoPlace) continue;
    ++count;
    EXPECT_TRUE(embedded[center]);
    std::vector<int> open{static_cast<int>(i)};
    while (!open.empty()) {
      const MovingKdopNode& node = tree.node(open.back());
      open.pop_back();
      for (int lane = 0; lane < node.count; ++lane) {
        if (!node.isTriangle(lane)) {
          open.push_back(node.child[lane]);
          continue;
        }
        const auto t = static_cast<std::size_t>(node.triangle(lane));
        EXPECT_LT(t, last);
        const std::uint32_t(&v)[3] = tree.triangles()[t].place;
        EXPECT_TRUE(std::find(v, v + 3, center) != v + 3);
      }
    }
  }
  return count;
}

// Fans that fill whole nodes, which are left out as a whole.
TEST(FCL_VERTEX_FANS, longFansChangeNoAnswer) {
  constexpr std::uint64_t kSeed = 96;
  Random random(kSeed);
  CullingCheck all;
  std::size_t nodes_in_fans = 0;
  for (int i = 0; i < 12; ++i) {
    SCOPED_TRACE("seed " + std::to_string(kSeed) + ", " + std::to_string(i));
    const auto motion = static_cast<Motion>(i % int{kMotions});
    const bool closed = i % 4 != 3;
    MovingMesh mesh =
        cone(random, 64 + random.index(16), closed ? 1 : 0.9, closed, 0.3, 0);
    const std::size_t first = mesh.t0.size();
    // Two fans, of which one goes through the other.
    const bool are_two = i % 3 == 0;
    if (are_two) append(mesh, cone(random, 64, 1, true, 0.3, 0), random.point(0.3));
    move(mesh, i % 2 || are_two ? Motion::kNone : motion, random);
    const Vector3<double> way = random.point(0.5);
    for (std::size_t v = first; v < mesh.t1.size(); ++v) mesh.t1[v] += way;
    all.check(mesh, motion);
    ASSERT_FALSE(HasFailure());
    const PreparedMovingMesh prepared(mesh);
    nodes_in_fans +=
        countNodesInFans(prepared.tree(), test::embeddedFans(prepared.tree()));
  }
  EXPECT_GT(nodes_in_fans, 30U);
  EXPECT_GT(all.contacts, 200U);
}

// A pole of a thousand triangles. The boxes of all of them overlap, but hardly any pair
// is met.
TEST(FCL_VERTEX_FANS, polesAreNotMetTwoByTwo) {
  MovingMesh mesh = solid(test::makeUvSphere(1000, 4, 1));
  mesh.t1 = mesh.t0;
  const PreparedMovingMesh prepared(mesh);
  const MovingKdopTree& tree = prepared.tree();
  EXPECT_GT(countNodesInFans(tree, test::embeddedFans(tree)), 100U);
  QueryOptions options;
  options.leaves_out_regions = false;
  const QueryAnswer answer = querySelf(prepared.instance(), options);
  EXPECT_TRUE(answer.contacts.empty());
  // Two poles have a million pairs.
  EXPECT_LT(answer.counts.fan_culled, 100000U);
}

/// Whether the fan of a vertex is embedded, tested alone.
bool isEmbedded(const MovingKdopTree& tree, std::size_t vertex) {
  const VertexFan fan = tree.fans()[vertex];
  if (fan.count == 0) return false;
  EightFans eight;
  std::fill(eight.center, eight.center + 8, &tree.vertices()[vertex]);
  std::fill(eight.spokes, eight.spokes + 8, fan.spokes);
  eight.count = fan.count;
  eight.is_closed = fan.is_closed;
  return kernels().areFansEmbedded(tree.vertices().data(), eight, 0) & 1U;
}

// Fans of all kinds, tested eight at a time in blocks of vertices, have the same answers
// as each alone.
TEST(FCL_VERTEX_FANS, fansTogetherAreAsAlone) {
  constexpr std::uint64_t kSeed = 95;
  Random random(kSeed);
  std::set<std::pair<std::uint32_t, bool>> kinds;
  std::size_t embedded = 0, folded = 0;
  for (int i = 0; i < 12; ++i) {
    SCOPED_TRACE("seed " + std::to_string(kSeed) + ", " + std::to_string(i));
    // A mesh with holes has fans of all lengths. It has more vertices than a block.
    const int n = i % 2 ? 80 : 3;
    MovingMesh mesh = test::crumpledSheet(random, n, 0.5 / n);
    // And long fans, of which some with the same form follow each other.
    for (int k = 0; k < 30; ++k) {
      const std::size_t first = mesh.t0.size();
      append(mesh,
             cone(random, 17 + random.index(2), 1, true, 0.3, random.uniform(0, 0.1)),
             Vector3<double>(3 * k, 0, 0));
      for (std::size_t v = first; v < mesh.t0.size(); ++v)
        mesh.t1.push_back(mesh.t0[v] + random.point(0.05));
    }
    mesh.triangles.erase(
        std::remove_if(mesh.triangles.begin() + 1, mesh.triangles.end(),
                       [&](const Triangle&) { return random.index(8) == 0; }),
        mesh.triangles.end());
    const PreparedMovingMesh prepared(mesh);
    const MovingKdopTree& tree = prepared.tree();
    const std::size_t count = tree.vertices().size();
    std::vector<std::uint8_t> left_out(count, 0), expected(count);
    for (std::size_t v = 0; v < count; ++v) {
      left_out[v] = i % 4 > 1 && random.index(3) == 0;
      expected[v] = !left_out[v] && isEmbedded(tree, v);
      ++(expected[v] ? embedded : folded);
      kinds.insert({tree.fans()[v].count, tree.fans()[v].is_closed});
    }
    for (const int num_threads : {1, 2})
      EXPECT_EQ(findEmbeddedFans(tree, left_out, kernels(), num_threads), expected);
  }
  EXPECT_GT(kinds.size(), 11U);
  EXPECT_GT(embedded, 1000U);
  EXPECT_GT(folded, 1000U);
}

// The traversal leaves out exactly the pairs that share a vertex whose fan is marked as
// embedded, whichever are marked.
TEST(FCL_VERTEX_FANS, traversalLeavesOutFansOnly) {
  constexpr std::uint64_t kSeed = 94;
  Random random(kSeed);
  using Pairs = std::set<std::pair<int, int>>;
  std::size_t left_out = 0;
  for (int i = 0; i < 30; ++i) {
    SCOPED_TRACE("seed " + std::to_string(kSeed) + ", " + std::to_string(i));
    const MovingMesh mesh = i % 2 ? test::crumpledSheet(random, 6, 0.1)
                                  : test::randomSoup(random, 60, 25, 1, 0.2);
    const PreparedMovingMesh prepared(mesh);
    const MovingKdopTree& tree = prepared.tree();
    std::vector<std::uint8_t> embedded(tree.vertices().size());
    for (auto& e : embedded) e = random.index(3) == 0;
    Pairs all, some, expected;
    const auto into = [](Pairs& pairs) {
      return [&pairs](int a, int b, float) {
        EXPECT_TRUE(pairs.insert({std::min(a, b), std::max(a, b)}).second);
      };
    };
    test::traverse<true>(tree, tree, nullptr, into(all));
    test::traverse<true>(tree, tree, nullptr, into(some), 1, {embedded.data()});
    for (const auto& [a, b] : all) {
      const TreeTriangle &x = tree.triangles()[static_cast<std::size_t>(a)],
                         &y = tree.triangles()[static_cast<std::size_t>(b)];
      bool in_fan = false;
      for (const std::uint32_t p : x.place)
        for (const std::uint32_t q : y.place) in_fan |= p == q && embedded[p];
      if (!in_fan) expected.insert({a, b});
    }
    EXPECT_EQ(some, expected);
    left_out += all.size() - some.size();
  }
  EXPECT_GT(left_out, 1000U);
}

}  // namespace
}  // namespace deformable
}  // namespace detail
}  // namespace fcl
