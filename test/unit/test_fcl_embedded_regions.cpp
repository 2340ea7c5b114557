// SPDX-License-Identifier: BSD-3-Clause
//
// An embedded region has no contact with itself, whatever the mesh is. Regions of smooth
// surfaces are proved. Queries give the same answers with regions and without.
#include "self_culling/embedded_regions.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "brute_force.h"
#include "elementary/predicates.h"
#include "generated_scenes.h"
#include "mesh/feature_pairs.h"
#include "moving_mesh.h"
#include "query/deformable_query.h"
#include "regions_of.h"
#include "sanitizer.h"
#include "traverse.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

using test::MovingMesh;
using test::PreparedMovingMesh;
using test::Random;

const double kPi = std::acos(-1.0);

EmbeddedRegions regionsOf(const MovingKdopTree& tree, std::uint32_t least = 1) {
  return test::regionsOf(tree, kernels(), 1, least);
}

/// The triangles below a node, by their places in the tree.
std::vector<std::size_t> trianglesBelow(const MovingKdopTree& tree, int node) {
  std::vector<std::size_t> found;
  std::vector<int> open{node};
  while (!open.empty()) {
    const MovingKdopNode& n = tree.node(open.back());
    open.pop_back();
    for (int lane = 0; lane < n.count; ++lane)
      if (n.isTriangle(lane))
        found.push_back(static_cast<std::size_t>(n.triangle(lane)));
      else
        open.push_back(n.child[lane]);
  }
  return found;
}

struct Found {
  /// The triangles of each region, by the user's ids.
  std::vector<std::vector<std::size_t>> regions;
  std::size_t interior{0};

  bool isWhole(const MovingMesh& mesh) const {
    return regions.size() == 1 && regions[0].size() == mesh.triangles.size();
  }
};

/// The regions of a mesh. Expects that they are consistent: no region lies in another
/// one. A vertex is inside of a region if all of its triangles are in it and form a
/// closed fan.
Found find(const MovingMesh& mesh) {
  const PreparedMovingMesh prepared(mesh);
  const MovingKdopTree& tree = prepared.tree();
  const EmbeddedRegions regions = regionsOf(tree);
  EXPECT_EQ(regions.nodes.size(), tree.numNodes());
  EXPECT_EQ(regions.interior.size(), tree.vertices().size());
  Found found;
  std::vector<int> region_of(tree.triangles().size(), -1);
  for (std::size_t i = 0; i < regions.nodes.size(); ++i) {
    if (!regions.nodes[i]) continue;
    std::vector<std::size_t> triangles;
    for (const std::size_t t : trianglesBelow(tree, static_cast<int>(i))) {
      EXPECT_EQ(region_of[t], -1) << "a region in another";
      region_of[t] = static_cast<int>(i);
      triangles.push_back(tree.triangles()[t].index);
    }
    found.regions.push_back(triangles);
  }
  std::vector<std::set<int>> regions_at(tree.vertices().size());
  for (std::size_t t = 0; t < region_of.size(); ++t)
    for (const std::uint32_t p : tree.triangles()[t].place)
      regions_at[p].insert(region_of[t]);
  for (std::size_t p = 0; p < regions_at.size(); ++p) {
    const bool inside = tree.fans()[p].is_closed && regions_at[p].size() == 1 &&
                        *regions_at[p].begin() >= 0;
    EXPECT_EQ(regions.interior[p] != 0, inside);
    found.interior += regions.interior[p];
  }
  return found;
}

test::FramePairMesh part(const MovingMesh& mesh,
                         const std::vector<std::size_t>& triangles) {
  test::FramePairMesh out{mesh.t0, mesh.t1, {}};
  for (const std::size_t i : triangles) out.triangles.push_back(mesh.triangles[i]);
  return out;
}

/// Whether an edge passes through a face without a common vertex at t = 0.
bool hasCrossing(const test::FramePairMesh& mesh) {
  struct Point {
    double x[3];
  };
  std::vector<Point> at;
  for (const auto& p : mesh.previous) at.push_back({{p[0], p[1], p[2]}});
  for (const auto& edge : test::uniqueEdges(mesh.triangles))
    for (const Triangle& t : mesh.triangles) {
      const auto a = static_cast<std::size_t>(edge[0]),
                 b = static_cast<std::size_t>(edge[1]);
      bool shares = false;
      for (int k = 0; k < 3; ++k) shares = shares || t[k] == a || t[k] == b;
      if (!shares && isCrossing(at[a].x, at[b].x, at[t[0]].x, at[t[1]].x, at[t[2]].x))
        return true;
    }
  return false;
}

