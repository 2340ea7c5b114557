// SPDX-License-Identifier: BSD-3-Clause
//
// Parts of regions, fans and bodies that are proved to stay apart by a distance, against
// all pairs of features tested one by one.
#include "self_culling/regions_apart.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "elementary/distance_advance.h"
#include "moving_mesh.h"
#include "sanitizer.h"
#include "self_culling/embedded_bodies.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

using test::MovingMesh;
using test::PreparedMovingMesh;
using test::Random;
using Kind = ContinuousContactKind;
/// Vertices of a feature, ascending.
using Ids = std::vector<std::size_t>;

constexpr std::uint32_t kNone = MovingKdopNode::kNoPlace;
/// Regions of so many triangles are looked for, so that small meshes have several.
constexpr std::uint32_t kLeast = 16;

/// What is left out of a query of a mesh with itself, by the user's numbers.
class LeftOut {
 public:
  LeftOut(const MovingMesh& mesh, double distance)
      : mesh_(mesh), prepared_(mesh), region_(mesh.triangles.size(), kNone) {
    const MovingKdopTree& tree = prepared_.tree();
    EmbeddedRegions regions = findEmbeddedBodies(tree, kernels(), 1, distance);
    bodies_ = static_cast<std::size_t>(
        std::count(regions.nodes.begin(), regions.nodes.end(), 1));
    addEmbeddedRegions(tree, kernels(), 1, regions, kLeast);
    const RegionsApart apart = findRegionsApart(tree, regions, kernels(), distance);
    for (const Kernels* k : allKernels()) {
      const RegionsApart other = findRegionsApart(tree, regions, *k, distance);
      EXPECT_EQ(other.nodes, apart.nodes) << k->name;
      EXPECT_EQ(other.fans, apart.fans) << k->name;
    }
    std::vector<std::uint32_t> region_of = apart.nodes;
    for (std::size_t i = 0; i < tree.numNodes(); ++i) {
      const MovingKdopNode& node = tree.node(static_cast<int>(i));
      for (int lane = 0; lane < node.count; ++lane) {
        if (node.isTriangle(lane)) {
          const auto place = static_cast<std::size_t>(node.triangle(lane));
          region_[tree.triangles()[place].index] = region_of[i];
        } else if (isBody(regions, region_of[i])) {
          // Of a body only the root has the region.
          region_of[static_cast<std::size_t>(node.child[lane])] = region_of[i];
        }
      }
    }
    fans_.assign(mesh.t0.size(), 0);
    for (const TreeTriangle& t : tree.triangles())
      for (int k = 0; k < 3; ++k) fans_[t.id[k]] = apart.fans[t.place[k]];
  }

  std::size_t bodies() const { return bodies_; }
  std::size_t fans() const {
    return static_cast<std::size_t>(std::count(fans_.begin(), fans_.end(), 1));
  }
  std::size_t triangles() const {
    return region_.size() -
           static_cast<std::size_t>(std::count(region_.begin(), region_.end(), kNone));
  }

  bool operator()(std::size_t i, std::size_t j) const {
    if (region_[i] != kNone && region_[i] == region_[j]) return true;
    for (int k = 0; k < 3; ++k)
      for (int l = 0; l < 3; ++l)
        if (mesh_.id(i, k) == mesh_.id(j, l) && fans_[mesh_.id(i, k)]) return true;
    return false;
  }

 private:
  static bool isBody(const EmbeddedRegions& regions, std::uint32_t node) {
    return node != kNone && regions.directions[node] == EmbeddedRegions::kNoDirection;
  }

  const MovingMesh& mesh_;
  PreparedMovingMesh prepared_;
  std::size_t bodies_{0};
  std::vector<std::uint32_t> region_;
  std::vector<std::uint8_t> fans_;
};

/// Whether two features without a common vertex come within the distance.
bool comesWithin(const MovingMesh& mesh, Kind kind, const Ids& first, const Ids& second,
                 double distance) {
  VertexPath x[4];
  std::size_t i = 0;
  for (const Ids* ids : {&first, &second})
    for (const std::size_t v : *ids) {
      for (int k = 0; k < 3; ++k) {
        x[i].t0[k] = mesh.t0[v][k];
        x[i].t1[k] = mesh.t1[v][k];
      }
      ++i;
    }
  DistanceRequest request;
  request.distance = distance;
  return advanceToDistance(kind, {{&x[0], &x[1], &x[2], &x[3]}}, request).is_contact;
}

/// The features of a mesh, and the triangles that have them.
class Holders {
 public:
  explicit Holders(const MovingMesh& mesh) {
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
      for (int k = 0; k < 3; ++k) {
        Ids edge{mesh.id(i, k), mesh.id(i, (k + 1) % 3)};
        std::sort(edge.begin(), edge.end());
        edges[edge].push_back(i);
        vertices[{mesh.id(i, k)}].push_back(i);
      }
  }
  std::map<Ids, std::vector<std::size_t>> vertices, edges;
};

