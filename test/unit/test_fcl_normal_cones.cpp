// SPDX-License-Identifier: BSD-3-Clause
//
// Continuous normal cones and the contour test, against brute force. Regions that they
// cull touch themselves nowhere. Regions that they must not cull are not culled.
#include "baselines/normal_cones.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <set>
#include <string>
#include <vector>

#include "brute_force.h"
#include "mesh_generators.h"

namespace fcl {
namespace test {
namespace {

using detail::deformable::VertexPath;

std::vector<VertexPath> pathsOf(const FramePairMesh& mesh) {
  std::vector<VertexPath> paths;
  for (std::size_t i = 0; i < mesh.previous.size(); ++i) {
    const auto &p = mesh.previous[i], &q = mesh.current[i];
    paths.push_back({{p[0], p[1], p[2]}, {q[0], q[1], q[2]}});
  }
  return paths;
}

MeshConnectivity connectivityOf(const FramePairMesh& mesh) {
  std::vector<std::array<std::uint32_t, 3>> triangles;
  for (const Triangle& t : mesh.triangles)
    triangles.push_back({static_cast<std::uint32_t>(t[0]),
                         static_cast<std::uint32_t>(t[1]),
                         static_cast<std::uint32_t>(t[2])});
  return {triangles, mesh.previous.size()};
}

/// Regions: each is a set of triangles, by their ids.
Regions regionsOf(const std::vector<std::vector<int>>& sets) {
  Regions regions;
  for (const auto& set : sets) {
    for (const int triangle : set) regions.children.push_back(~triangle);
    regions.close();
  }
  return regions;
}

std::vector<int> allTriangles(const FramePairMesh& mesh) {
  std::vector<int> all;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
    all.push_back(static_cast<int>(i));
  return all;
}

bool isWholeLeftOut(const FramePairMesh& mesh) {
  const MeshConnectivity connectivity = connectivityOf(mesh);
  const Regions regions = regionsOf({allTriangles(mesh)});
  NormalCones cones(regions, connectivity, 1);
  const auto paths = pathsOf(mesh);
  cones.update(paths);
  return cones.isFreeOfSelfContact(0);
}

/// The contacts between features of some of the triangles.
std::size_t contactsWithin(const FramePairMesh& mesh, const std::vector<int>& triangles,
                           const std::vector<PairName>& contacts) {
  std::set<std::array<int, 1>> vertices;
  std::set<std::array<int, 2>> edges;
  std::set<std::array<int, 3>> faces;
  for (const int i : triangles) {
    const Triangle& t = mesh.triangles[static_cast<std::size_t>(i)];
    std::array<int, 3> v = {static_cast<int>(t[0]), static_cast<int>(t[1]),
                            static_cast<int>(t[2])};
    std::sort(v.begin(), v.end());
    faces.insert(v);
    for (const int id : v) vertices.insert({id});
    edges.insert({v[0], v[1]});
    edges.insert({v[0], v[2]});
    edges.insert({v[1], v[2]});
  }
  std::size_t count = 0;
  for (const PairName& c : contacts)
    count += c[0] == 0 ? vertices.count({c[1]}) && faces.count({c[2], c[3], c[4]})
                       : edges.count({c[1], c[2]}) && edges.count({c[3], c[4]});
  return count;
}

/// A given number of triangles around a random one, if they are connected.
std::vector<int> randomPatch(const FramePairMesh& mesh, std::size_t size,
                             Random& random) {
  std::vector<int> patch{static_cast<int>(random.index(mesh.triangles.size()))};
  const auto isNext = [&](std::size_t i) {
    for (const int j : patch) {
      int shared = 0;
      for (int k = 0; k < 3; ++k)
        for (int l = 0; l < 3; ++l)
          shared +=
              mesh.triangles[i][k] == mesh.triangles[static_cast<std::size_t>(j)][l];
      if (shared >= 2) return true;
    }
    return false;
  };
  while (patch.size() < size) {
    std::vector<int> next;
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
      if (std::find(patch.begin(), patch.end(), static_cast<int>(i)) == patch.end() &&
          isNext(i))
        next.push_back(static_cast<int>(i));
    if (next.empty()) break;
    patch.push_back(next[random.index(next.size())]);
  }
  return patch;
}

struct Tally {
  int left_out{0};
  int touching{0};
};

/// Random regions of a mesh, in one piece and in two: none that is culled touches itself.
void checkRandomRegions(const FramePairMesh& mesh, Random& random, Tally& tally) {
  const auto contacts = bruteForceSelfContacts(mesh);
  std::vector<std::vector<int>> sets;
  for (int i = 0; i < 40; ++i) {
    std::vector<int> set = randomPatch(mesh, 2 + random.index(14), random);
    if (i % 4 == 0)
      for (const int t : randomPatch(mesh, 1 + random.index(6), random))
        if (std::find(set.begin(), set.end(), t) == set.end()) set.push_back(t);
    sets.push_back(set);
  }
  const MeshConnectivity connectivity = connectivityOf(mesh);
  const Regions regions = regionsOf(sets);
  NormalCones cones(regions, connectivity, 1);
  const auto paths = pathsOf(mesh);
  cones.update(paths);
  for (std::size_t i = 0; i < sets.size(); ++i) {
    const std::size_t within = contactsWithin(mesh, sets[i], contacts);
    tally.touching += within > 0;
    if (!cones.isFreeOfSelfContact(i)) continue;
    ++tally.left_out;
    EXPECT_EQ(within, 0u) << "region " << i << " of " << sets[i].size() << " triangles";
  }
}

/// A sheet of cells of size 1 that is shaken, mainly in its plane: triangles turn over,
/// borders cross.
FramePairMesh shakenSheet(double in_plane, double out_of_plane, Random& random) {
  const TestMesh sheet = makeSheet(
      5, 5, [](double u, double v) { return Vector3<double>(5 * u, 5 * v, 0); });
  FramePairMesh mesh{{}, {}, sheet.triangles};
  const auto shaken = [&](const Vector3<double>& p) {
    const Vector3<double> by = random.point(1);
    return Vector3<double>(p[0] + in_plane * by[0], p[1] + in_plane * by[1],
                           p[2] + out_of_plane * by[2]);
  };
  for (const auto& p : sheet.vertices) {
    mesh.previous.push_back(shaken(p));
    mesh.current.push_back(shaken(p));
  }
  return mesh;
}

TEST(FCL_NORMAL_CONES, aConeContainsTheNormalAtAllTimes) {
  Random random(1);
  int narrow = 0;
  for (int run = 0; run < 2000; ++run) {
    VertexPath x[3];
    for (VertexPath& path : x) {
      const auto p = random.point(1), by = random.point(random.uniform(0, 1));
      for (int k = 0; k < 3; ++k) {
        path.t0[k] = p[k];
        path.t1[k] = p[k] + by[k];
      }
    }
    const NormalCone cone = continuousNormalCone(x[0], x[1], x[2]);
    if (cone.isFull()) continue;
    ++narrow;
    const NormalCone other = {{0, 0, 1}, 0.3};
    const NormalCone both = merged(cone, other);
    for (int i = 0; i <= 50; ++i) {
      Vector3<double> p[3];
      for (int k = 0; k < 3; ++k)
        p[k] = (50 - i) / 50. * Vector3<double>(x[k].t0) +
               i / 50. * Vector3<double>(x[k].t1);
      const Vector3<double> n = (p[1] - p[0]).cross(p[2] - p[0]).normalized();
      EXPECT_GE(n.dot(Vector3<double>(cone.axis.data())), std::cos(cone.angle));
      if (!both.isFull()) {
        EXPECT_GE(n.dot(Vector3<double>(both.axis.data())), std::cos(both.angle));
      }
    }
    if (!both.isFull()) {
      EXPECT_LE(std::acos(both.axis[2]) + 0.3, both.angle);
    }
  }
  EXPECT_GT(narrow, 500);
}

TEST(FCL_NORMAL_CONES, aRegionThatIsLeftOutTouchesNowhere) {
  Tally tally;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const FramePairMesh mesh =
        shakenSheet(random.uniform(0.05, 0.9), random.uniform(0, 0.4), random);
    checkRandomRegions(mesh, random, tally);
  }
  EXPECT_GT(tally.left_out, 300);
  EXPECT_GT(tally.touching, 300);
}

/// Vertices that are joined, triangles that are repeated and turned over, sheets on top
/// of each other.
TEST(FCL_NORMAL_CONES, norDoesOneThatIsNoManifold) {
  Tally tally;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    FramePairMesh mesh = shakenSheet(random.uniform(0.05, 0.4), 0.1, random);
    const std::size_t n = mesh.previous.size();
    for (auto& t : mesh.triangles)
      for (int k = 0; k < 3; ++k)
        if (random.index(40) == 0) t[k] = random.index(n);
    for (std::size_t i = 0; i < 5; ++i) {
      Triangle t = mesh.triangles[random.index(mesh.triangles.size())];
      if (i % 2 == 0) std::swap(t[0], t[1]);
      mesh.triangles.push_back(t);
      t[2] = random.index(n);
      mesh.triangles.push_back(t);
    }
    const FramePairMesh layer = shakenSheet(0.1, 0.05, random);
    for (std::size_t i = 0; i < layer.previous.size(); ++i) {
      mesh.previous.push_back(layer.previous[i] + Vector3<double>(0.3, 0.2, 0.3));
      mesh.current.push_back(layer.current[i] + Vector3<double>(0.3, 0.2, -0.1));
    }
    for (const Triangle& t : layer.triangles)
      mesh.triangles.emplace_back(t[0] + n, t[1] + n, t[2] + n);
    checkRandomRegions(mesh, random, tally);
  }
  EXPECT_GT(tally.left_out, 300);
  EXPECT_GT(tally.touching, 150);
}

TEST(FCL_NORMAL_CONES, aSmoothSheetIsLeftOutWhole) {
  FramePairMesh mesh;
  const TestMesh sheet = makeSheet(12, 9, [](double u, double v) {
    return Vector3<double>(u, v, 0.1 * std::sin(5 * u + 3 * v));
  });
  mesh = {sheet.vertices, sheet.vertices, sheet.triangles};
  for (auto& p : mesh.current) p += Vector3<double>(0.1 * p[1], 0.2 * p[0], p[0] * p[1]);
  EXPECT_TRUE(isWholeLeftOut(mesh));
}

/// As published, the test asks whether the contour crosses itself. The contours of a
/// sheet and of a smaller one above it do not, wherever the sheets go.
TEST(FCL_NORMAL_CONES, layersWhoseContoursDoNotCrossAreNotLeftOut) {
  TestMesh sheets = makeSheet(6, 6);
  const TestMesh smaller = makeSheet(4, 4, [](double u, double v) {
    return Vector3<double>(0.25 + 0.45 * u, 0.25 + 0.45 * v, 0.2);
  });
  append(sheets, smaller);
  FramePairMesh mesh{sheets.vertices, sheets.vertices, sheets.triangles};
  for (auto& p : mesh.current)
    if (p[2] > 0.1) p[2] = -0.2;
  EXPECT_FALSE(bruteForceSelfContacts(mesh).empty());
  EXPECT_FALSE(isWholeLeftOut(mesh));
}

/// A flat ring with a gap that closes during the step. All normals are equal.
TEST(FCL_NORMAL_CONES, aContourThatMeetsItselfIsNotLeftOut) {
  const auto ring = [](double angle) {
    return makeSheet(24, 2, [angle](double u, double v) {
      const double r = 2 - v, a = angle * u;
      return Vector3<double>(r * std::cos(a), r * std::sin(a), 0);
    });
  };
  const TestMesh open = ring(5.5);
  FramePairMesh mesh{open.vertices, ring(6.2).vertices, open.triangles};
  EXPECT_TRUE(isWholeLeftOut(mesh));
  EXPECT_TRUE(bruteForceSelfContacts(mesh).empty());
  mesh.current = ring(6.6).vertices;
  EXPECT_FALSE(isWholeLeftOut(mesh));
  EXPECT_FALSE(bruteForceSelfContacts(mesh).empty());
}

/// More than one turn of a ramp. It is connected, its normals are within a narrow cone,
/// and its turns are far apart at t = 0. They meet later.
TEST(FCL_NORMAL_CONES, aRampOfTwoTurnsIsNotLeftOut) {
  const auto ramp = [](double height) {
    return makeSheet(48, 2, [height](double u, double v) {
      const double r = 2 - v, a = 12 * u;
      return Vector3<double>(r * std::cos(a), r * std::sin(a), height * u);
    });
  };
  const TestMesh first = ramp(0.5);
  const FramePairMesh mesh{first.vertices, ramp(-0.5).vertices, first.triangles};
  EXPECT_FALSE(bruteForceSelfContacts(mesh).empty());
  EXPECT_FALSE(isWholeLeftOut(mesh));
}

/// A sheet that is wound around the cut from its middle to its border, so that its two
/// sides overlap. The contour crosses itself only where the cut begins.
TEST(FCL_NORMAL_CONES, aFanThatOverlapsItselfIsNotLeftOut) {
  constexpr std::size_t kSpokes = 15;
  FramePairMesh mesh;
  mesh.previous.emplace_back(0, 0, 0);
  for (std::size_t i = 0; i < kSpokes; ++i) {
    const double a = 0.5 * static_cast<double>(i);
    mesh.previous.emplace_back(std::cos(a), std::sin(a), 0.05 * a);
    if (i > 0) mesh.triangles.emplace_back(0, i, i + 1);
  }
  mesh.current = mesh.previous;
  for (auto& p : mesh.current) p[2] = -p[2];
  EXPECT_FALSE(isWholeLeftOut(mesh));
}

TEST(FCL_NORMAL_CONES, aClosedSurfaceIsNotLeftOut) {
  const TestMesh ball = makeIcosphere(2, 1);
  EXPECT_FALSE(isWholeLeftOut({ball.vertices, ball.vertices, ball.triangles}));
}

}  // namespace
}  // namespace test
}  // namespace fcl