/// No two features of a region touch, nor does it cross itself at t = 0.
void expectNoContact(const MovingMesh& mesh, const Found& found) {
  for (const auto& region : found.regions) {
    const test::FramePairMesh triangles = part(mesh, region);
    EXPECT_TRUE(test::bruteForceSelfContacts(triangles).empty())
        << "a region of " << region.size() << " triangles touches itself";
    EXPECT_FALSE(hasCrossing(triangles));
  }
}

/// A flat strip around the z axis that climbs by `rise` a turn, and whose radius grows by
/// `growth` a turn.
test::TestMesh spiral(int nx, double turns, double rise, double growth = 0) {
  return test::makeSheet(nx, 2, [=](double u, double v) {
    const double angle = 2 * kPi * turns * u, r = 1.5 - 0.5 * v + growth * turns * u;
    return Vector3<double>(r * std::cos(angle), r * std::sin(angle), rise * turns * u);
  });
}

test::TestMesh annulus(int nx, int ny) {
  return test::makeTube(nx, ny, [](double u, double v) {
    const double r = 1.5 - v;
    return Vector3<double>(r * std::cos(2 * kPi * u), r * std::sin(2 * kPi * u), 0);
  });
}

/// A sheet of side `size` in the plane z = height around the z axis.
test::TestMesh square(int n, double size, double height) {
  return test::makeSheet(n, n, [=](double u, double v) {
    return Vector3<double>(size * (u - 0.5), size * (v - 0.5), height);
  });
}

/// The mesh rotated and moved away.
MovingMesh turned(MovingMesh mesh, Random& random) {
  const AngleAxis<double> turn(random.uniform(0, 2 * kPi), random.point(1).normalized());
  const Vector3<double> away = random.point(3);
  for (auto* frame : {&mesh.t0, &mesh.t1})
    for (auto& p : *frame) p = turn * p + away;
  return mesh;
}

// Layers that are nearer to each other than the vertices of one layer.
TEST(FCL_EMBEDDED_REGIONS, layersAreProvedOneByOne) {
  constexpr std::uint64_t kSeed = 100;
  Random random(kSeed);
  MovingMesh mesh = still(square(30, 1, 0));
  for (const double height : {0.001, 0.002}) append(mesh, still(square(30, 1, height)));
  mesh = turned(mesh, random);
  const Found found = find(mesh);
  EXPECT_EQ(found.regions.size(), 3U);
  for (const auto& region : found.regions) EXPECT_EQ(region.size(), 2U * 30 * 30);
}

// A surface in every direction, flat or waving, from a few triangles on.
TEST(FCL_EMBEDDED_REGIONS, smoothSheetsAreProvedWhole) {
  constexpr std::uint64_t kSeed = 101;
  Random random(kSeed);
  for (int i = 0; i < 200; ++i) {
    SCOPED_TRACE("seed " + std::to_string(kSeed) + ", " + std::to_string(i));
    const int n = 1 + static_cast<int>(random.index(30));
    MovingMesh mesh = still(test::makeSheet(n, 1 + static_cast<int>(random.index(30))));
    const double height = i % 2 ? random.uniform(0, 0.05) : 0;
    for (auto& p : mesh.t0) p[2] = height * std::sin(5 * p[0] + 3 * p[1]);
    for (auto& p : mesh.t1) p[2] = height * std::sin(5 * p[0] + 3 * p[1] + 1);
    mesh = turned(mesh, random);
    EXPECT_TRUE(find(mesh).isWhole(mesh));
    ASSERT_FALSE(HasFailure());
  }
}

TEST(FCL_EMBEDDED_REGIONS, turningAndStretching) {
  MovingMesh mesh = still(test::makeSheet(12, 12));
  for (auto& p : mesh.t1)
    p = AngleAxis<double>(0.4, Vector3<double>(1, 2, 3).normalized()) *
            (2 * p + Vector3<double>(0, 0, 1)) +
        Vector3<double>(5, 0, 0);
  EXPECT_TRUE(find(mesh).isWhole(mesh));
}