bool haveCommon(const Ids& a, const Ids& b) {
  return std::find_first_of(a.begin(), a.end(), b.begin(), b.end()) != a.end();
}

/// No pair that is left out comes within the distance. Returns the number of pairs of
/// features that do.
std::size_t expectApart(const MovingMesh& mesh, const LeftOut& left_out,
                        double distance) {
  const Holders holders(mesh);
  std::size_t near = 0;
  const auto expect = [&](Kind kind, const Ids& a, const std::vector<std::size_t>& of_a,
                          const Ids& b, const std::vector<std::size_t>& of_b) {
    if (haveCommon(a, b) || !comesWithin(mesh, kind, a, b, distance)) return;
    ++near;
    for (const std::size_t i : of_a)
      for (const std::size_t j : of_b) EXPECT_FALSE(i != j && left_out(i, j));
  };
  for (const auto& [v, of_v] : holders.vertices)
    for (std::size_t j = 0; j < mesh.triangles.size(); ++j)
      expect(Kind::kVertexFace, v, of_v, {mesh.id(j, 0), mesh.id(j, 1), mesh.id(j, 2)},
             {j});
  for (auto a = holders.edges.begin(); a != holders.edges.end(); ++a)
    for (auto b = std::next(a); b != holders.edges.end(); ++b)
      expect(Kind::kEdgeEdge, a->first, a->second, b->first, b->second);
  return near;
}

struct Tally {
  std::size_t near{0}, triangles{0}, fans{0}, bodies{0}, all{0};

  void add(const MovingMesh& mesh, double distance) {
    const LeftOut left_out(mesh, distance);
    near += expectApart(mesh, left_out, distance);
    triangles += left_out.triangles();
    fans += left_out.fans();
    bodies += left_out.bodies();
    all += mesh.triangles.size();
  }
};

/// A strip that nearly closes to a ring, with teeth along its borders. Its ends are `gap`
/// apart.
test::TestMesh makeOpenRing(double gap, double teeth, double slope) {
  const double kPi = std::acos(-1.0);
  return test::makeSheet(20, 4, [=](double u, double v) {
    const double angle = (2 * kPi - gap) * u,
                 radius = 1 + 0.5 * v + teeth * std::sin(40 * u) * (v - 0.5);
    return Vector3<double>(radius * std::cos(angle), radius * std::sin(angle),
                           slope * std::sin(angle));
  });
}

/// Sanitizer runs have an eighth of the rounds, too few to count what they contain.
const int kRounds = test::rounds(24);
const bool kCounts = kRounds == 24;

// The ends of a ring come near each other through the gap between them. Only the proof
// about borders sees that.
TEST(FCL_REGIONS_APART, bordersThatComeNear) {
  constexpr std::uint64_t kSeed = 391;
  Random random(kSeed);
  Tally tally;
  for (int i = 0; i < kRounds; ++i) {
    SCOPED_TRACE("seed " + std::to_string(kSeed) + ", " + std::to_string(i));
    const double teeth = i % 3 ? 0 : random.uniform(0, 0.4),
                 slope = random.uniform(0, 0.3);
    const test::TestMesh from = makeOpenRing(random.uniform(0.05, 0.3), teeth, slope),
                         to = makeOpenRing(random.uniform(0.02, 0.2), teeth, slope);
    const MovingMesh mesh{from.vertices, to.vertices, from.triangles};
    for (const double distance : {0.01, 0.05, 0.1}) tally.add(mesh, distance);
    ASSERT_FALSE(HasFailure());
  }
  if (!kCounts) return;
  EXPECT_GT(tally.near, 500U);
  EXPECT_GT(3 * tally.triangles, tally.all);
  EXPECT_GT(tally.fans, 200U);
}

// Holes of one triangle whose right angle comes near the opposite side. The three other
// triangles around it are higher.
TEST(FCL_REGIONS_APART, lowHoles) {
  constexpr std::uint64_t kSeed = 394;
  constexpr int kSide = 12;
  Random random(kSeed);
  Tally tally;
  for (int i = 0; i < kRounds; ++i) {
    SCOPED_TRACE("seed " + std::to_string(kSeed) + ", " + std::to_string(i));
    MovingMesh mesh = still(test::makeSheet(kSide, kSide));
    const std::size_t hole = random.index(mesh.triangles.size());
    const auto corner = [&](int k) { return mesh.t0[mesh.id(hole, k % 3)]; };
    int right = 0;
    while ((corner(right + 1) - corner(right)).dot(corner(right + 2) - corner(right)) >
           1e-9)
      ++right;
    const Vector3<double> middle = 0.5 * (corner(right + 1) + corner(right + 2)),
                          away = corner(right) - middle;
    for (auto* frame : {&mesh.t0, &mesh.t1})
      (*frame)[mesh.id(hole, right)] = middle + random.uniform(0.02, 0.3) * away;
    mesh.triangles.erase(mesh.triangles.begin() + static_cast<std::ptrdiff_t>(hole));
    for (const double share : {0.02, 0.05, 0.1}) tally.add(mesh, share / kSide);
    ASSERT_FALSE(HasFailure());
  }
  if (!kCounts) return;
  EXPECT_GT(tally.near, 20U);
  EXPECT_GT(2 * tally.triangles, tally.all);
}

