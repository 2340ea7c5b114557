// SPDX-License-Identifier: BSD-3-Clause
//
// Every VF and EE pair of a scene is met exactly once, for any mesh.
#include "mesh/feature_pairs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "mesh/mesh_topology.h"
#include "mesh_generators.h"
#include "owned_features.h"
#include "sanitizer.h"
#include "tree/moving_kdop_tree.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

using test::forEachFeaturePair;
using test::ownsEdge;
using test::ownsFace;
using test::ownsVertex;

using Ids = std::vector<std::uint32_t>;
/// Kind and side, sorted ids of the first and of the second feature.
struct PairName {
  int kind;  // 0: EE; 1: VF; 2: VF, the vertex is of the second mesh
  Ids first, second;
  bool operator<(const PairName& o) const {
    return std::tie(kind, first, second) < std::tie(o.kind, o.first, o.second);
  }
  bool operator==(const PairName& o) const { return !(*this < o) && !(o < *this); }
};
using Tally = std::map<PairName, int>;

Ids sorted(Ids ids) {
  std::sort(ids.begin(), ids.end());
  return ids;
}

struct Features {
  std::set<Ids> vertices, edges, faces;

  explicit Features(const std::vector<Triangle>& triangles) {
    for (const Triangle& t : triangles) {
      Ids v;
      for (int k = 0; k < 3; ++k) v.push_back(static_cast<std::uint32_t>(t[k]));
      for (std::size_t k = 0; k < 3; ++k) {
        vertices.insert({v[k]});
        if (v[k] != v[(k + 1) % 3]) edges.insert(sorted({v[k], v[(k + 1) % 3]}));
      }
      faces.insert(sorted(v));
    }
  }
};

bool doShare(const Ids& a, const Ids& b) {
  return std::any_of(a.begin(), a.end(), [&b](std::uint32_t id) {
    return std::find(b.begin(), b.end(), id) != b.end();
  });
}

/// All feature pairs once, by definition.
Tally expectedPairs(const Features& a, const Features& b, bool self) {
  Tally tally;
  const auto add = [&](int kind, const std::set<Ids>& xs, const std::set<Ids>& ys) {
    for (const Ids& x : xs)
      for (const Ids& y : ys) {
        if (self && doShare(x, y)) continue;
        if (self && kind == 0 && y < x) continue;
        tally[{kind, x, y}] = 1;
      }
  };
  add(0, a.edges, b.edges);
  add(1, a.vertices, b.faces);
  if (!self) add(2, b.vertices, a.faces);
  return tally;
}

PairName nameOf(const FeaturePair& pair, const MeshTriangle& a, const MeshTriangle& b,
                bool self) {
  if (pair.kind == ContinuousContactKind::kEdgeEdge) {
    Ids x = sorted({a.v[pair.first], a.v[(pair.first + 1) % 3]});
    Ids y = sorted({b.v[pair.second], b.v[(pair.second + 1) % 3]});
    if (self && y < x) std::swap(x, y);
    return {0, x, y};
  }
  const MeshTriangle& v = pair.first_on_a ? a : b;
  const MeshTriangle& f = pair.first_on_a ? b : a;
  return {pair.first_on_a || self ? 1 : 2,
          {v.v[pair.first]},
          sorted({f.v[0], f.v[1], f.v[2]})};
}

void expectSelfPairs(const std::vector<Triangle>& triangles, std::size_t num_vertices) {
  const auto mesh = assignFeatures(triangles.data(), triangles.size(), num_vertices);
  Tally met;
  for (std::size_t i = 0; i < mesh.size(); ++i)
    for (std::size_t j = i + 1; j < mesh.size(); ++j) {
      // The order of the two triangles must not matter.
      const MeshTriangle &a = mesh[(i + j) % 2 ? i : j], &b = mesh[(i + j) % 2 ? j : i];
      forEachFeaturePair<true>(
          a, b, [&](const FeaturePair& pair) { ++met[nameOf(pair, a, b, true)]; });
    }
  const Features features(triangles);
  EXPECT_TRUE(met == expectedPairs(features, features, true))
      << met.size() << " pairs met of " << expectedPairs(features, features, true).size();
}

void expectMeshPairs(const std::vector<Triangle>& triangles_a, std::size_t vertices_a,
                     const std::vector<Triangle>& triangles_b, std::size_t vertices_b) {
  const auto mesh_a = assignFeatures(triangles_a.data(), triangles_a.size(), vertices_a);
  const auto mesh_b = assignFeatures(triangles_b.data(), triangles_b.size(), vertices_b);
  Tally met;
  for (const MeshTriangle& a : mesh_a)
    for (const MeshTriangle& b : mesh_b)
      forEachFeaturePair<false>(
          a, b, [&](const FeaturePair& pair) { ++met[nameOf(pair, a, b, false)]; });
  EXPECT_TRUE(met == expectedPairs(Features(triangles_a), Features(triangles_b), false));
}