// The teeth of a comb that turns: each stays on its side of a line that turns as well.
TEST(FCL_EMBEDDED_REGIONS, turningComb) {
  for (const double angle : {0., 0.05, 0.4, -0.4}) {
    MovingMesh mesh;
    for (int i = 0; i < 20; ++i) {
      const double x = 0.02 * i;
      for (const auto& p : {Vector3<double>(x, 0, 0), Vector3<double>(x + 0.015, 0, 0),
                            Vector3<double>(x + 0.01, 1, 0)})
        mesh.t0.push_back(p);
      mesh.triangles.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
    }
    for (const auto& p : mesh.t0)
      mesh.t1.push_back(AngleAxis<double>(angle, Vector3<double>::UnitZ()) * p);
    EXPECT_TRUE(find(mesh).isWhole(mesh)) << angle;
    // A tooth that leans over touches the next one.
    mesh.t1[32] += 0.04 * (mesh.t1[31] - mesh.t1[30]).normalized();
    const Found found = find(mesh);
    EXPECT_FALSE(found.isWhole(mesh)) << angle;
    expectNoContact(mesh, found);
  }
}

// Everything above a plane of two triangles is one region with it, until the mesh is
// divided.
TEST(FCL_EMBEDDED_REGIONS, aSheetOverAPlane) {
  MovingMesh mesh = still(square(60, 1, 0));
  append(mesh, still(square(1, 20, -0.5)));
  const PreparedMovingMesh prepared(mesh);
  const EmbeddedRegions found = regionsOf(prepared.tree(), kLeastRegion);
  const auto inside = std::count(found.interior.begin(), found.interior.end(), 1);
  EXPECT_GT(inside, 60 * 60 / 2);
}

// Each of the two layers of a folded sheet is proved.
TEST(FCL_EMBEDDED_REGIONS, aFoldHasTwoSides) {
  constexpr double kRadius = 0.2;
  const MovingMesh mesh = still(test::makeSheet(120, 40, [](double u, double v) {
    const double s = 2 * u - 1, bend = kPi / 2 * kRadius;
    const double angle = std::min(std::max(s / kRadius, -kPi / 2), kPi / 2);
    return Vector3<double>(kRadius * std::cos(angle) - std::max(std::abs(s) - bend, 0.),
                           v, kRadius * std::sin(angle));
  }));
  const Found found = find(mesh);
  EXPECT_FALSE(found.isWhole(mesh));
  std::size_t covered = 0;
  for (const auto& region : found.regions)
    if (region.size() >= 100) covered += region.size();
  EXPECT_GT(covered, mesh.triangles.size() * 3 / 4);
  EXPECT_GT(found.interior, mesh.t0.size() / 2);
  expectNoContact(mesh, found);
}

// A border of two loops, and two parts.
TEST(FCL_EMBEDDED_REGIONS, severalLoops) {
  Random random(102);
  MovingMesh ring = still(annulus(24, 3));
  EXPECT_TRUE(find(ring).isWhole(ring));
  ring = turned(ring, random);
  EXPECT_TRUE(find(ring).isWhole(ring));
  MovingMesh inside = still(annulus(24, 3));
  append(inside, still(square(4, 0.5, 0)));
  EXPECT_TRUE(find(inside).isWhole(inside));
  // Sheets that have a vertex in common: the border passes it twice.
  MovingMesh pinched = still(test::makeSheet(4, 4));
  append(pinched, still(test::makeSheet(4, 4, [](double u, double v) {
           return Vector3<double>(1 + u, 1 + v, 0);
         })));
  for (Triangle& t : pinched.triangles)
    t.set(t[0] == 25 ? 24 : t[0], t[1] == 25 ? 24 : t[1], t[2] == 25 ? 24 : t[2]);
  EXPECT_TRUE(find(pinched).isWhole(pinched));
  pinched = turned(pinched, random);
  EXPECT_TRUE(find(pinched).isWhole(pinched));
}