// Holes of single triangles and slits, in sheets that are sheared and squeezed.
TEST(FCL_REGIONS_APART, sheetsWithHoles) {
  constexpr std::uint64_t kSeed = 392;
  Random random(kSeed);
  Tally tally;
  for (int i = 0; i < kRounds; ++i) {
    SCOPED_TRACE("seed " + std::to_string(kSeed) + ", " + std::to_string(i));
    const auto sheet = [&](double squeeze, double shear, double wave) {
      return test::makeSheet(11, 11, [=](double u, double v) {
        return Vector3<double>(squeeze * u + shear * v, v,
                               wave * std::sin(5 * u) * std::cos(4 * v));
      });
    };
    const test::TestMesh from = sheet(1, random.uniform(-0.5, 0.5), 0.02),
                         to = sheet(random.uniform(0.3, 1), random.uniform(-1, 1),
                                    random.uniform(0, 0.05));
    MovingMesh mesh{from.vertices, to.vertices, from.triangles};
    const std::size_t holes = random.index(12);
    for (std::size_t k = 0; k < holes; ++k)
      mesh.triangles.erase(
          mesh.triangles.begin() +
          static_cast<std::ptrdiff_t>(random.index(mesh.triangles.size())));
    for (const double share : {0.02, 0.2, 0.5, 0.8}) tally.add(mesh, share / 11);
    ASSERT_FALSE(HasFailure());
  }
  if (!kCounts) return;
  EXPECT_GT(tally.near, 1000U);
  EXPECT_GT(4 * tally.triangles, tally.all);
  EXPECT_GT(tally.fans, 200U);
}

// Balls with bumps, thin ones, and some that come near themselves.
TEST(FCL_REGIONS_APART, bodies) {
  constexpr std::uint64_t kSeed = 393;
  Random random(kSeed);
  Tally tally;
  for (int i = 0; i < kRounds; ++i) {
    SCOPED_TRACE("seed " + std::to_string(kSeed) + ", " + std::to_string(i));
    MovingMesh mesh =
        still(i % 2 ? test::makeUvSphere(10, 8, 1) : test::makeIcosphere(2, 1));
    const Vector3<double> wave = random.point(4);
    const double bumps = random.uniform(0, 0.6), flat = random.uniform(0.05, 1);
    for (auto& p : mesh.t0) {
      p *= 1 + bumps * std::sin(wave.dot(p));
      p[2] *= flat;
    }
    const AngleAxis<double> turn(random.uniform(0, 0.8), random.point(1).normalized());
    const Vector3<double> away = random.point(2);
    for (std::size_t k = 0; k < mesh.t0.size(); ++k)
      mesh.t1[k] = turn * (random.uniform(0.9, 1) * mesh.t0[k]) + away;
    for (const double distance : {0.002, 0.02, 0.1, 0.3}) tally.add(mesh, distance);
    ASSERT_FALSE(HasFailure());
  }
  if (!kCounts) return;
  EXPECT_GT(tally.near, 1000U);
  EXPECT_GT(tally.bodies, 15U);
  EXPECT_LT(tally.bodies, 80U);
}

// There are more pairs of near edges of the border than are looked at.
TEST(FCL_REGIONS_APART, nothingIsApartAtTheSizeOfTheMesh) {
  const MovingMesh sheet = still(test::makeSheet(40, 40));
  EXPECT_GT(LeftOut(sheet, 1e-3).triangles(), 1000U);
  EXPECT_EQ(LeftOut(sheet, 3).triangles(), 0U);
}

// Round bodies are apart by nearly the least height of their triangles.
TEST(FCL_REGIONS_APART, roundBodiesAreApartByTheirHeights) {
  for (const test::TestMesh& mesh :
       {test::makeIcosphere(3, 1), test::makeUvSphere(12, 9, 2)}) {
    const MovingMesh ball = still(mesh);
    double height = HUGE_VAL;
    for (std::size_t i = 0; i < ball.triangles.size(); ++i)
      for (int k = 0; k < 3; ++k) {
        const Vector3<double> side =
            ball.t0[ball.id(i, (k + 1) % 3)] - ball.t0[ball.id(i, k)];
        const Vector3<double> other =
            ball.t0[ball.id(i, (k + 2) % 3)] - ball.t0[ball.id(i, k)];
        height = std::min(height, side.cross(other).norm() / side.norm());
      }
    EXPECT_EQ(LeftOut(ball, 0.9 * height).bodies(), 1U);
    EXPECT_EQ(LeftOut(ball, 1.01 * height).bodies(), 0U);
  }
}

}  // namespace
}  // namespace deformable
}  // namespace detail
}  // namespace fcl