struct NamedMesh {
  const char* name;
  std::size_t num_vertices;
  std::vector<Triangle> triangles;
};

std::vector<NamedMesh> meshes() {
  return {
      {"one triangle", 3, {{0, 1, 2}}},
      {"two apart", 6, {{0, 1, 2}, {3, 4, 5}}},
      {"two on an edge", 4, {{0, 1, 2}, {2, 1, 3}}},
      {"two on an edge, wound alike", 4, {{0, 1, 2}, {1, 2, 3}}},
      {"two at a vertex", 5, {{0, 1, 2}, {2, 3, 4}}},
      {"three on an edge", 5, {{0, 1, 2}, {0, 1, 3}, {1, 0, 4}}},
      {"closed", 4, {{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}}},
      {"vertices without a triangle", 9, {{1, 3, 5}, {5, 3, 7}}},
      {"duplicates in other orders",
       7,
       {{0, 1, 2}, {2, 1, 0}, {1, 2, 0}, {4, 5, 6}, {4, 6, 5}, {0, 1, 4}}},
      {"repeated ids",
       6,
       {{0, 0, 1}, {1, 2, 2}, {3, 3, 3}, {3, 4, 5}, {1, 0, 1}, {4, 3, 4}}},
      {"components", 9, {{0, 1, 2}, {1, 2, 3}, {4, 5, 6}, {5, 6, 7}, {6, 7, 8}}},
      {"sheet", 16, test::makeSheet(3, 3).triangles},
      {"box", 8, test::makeBox({1, 1, 1}).triangles},
  };
}

TEST(FCL_FEATURE_PAIRS, selfPairsAreMetOnce) {
  for (const NamedMesh& mesh : meshes()) {
    SCOPED_TRACE(mesh.name);
    expectSelfPairs(mesh.triangles, mesh.num_vertices);
  }
}

TEST(FCL_FEATURE_PAIRS, pairsOfTwoMeshesAreMetOnce) {
  for (const NamedMesh& a : meshes())
    for (const NamedMesh& b : meshes()) {
      SCOPED_TRACE(std::string(a.name) + " and " + b.name);
      expectMeshPairs(a.triangles, a.num_vertices, b.triangles, b.num_vertices);
    }
}

std::vector<Triangle> randomTriangles(test::Random& random, std::size_t vertices) {
  std::vector<Triangle> triangles;
  for (std::size_t i = 1 + random.index(14); i-- > 0;) {
    const std::size_t a = random.index(vertices), b = random.index(vertices);
    triangles.emplace_back(a, b, random.index(vertices));
  }
  return triangles;
}

TEST(FCL_FEATURE_PAIRS, randomMeshes) {
  constexpr std::uint64_t kSeed = 31;
  test::Random random(kSeed);
  for (int i = 0; i < 500; ++i) {
    SCOPED_TRACE("seed " + std::to_string(kSeed) + ", mesh " + std::to_string(i));
    const std::size_t m = 3 + random.index(12), n = 3 + random.index(12);
    const auto a = randomTriangles(random, m), b = randomTriangles(random, n);
    expectSelfPairs(a, m);
    if (i % 4 == 0) expectMeshPairs(a, m, b, n);
    ASSERT_FALSE(HasFailure());
  }
}

TEST(FCL_FEATURE_PAIRS, ownedPairsByDefinition) {
  for (unsigned a = 0; a <= kOwnsAll; ++a)
    for (unsigned b = 0; b <= kOwnsAll; ++b) {
      const MeshTriangle ta{{0, 1, 2}, a}, tb{{3, 4, 5}, b};
      unsigned expected = 0;
      for (int bit = 0; bit < kNumFeaturePairs; ++bit) {
        const FeaturePair pair = featurePair(bit);
        const MeshTriangle &first = pair.first_on_a ? ta : tb,
                           &second = pair.first_on_a ? tb : ta;
        const bool owned = pair.kind == ContinuousContactKind::kEdgeEdge
                               ? ownsEdge(ta, pair.first) && ownsEdge(tb, pair.second)
                               : ownsVertex(first, pair.first) && ownsFace(second);
        expected |= unsigned{owned} << bit;
      }
      ASSERT_EQ(ownedPairs(a, b), expected) << a << ' ' << b;
      unsigned expected_edges = 0;
      for (unsigned k = 0; k < 3; ++k)
        expected_edges |= unsigned{ownsEdge(ta, k)} << k | unsigned{ownsEdge(tb, k)}
                                                               << (3 + k);
      ASSERT_EQ(ownedEdges(a, b), expected_edges) << a << ' ' << b;
    }
}