// Regions that overlap themselves in the plane, with borders that meet there or do not.
TEST(FCL_EMBEDDED_REGIONS, whatOverlapsIsNot) {
  for (const double height : {0.5, 0.01, 0., -0.3}) {
    SCOPED_TRACE(height);
    MovingMesh nested = still(square(8, 2, 0));
    append(nested, still(square(3, 0.71, height)));
    Found found = find(nested);
    EXPECT_FALSE(found.isWhole(nested));
    expectNoContact(nested, found);
    MovingMesh over_ring = still(annulus(24, 3));
    append(over_ring, still(square(6, 4.03, height)));
    found = find(over_ring);
    EXPECT_FALSE(found.isWhole(over_ring));
    expectNoContact(over_ring, found);
  }
  for (const double rise : {0.3, 0.01, 0.}) {
    SCOPED_TRACE(rise);
    for (const double growth : {0., 0.2}) {
      const MovingMesh mesh = still(spiral(60, 1.7, rise, growth));
      const Found found = find(mesh);
      EXPECT_FALSE(found.isWhole(mesh));
      expectNoContact(mesh, found);
    }
    // The strip goes less than once around, or its turns are apart.
    MovingMesh mesh = still(spiral(60, 0.9, rise));
    EXPECT_TRUE(find(mesh).isWhole(mesh));
    mesh = still(spiral(90, 1.7, rise, 0.7));
    EXPECT_TRUE(find(mesh).isWhole(mesh));
  }
}

// Borders that meet at some time only, between the frames.
TEST(FCL_EMBEDDED_REGIONS, whatMeetsInBetweenIsNot) {
  // Two sheets side by side that change places.
  MovingMesh mesh = still(square(3, 1, 0));
  MovingMesh other = still(square(3, 1, 0));
  for (auto& p : other.t0) p[0] += 1.3;
  for (auto& p : other.t1) p[0] -= 1.3;
  append(mesh, other);
  Found found = find(mesh);
  EXPECT_FALSE(found.isWhole(mesh));
  expectNoContact(mesh, found);
  // A spiral that is opened by more than one turn.
  mesh = still(spiral(60, 0.9, 0));
  mesh.t1 = spiral(60, 1.1, 0).vertices;
  found = find(mesh);
  EXPECT_FALSE(found.isWhole(mesh));
  expectNoContact(mesh, found);
}

// A hole of one triangle has a border of edges that all share vertices. It stays, or one
// of its corners passes through the opposite edge.
TEST(FCL_EMBEDDED_REGIONS, holesOfOneTriangle) {
  Random random(109);
  int contacts = 0;
  for (int i = 0; i < 100; ++i) {
    MovingMesh mesh = still(square(6, 2, 0));
    const std::size_t k = random.index(mesh.triangles.size());
    const Triangle hole = mesh.triangles[k];
    mesh.triangles.erase(mesh.triangles.begin() + static_cast<std::ptrdiff_t>(k));
    const bool closes = i % 2;
    const auto corner = static_cast<int>(random.index(3));
    const Vector3<double>& a = mesh.t0[hole[corner]];
    const Vector3<double> middle =
        0.5 * (mesh.t0[hole[(corner + 1) % 3]] + mesh.t0[hole[(corner + 2) % 3]]);
    mesh.t1[hole[corner]] = a + (closes ? 1.2 : 0.5) * (middle - a);
    const bool touches =
        !test::bruteForceSelfContacts({mesh.t0, mesh.t1, mesh.triangles}).empty();
    EXPECT_TRUE(closes || !touches);
    contacts += touches;
    mesh = turned(mesh, random);
    const bool whole = find(mesh).isWhole(mesh);
    EXPECT_TRUE(closes || whole);
    EXPECT_FALSE(touches && whole);
  }
  EXPECT_GT(contacts, 20);
}

TEST(FCL_EMBEDDED_REGIONS, whatTouchesIsNot) {
  // A seam of vertices that exist twice.
  MovingMesh seam = still(square(4, 1, 0));
  MovingMesh other = still(square(4, 1, 0));
  for (auto* frame : {&other.t0, &other.t1})
    for (auto& p : *frame) p[0] += 1;
  append(seam, other);
  Found found = find(seam);
  EXPECT_FALSE(found.isWhole(seam));
  expectNoContact(seam, found);
  // The same vertices at a small distance, or rotated, so that the seam is not exact.
  Random random(103);
  for (int i = 0; i < 20; ++i)
    expectNoContact(turned(seam, random), find(turned(seam, random)));
  for (std::size_t i = 25; i < 50; ++i) {
    seam.t0[i][0] += 1e-6;
    seam.t1[i][0] += 1e-6;
  }
  EXPECT_TRUE(find(seam).isWhole(seam));
  // A face twice, a face and its back, an edge of three triangles.
  for (const Triangle& more : {Triangle(0, 1, 5), Triangle(0, 5, 1), Triangle(0, 1, 7)}) {
    MovingMesh mesh = still(square(4, 1, 0));
    mesh.triangles.push_back(more);
    found = find(mesh);
    EXPECT_FALSE(found.isWhole(mesh));
    expectNoContact(mesh, found);
  }
}

// One triangle without an area, or one that is turned over at some time.
TEST(FCL_EMBEDDED_REGIONS, everyTriangleCounts) {
  Random random(104);
  for (int i = 0; i < 300; ++i) {
    MovingMesh mesh = still(square(5, 1, 0));
    const std::size_t k = random.index(mesh.triangles.size());
    Triangle& t = mesh.triangles[k];
    switch (i % 3) {
      case 0:
        t.set(t[0], t[2], t[1]);
        break;
      case 1:
        t.set(t[0], t[1], t[1]);
        break;
      default: {
        // A corner goes to the opposite edge, which turns some triangle over or flat.
        auto& frame = random.index(2) ? mesh.t0 : mesh.t1;
        frame[t[0]] = 0.5 * (frame[t[1]] + frame[t[2]]);
      }
    }
    const Found found = find(mesh);
    EXPECT_FALSE(found.isWhole(mesh)) << i;
    for (const auto& region : found.regions)
      EXPECT_EQ(std::count(region.begin(), region.end(), k), 0) << i;
  }
}

TEST(FCL_EMBEDDED_REGIONS, whatIsNotFiniteIsNot) {
  Random random(105);
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(),
                           std::numeric_limits<double>::infinity(), 1e300, -1e300}) {
    for (int i = 0; i < 50; ++i) {
      MovingMesh mesh = turned(still(square(5, 1, 0)), random);
      const std::size_t v = random.index(mesh.t0.size());
      (random.index(2) ? mesh.t0 : mesh.t1)[v][static_cast<int>(random.index(3))] = bad;
      for (const auto& region : find(mesh).regions)
        for (const std::size_t t : region)
          for (int k = 0; k < 3; ++k) EXPECT_NE(mesh.triangles[t][k], v);
    }
    MovingMesh mesh = still(square(5, 1, 0));
    for (auto& p : mesh.t0) p *= bad;
    mesh.t1 = mesh.t0;
    EXPECT_TRUE(find(mesh).regions.empty());
  }
}

// From sizes at which products underflow to sizes at which they overflow.
TEST(FCL_EMBEDDED_REGIONS, allSizes) {
  for (int exponent = -1070; exponent <= 1020; exponent += 10) {
    MovingMesh mesh = still(square(4, 1, 0));
    append(mesh, still(square(2, 0.5, 0)));
    MovingMesh plain = still(square(4, 1, 0));
    for (MovingMesh* m : {&mesh, &plain}) {
      for (auto& p : m->t0)
        for (int k = 0; k < 3; ++k) p[k] = std::ldexp(p[k], exponent);
      m->t1 = m->t0;
    }
    EXPECT_FALSE(find(mesh).isWhole(mesh)) << exponent;
    if (std::abs(exponent) < 100) {
      EXPECT_TRUE(find(plain).isWhole(plain)) << exponent;
    }
  }
}

MovingMesh randomSheet(Random& random) {
  switch (random.index(6)) {
    case 0:
      return still(spiral(20 + static_cast<int>(random.index(12)),
                          random.uniform(0.5, 2.2), random.uniform(0, 0.3),
                          random.uniform(-0.1, 0.6)));
    case 1: {
      MovingMesh mesh = still(annulus(8 + static_cast<int>(random.index(8)), 2));
      append(mesh, still(square(3, random.uniform(0.4, 3.5), random.uniform(-0.1, 0.1))));
      return mesh;
    }
    case 2: {
      MovingMesh mesh = still(square(4, 1, 0));
      append(mesh, still(square(3, random.uniform(0.2, 1.5), random.uniform(-0.1, 0.1))));
      return mesh;
    }
    case 3:
      return test::crumpledSheet(random, 6, 0.02);
    default:
      return still(square(6, 2, 0));
  }
}