// The common features of two triangles with common vertices.
TEST(FCL_FEATURE_PAIRS, pairsAndEdgesAtSharedVertices) {
  for (unsigned shared = 0; shared < 1U << 9; ++shared) {
    const auto isShared = [shared](unsigned i, unsigned j) {
      return (shared >> (3 * i + j) & 1U) != 0;
    };
    unsigned pairs = 0, edges = 0;
    for (int bit = 0; bit < kNumFeaturePairs; ++bit) {
      // Two points to the left of a pair of edges, one to the left of a vertex and a
      // face.
      const unsigned char(&x)[4] = kFeaturePoints[bit];
      const int left = bit < kNumVertexFacePairs ? 1 : 2;
      for (int p = 0; p < left; ++p)
        for (int q = left; q < 4; ++q)
          if (isShared(std::min(x[p], x[q]), std::max(x[p], x[q]) - 3U))
            pairs |= 1U << bit;
    }
    for (unsigned k = 0; k < 3; ++k)
      for (unsigned end = k; end < k + 2; ++end)
        for (unsigned other = 0; other < 3; ++other)
          edges |= unsigned{isShared(end % 3, other)} << k |
                   unsigned{isShared(other, end % 3)} << (3 + k);
    ASSERT_EQ(pairsAt(shared), pairs) << shared;
    ASSERT_EQ(edgesAtBoth(shared), edges) << shared;
  }
}

TEST(FCL_FEATURE_PAIRS, pointsOfPairs) {
  for (int bit = 0; bit < kNumFeaturePairs; ++bit) {
    const FeaturePair pair = featurePair(bit);
    const unsigned mine = pair.first_on_a ? 0 : 3, other = 3 - mine;
    const unsigned i = pair.first, j = pair.second;
    const std::array<unsigned, 4> expected =
        pair.kind == ContinuousContactKind::kVertexFace
            ? std::array<unsigned, 4>{mine + i, other, other + 1, other + 2}
            : std::array<unsigned, 4>{i, (i + 1) % 3, 3 + j, 3 + (j + 1) % 3};
    for (std::size_t k = 0; k < 4; ++k)
      EXPECT_EQ(kFeaturePoints[bit][k], expected[k]) << bit;
  }
}

// Triangles in which all numbers but those of the vertices are equal, or none.
TEST(FCL_FEATURE_PAIRS, sharedVerticesByDefinition) {
  constexpr std::uint64_t kSeed = 4;
  test::Random random(kSeed);
  int sharing = 0;
  for (int n = 0; n < 20000; ++n) {
    TreeTriangle a{}, b{};
    a.index = static_cast<std::uint32_t>(random.index(8));
    b.index = random.index(2) ? a.index : static_cast<std::uint32_t>(random.index(8));
    unsigned expected = 0;
    const unsigned high = random.index(2) ? 0 : 29;
    for (std::uint32_t& id : a.id)
      id = static_cast<std::uint32_t>(random.index(8)) << high;
    for (std::uint32_t& id : b.id)
      id = static_cast<std::uint32_t>(random.index(8)) << high;
    for (unsigned i = 0; i < 3; ++i)
      for (unsigned j = 0; j < 3; ++j)
        expected |= unsigned{a.id[i] == b.id[j]} << (3 * i + j);
    ASSERT_EQ(sharedVertices(a.id, b.id), expected) << "seed " << kSeed << ", " << n;
    ASSERT_EQ(doShareVertex(idsOf(a), idsOf(b)), expected != 0) << n;
    sharing += expected != 0;
  }
  EXPECT_GT(sharing, 5000);
  EXPECT_LT(sharing, 18000);
}

TEST(FCL_FEATURE_PAIRS, theLowestTriangleOwns) {
  const std::vector<Triangle> triangles = {{0, 1, 2}, {2, 1, 3}, {1, 0, 2}};
  const auto mesh = assignFeatures(triangles.data(), triangles.size(), 4);
  EXPECT_EQ(mesh[0].owned, kOwnsAll);
  // The second triangle owns vertex 3, its two new edges and the face.
  EXPECT_FALSE(ownsVertex(mesh[1], 0) || ownsVertex(mesh[1], 1) || ownsEdge(mesh[1], 0));
  EXPECT_TRUE(ownsVertex(mesh[1], 2) && ownsEdge(mesh[1], 1) && ownsEdge(mesh[1], 2));
  EXPECT_TRUE(ownsFace(mesh[1]));
  EXPECT_EQ(mesh[2].owned, 0U);
}