/// Removes, turns over, adds and doubles triangles, and splits vertices.
void spoil(MovingMesh& mesh, Random& random) {
  auto& triangles = mesh.triangles;
  for (std::size_t times = random.index(5); times-- > 0;) {
    const std::size_t i = random.index(triangles.size());
    Triangle& t = triangles[i];
    switch (random.index(6)) {
      case 0:
        t.set(t[0], t[2], t[1]);
        break;
      case 1: {
        const std::size_t v = random.index(mesh.t0.size());
        triangles.emplace_back(t[0], t[1], v);
        break;
      }
      case 2:
        triangles.push_back(Triangle(t));
        break;
      case 3:
        mesh.t0.push_back(mesh.t0[t[0]]);
        mesh.t1.push_back(mesh.t1[t[0]]);
        t.set(mesh.t0.size() - 1, t[1], t[2]);
        break;
      default: {
        // A hole, sometimes a large one.
        const std::size_t count = 1 + random.index(random.index(2) ? 2 : 12);
        for (std::size_t k = 0; k < count && triangles.size() > 2; ++k)
          triangles.erase(triangles.begin() +
                          static_cast<std::ptrdiff_t>(random.index(triangles.size())));
      }
    }
  }
}

void moveAtRandom(MovingMesh& mesh, Random& random) {
  const double kNoise[] = {0, 0, 0.01, 0.1, 0.6};
  const double noise = kNoise[random.index(5)];
  const Vector3<double> normal = random.point(1).normalized();
  const double back = random.uniform(0, 2.5), depth = random.uniform(-1, 1),
               flat = random.uniform(0, 2), wave = random.uniform(0, 0.4);
  const std::size_t kind = random.index(5);
  for (auto& p : mesh.t0) p[2] += wave * std::sin(3 * p[0]) * std::cos(2 * p[1]);
  for (std::size_t i = 0; i < mesh.t0.size(); ++i) {
    Vector3<double>&p = mesh.t1[i], &start = mesh.t0[i];
    p = start;
    if (kind == 1) p -= back * std::max(normal.dot(p) - depth, 0.) * normal;  // folds
    if (kind == 2) p[2] *= 1 - flat;  // layers change places
    if (kind == 3) p[0] *= 1 - flat;  // turns over
    if (kind == 4) p = AngleAxis<double>(flat * (1 + p[0]), normal) * p;  // is twisted
    p += random.point(noise);
  }
}

// Regions of all sizes, in meshes with all kinds of defects and motions, against all
// feature pairs.
TEST(FCL_EMBEDDED_REGIONS, haveNoContact) {
  constexpr std::uint64_t kSeed = 106;
  Random random(kSeed);
  std::size_t large = 0, whole = 0, with_contacts = 0;
  for (int i = 0; i < test::manyRounds(3000); ++i) {
    SCOPED_TRACE("seed " + std::to_string(kSeed) + ", " + std::to_string(i));
    MovingMesh mesh = randomSheet(random);
    spoil(mesh, random);
    moveAtRandom(mesh, random);
    if (random.index(2)) mesh = turned(mesh, random);
    const Found found = find(mesh);
    expectNoContact(mesh, found);
    for (const auto& region : found.regions) large += region.size() >= 24;
    whole += found.isWhole(mesh);
    if (i % 8 == 0)
      with_contacts +=
          !test::bruteForceSelfContacts({mesh.t0, mesh.t1, mesh.triangles}).empty();
    ASSERT_FALSE(HasFailure());
  }
  EXPECT_GT(large, test::rounds(240U));
  EXPECT_GT(whole, test::rounds(200U));
  EXPECT_GT(with_contacts, test::rounds(100U));
}

std::vector<std::uint64_t> bitsOf(const QueryAnswer& answer) {
  std::vector<std::uint64_t> out;
  for (const FeatureContact& c : answer.contacts) {
    out.push_back(static_cast<std::uint64_t>(c.kind));
    for (const std::uint32_t v : c.vertices) out.push_back(v);
    for (const double x : {c.toc_lo, c.toc_hi}) {
      std::uint64_t bits;
      std::memcpy(&bits, &x, sizeof(bits));
      out.push_back(bits);
    }
  }
  return out;
}

QueryAnswer answerOf(const MeshInstance& mesh, ContinuousQuery query, bool with_regions,
                     int num_threads = 1) {
  QueryOptions options;
  options.query = query;
  options.leaves_out_regions = with_regions;
  options.num_threads = num_threads;
  return querySelf(mesh, options);
}

// The same contacts to the bit, with less work.
TEST(FCL_EMBEDDED_REGIONS, queriesAnswerTheSame) {
  std::vector<test::FramePairMesh> scenes{test::makeSmoothCloth(3000),
                                          test::makeSmoothCloth(12000, 7),
                                          test::makeTiles(4096)};
  const test::FrameSequence crumpling = test::makeCrumplingSheet(12);
  scenes.push_back(crumpling.pair(3));
  scenes.push_back(crumpling.pair(10));
  Random random(107);
  for (int i = 0; i < 6; ++i) {
    // A large sheet that is folded onto itself.
    MovingMesh mesh = still(square(24, 2, 0));
    moveAtRandom(mesh, random);
    scenes.push_back({mesh.t0, mesh.t1, mesh.triangles});
  }
  std::size_t contacts = 0, less = 0;
  for (const test::FramePairMesh& scene : scenes) {
    SCOPED_TRACE(&scene - scenes.data());
    const MovingMesh moving{scene.previous, scene.current, scene.triangles};
    const PreparedMovingMesh prepared(moving);
    const MeshInstance& mesh = prepared.instance();
    const QueryAnswer with = answerOf(mesh, ContinuousQuery::kAll, true),
                      without = answerOf(mesh, ContinuousQuery::kAll, false);
    EXPECT_EQ(bitsOf(with), bitsOf(without));
    EXPECT_EQ(with.hasCrossing(), without.hasCrossing());
    EXPECT_LE(with.counts.node_pairs, without.counts.node_pairs);
    less += with.counts.node_pairs < without.counts.node_pairs;
    contacts += with.counts.contacts;
    EXPECT_EQ(with.counts.contacts, without.counts.contacts);

    const QueryAnswer first = answerOf(mesh, ContinuousQuery::kFirst, true),
                      first_without = answerOf(mesh, ContinuousQuery::kFirst, false);
    ASSERT_EQ(first.contacts.empty(), first_without.contacts.empty());
    if (!first.contacts.empty()) {
      EXPECT_EQ(first.contacts.begin()->toc_lo, first_without.contacts.begin()->toc_lo);
      EXPECT_EQ(first.contacts.begin()->toc_hi, first_without.contacts.begin()->toc_hi);
    }
    EXPECT_EQ(answerOf(mesh, ContinuousQuery::kAny, true).contacts.empty(),
              answerOf(mesh, ContinuousQuery::kAny, false).contacts.empty());
  }
  EXPECT_GT(contacts, 1000U);
  EXPECT_GE(less, 4U);
}

TEST(FCL_EMBEDDED_REGIONS, doNotDependOnThreadsOrKernels) {
  const test::FramePairMesh scene = test::makeSmoothCloth(30000);
  const MovingMesh moving{scene.previous, scene.current, scene.triangles};
  const PreparedMovingMesh prepared(moving);
  for (const std::uint32_t least : {1U, kLeastRegion}) {
    const EmbeddedRegions one = regionsOf(prepared.tree(), least);
    EXPECT_GT(std::count(one.nodes.begin(), one.nodes.end(), 1), 2);
    for (const int num_threads : {2, 4}) {
      const EmbeddedRegions more =
          test::regionsOf(prepared.tree(), kernels(), num_threads, least);
      EXPECT_EQ(more.nodes, one.nodes) << num_threads;
      EXPECT_EQ(more.interior, one.interior) << num_threads;
    }
    for (const Kernels* k : allKernels()) {
      const EmbeddedRegions others = test::regionsOf(prepared.tree(), *k, 1, least);
      EXPECT_EQ(others.nodes, one.nodes) << k->name;
      EXPECT_EQ(others.interior, one.interior) << k->name;
    }
  }
  const QueryAnswer one = answerOf(prepared.instance(), ContinuousQuery::kAll, true);
  const QueryAnswer four = answerOf(prepared.instance(), ContinuousQuery::kAll, true, 4);
  EXPECT_EQ(bitsOf(one), bitsOf(four));
}