/// The features of each triangle by definition: those that no previous triangle has.
std::vector<std::uint32_t> expectedOwned(const std::vector<Triangle>& triangles) {
  std::set<Ids> taken;
  std::vector<std::uint32_t> owned;
  for (const Triangle& t : triangles) {
    Ids v;
    for (int k = 0; k < 3; ++k) v.push_back(static_cast<std::uint32_t>(t[k]));
    std::uint32_t bits = 0;
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t next = v[(k + 1) % 3];
      bits |= std::uint32_t{taken.insert({v[k]}).second} << k;
      if (v[k] != next)
        bits |= std::uint32_t{taken.insert(sorted({v[k], next})).second} << (3 + k);
    }
    bits |= std::uint32_t{taken.insert(sorted(v)).second} << 6;
    owned.push_back(bits);
  }
  return owned;
}

void expectOwners(const std::vector<Triangle>& triangles, std::size_t num_vertices) {
  const auto mesh = assignFeatures(triangles.data(), triangles.size(), num_vertices);
  const std::vector<std::uint32_t> expected = expectedOwned(triangles);
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    ASSERT_EQ(mesh[i].owned, expected[i]) << "triangle " << i;
    for (std::size_t k = 0; k < 3; ++k)
      ASSERT_EQ(mesh[i].v[k], triangles[i][static_cast<int>(k)]);
  }
}

TEST(FCL_FEATURE_PAIRS, ownersByDefinition) {
  constexpr std::uint64_t kSeed = 32;
  test::Random random(kSeed);
  for (int i = 0; i < 300; ++i) {
    SCOPED_TRACE("seed " + std::to_string(kSeed) + ", mesh " + std::to_string(i));
    const std::size_t vertices = 1 + random.index(30);
    std::vector<Triangle> triangles;
    for (std::size_t k = 1 + random.index(200); k-- > 0;) {
      const std::size_t a = random.index(vertices), b = random.index(vertices);
      triangles.emplace_back(a, b, random.index(vertices));
    }
    ASSERT_NO_FATAL_FAILURE(expectOwners(triangles, vertices));
  }
}

// All triangles around one vertex or one edge, and one face repeatedly.
TEST(FCL_FEATURE_PAIRS, ownersOfCrowdedFeatures) {
  constexpr std::size_t kCount = test::rounds(std::size_t{50000});
  std::vector<Triangle> wheel, book, same;
  for (std::size_t i = 2; i < kCount; ++i) {
    wheel.emplace_back(0, i - 1, i);
    book.emplace_back(i % 2, 1 - i % 2, i);
    same.emplace_back(2, i % 2, 1 - i % 2);
  }
  expectOwners(wheel, kCount);
  expectOwners(book, kCount);
  expectOwners(same, 3);
  // The vertex with most triangles is last.
  for (Triangle& t : wheel)
    t.set(kCount - 1 - t[0], kCount - 1 - t[1], kCount - 1 - t[2]);
  expectOwners(wheel, kCount);
}

TEST(FCL_FEATURE_PAIRS, findsWhatIsOutOfRange) {
  const std::vector<Triangle> triangles = {{0, 1, 2}, {3, 2, 1}, {0, 4, 3}};
  EXPECT_EQ(findOutOfRange(triangles.data(), triangles.size(), 5), 9U);
  EXPECT_EQ(findOutOfRange(triangles.data(), triangles.size(), 4), 7U);
  EXPECT_EQ(findOutOfRange(triangles.data(), triangles.size(), 3), 3U);
  EXPECT_EQ(findOutOfRange(triangles.data(), 1, 3), 3U);
}

TEST(FCL_FEATURE_PAIRS, findsWhatIsTooMany) {
  EXPECT_EQ(kMaxMeshSize, 536870912U);
  EXPECT_EQ(findTooMany(kMaxMeshSize, kMaxMeshSize), "");
  EXPECT_EQ(findTooMany(0, 0), "");
  EXPECT_EQ(
      findTooMany(kMaxMeshSize + 1, kMaxMeshSize + 2),
      "536870913 triangles are more than 536870912, the most that a model can have");
  EXPECT_EQ(findTooMany(1, kMaxMeshSize + 1),
            "536870913 vertices are more than 536870912, the most that a model can have");
  // The features that are numbered up to here.
  EXPECT_LE(4 * (kMaxMeshSize - 1) + 2, std::numeric_limits<std::uint32_t>::max());
  EXPECT_LE(6 * kMaxMeshSize, std::numeric_limits<std::uint32_t>::max());
}

}  // namespace
}  // namespace deformable
}  // namespace detail
}  // namespace fcl