// Sheets that lie on each other, joined into one component. All of them face one
// direction, but no border of theirs is simple. A few borders are tested, and then the
// search stops.
TEST(FCL_EMBEDDED_REGIONS, layersAreNotSearchedInVain) {
  static std::size_t triangles_asked, boxes_compared;
  Kernels counting = kernels();
  counting.facedDirections = [](const TreeVertex* vertices, const TreeTriangle* triangles,
                                std::size_t count) {
    triangles_asked += count;
    return kernels().facedDirections(vertices, triangles, count);
  };
  counting.overlapTriangles = [](const LeafPairing& leaves, LanePairs& out) {
    kernels().overlapTriangles(leaves, out);
    boxes_compared += out.compared;
  };
  const auto search = [&counting](const test::FramePairMesh& scene) {
    const MovingMesh moving{scene.previous, scene.current, scene.triangles};
    const PreparedMovingMesh prepared(moving);
    triangles_asked = boxes_compared = 0;
    const EmbeddedRegions found = test::regionsOf(prepared.tree(), counting, 1);
    return std::count(found.nodes.begin(), found.nodes.end(), 1);
  };
  test::FramePairMesh tiles = test::makeTiles(120000);
  const std::size_t num_triangles = tiles.triangles.size();
  for (std::size_t i = test::kTileTriangles / 2; i < num_triangles;
       i += test::kTileTriangles / 2)
    tiles.triangles.emplace_back(tiles.triangles[i - 1][0], tiles.triangles[i - 1][1],
                                 tiles.triangles[i][0]);
  EXPECT_EQ(search(tiles), 0);
  EXPECT_GT(boxes_compared, 0U);
  EXPECT_LT(boxes_compared, tiles.triangles.size());
  EXPECT_LT(triangles_asked, tiles.triangles.size() / 4);
  const test::FramePairMesh cloth = test::makeSmoothCloth(30000);
  EXPECT_GT(search(cloth), 2);
  EXPECT_LE(triangles_asked, cloth.triangles.size());
}

// The traversal leaves out exactly the pairs below one of the marked nodes, whichever are
// marked.
TEST(FCL_EMBEDDED_REGIONS, traversalLeavesOutRegionsOnly) {
  constexpr std::uint64_t kSeed = 108;
  Random random(kSeed);
  using Pairs = std::set<std::pair<int, int>>;
  std::size_t left_out = 0;
  for (int i = 0; i < 30; ++i) {
    SCOPED_TRACE("seed " + std::to_string(kSeed) + ", " + std::to_string(i));
    const MovingMesh mesh = i % 2 ? test::crumpledSheet(random, 9, 0.1)
                                  : test::randomSoup(random, 150, 50, 1, 0.2);
    const PreparedMovingMesh prepared(mesh);
    const MovingKdopTree& tree = prepared.tree();
    std::vector<std::uint8_t> nodes(tree.numNodes());
    for (auto& n : nodes) n = random.index(4) == 0;
    Pairs all, some, expected;
    const auto into = [](Pairs& pairs) {
      return [&pairs](int a, int b, float) {
        EXPECT_TRUE(pairs.insert({std::min(a, b), std::max(a, b)}).second);
      };
    };
    test::traverse<true>(tree, tree, nullptr, into(all));
    test::traverse<true>(tree, tree, nullptr, into(some), 1,
                         {nullptr, nullptr, nodes.data()});
    std::vector<std::set<int>> nodes_of(tree.triangles().size());
    for (std::size_t n = 0; n < nodes.size(); ++n)
      if (nodes[n])
        for (const std::size_t t : trianglesBelow(tree, static_cast<int>(n)))
          nodes_of[t].insert(static_cast<int>(n));
    for (const auto& [a, b] : all) {
      const auto &x = nodes_of[static_cast<std::size_t>(a)],
                 &y = nodes_of[static_cast<std::size_t>(b)];
      if (std::none_of(x.begin(), x.end(), [&y](int n) { return y.count(n) > 0; }))
        expected.insert({a, b});
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
