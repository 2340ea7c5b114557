// SPDX-License-Identifier: BSD-3-Clause
//
// The scenes of the paper's evaluation, made small: what a benchmark relies on holds in
// each of them. Full size is checked where nothing needs to be simulated for it.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "fcl/common/exception.h"
#include "fragile_designs.h"
#include "paper_scenes.h"
#include "proximity.h"
#include "scene_measure.h"

namespace fcl {
namespace test {
namespace {

using Vec = Vector3<double>;

/// A few hundred triangles, and frames enough to touch.
SceneOptions smallScene(SceneKind kind) {
  SceneOptions options;
  switch (kind) {
    case SceneKind::kAlphabets:
      options.scale = 0.2;
      options.frames = 30;
      break;
    case SceneKind::kBalls:
      options.scale = 0.04;
      options.frames = 30;
      break;
    case SceneKind::kLion:
      options.scale = 0.0005;
      options.frames = 12;
      break;
    default:
      options.scale = 0.01;
      options.frames = 24;
  }
  return options;
}

/// A frame that outlives the callback.
struct KeptFrame {
  std::vector<Triangle> triangles;
  std::vector<Vec> previous, current, accepted;
  TopologyChange change;
};

std::vector<KeptFrame> keepFrames(SceneKind kind, const SceneOptions& options) {
  std::vector<KeptFrame> frames;
  generateScene(kind, options, [&](const SceneFrame& frame) {
    frames.push_back(
        {frame.triangles, frame.previous, frame.current, frame.accepted, frame.change});
    return true;
  });
  return frames;
}

bool sameTriangles(const std::vector<Triangle>& a, const std::vector<Triangle>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const auto& s, auto& t) {
    return s[0] == t[0] && s[1] == t[1] && s[2] == t[2];
  });
}

/// Whether each edge of the triangles is met as often one way as the other.
bool isClosed(const std::vector<Triangle>& triangles) {
  std::map<std::array<std::size_t, 2>, int> balance;
  for (const Triangle& t : triangles)
    for (int k = 0; k < 3; ++k) {
      const std::size_t a = t[k], b = t[(k + 1) % 3];
      balance[{{std::min(a, b), std::max(a, b)}}] += a < b ? 1 : -1;
    }
  return std::all_of(balance.begin(), balance.end(),
                     [](const auto& entry) { return entry.second == 0; });
}

TEST(FCL_PAPER_SCENES, countsAreThoseOfThePaper) {
  for (const SceneInfo& info : sceneInfos()) {
    SCOPED_TRACE(info.name);
    const auto count =
        static_cast<double>(sceneMesh(info.kind, SceneOptions()).triangles.size());
    EXPECT_NEAR(count, info.paper_triangles, 0.05 * info.paper_triangles);
    EXPECT_GE(info.frames, info.kind == SceneKind::kLion ? 30 : 60);
  }
}

TEST(FCL_PAPER_SCENES, sameSeedSameBits) {
  for (const SceneInfo& info : sceneInfos()) {
    SCOPED_TRACE(info.name);
    SceneOptions options = smallScene(info.kind);
    options.frames = info.kind == SceneKind::kAlphabets ? 24 : 6;
    const auto first = keepFrames(info.kind, options);
    options.num_threads = 2;
    const auto second = keepFrames(info.kind, options);
    ++options.seed;
    const auto other = keepFrames(info.kind, options);
    ASSERT_EQ(first.size(), static_cast<std::size_t>(options.frames));
    ASSERT_EQ(second.size(), first.size());
    for (std::size_t i = 0; i < first.size(); ++i) {
      ASSERT_TRUE(sameTriangles(first[i].triangles, second[i].triangles)) << i;
      ASSERT_EQ(first[i].previous, second[i].previous) << i;
      ASSERT_EQ(first[i].current, second[i].current) << i;
      ASSERT_EQ(first[i].accepted, second[i].accepted) << i;
    }
    EXPECT_NE(first.back().accepted, other.back().accepted);
  }
}

// Contacts make nothing faster: balls that fall into a bowl come to lie there.
TEST(FCL_PAPER_SCENES, ballsStayInTheBowl) {
  SceneOptions options;
  options.scale = 0.08;
  options.frames = 40;
  Eigen::AlignedBox3d room;
  generateScene(SceneKind::kBalls, options, [&](const SceneFrame& frame) {
    Eigen::AlignedBox3d reach;
    for (const Vec& p : frame.accepted) reach.extend(p);
    if (frame.index == 0) room = reach;
    const Vec spare = Vec::Constant(0.1 * room.sizes().maxCoeff());
    const bool is_inside =
        Eigen::AlignedBox3d(room.min() - spare, room.max() + spare).contains(reach);
    EXPECT_TRUE(is_inside) << "frame " << frame.index;
    return is_inside;
  });
}

TEST(FCL_PAPER_SCENES, framesAreWholeAndContactsStartAndEnd) {
  for (const SceneInfo& info : sceneInfos()) {
    SCOPED_TRACE(info.name);
    SceneMeasure measure(1);
    std::size_t started = 0, ended = 0;
    std::vector<Vec> last;
    generateScene(info.kind, smallScene(info.kind), [&](const SceneFrame& frame) {
      SCOPED_TRACE(frame.index);
      const FrameFigures figures = measure.measure(frame);
      EXPECT_FALSE(figures.crossing);
      EXPECT_FALSE(frame.report.crossing);
      EXPECT_EQ(frame.report.unresolved, 0u);
      started += figures.started;
      ended += figures.ended;
      for (const auto* points : {&frame.previous, &frame.current, &frame.accepted})
        EXPECT_TRUE(std::all_of(points->begin(), points->end(),
                                [](const Vec& p) { return p.allFinite(); }));
      EXPECT_EQ(frame.previous.size(), frame.body_of.size());
      if (frame.index > 0 && frame.change.isEmpty()) {
        EXPECT_EQ(frame.previous, last);
      }
      last = frame.accepted;
      return !testing::Test::HasFailure();
    });
    EXPECT_GT(started, 20u);
    EXPECT_GT(ended, 0u);
  }
}

TEST(FCL_PAPER_SCENES, lettersAndLionBreak) {
  for (const SceneKind kind : {SceneKind::kAlphabets, SceneKind::kLion}) {
    SCOPED_TRACE(static_cast<int>(kind));
    const auto frames = keepFrames(kind, smallScene(kind));
    int breaks = 0;
    for (std::size_t i = 1; i < frames.size(); ++i) {
      const KeptFrame& before = frames[i - 1];
      const KeptFrame& now = frames[i];
      if (now.change.isEmpty()) {
        EXPECT_TRUE(sameTriangles(before.triangles, now.triangles));
        continue;
      }
      ++breaks;
      EXPECT_EQ(now.change.first_new_triangle, before.triangles.size());
      EXPECT_EQ(now.change.first_new_vertex, before.accepted.size());
      EXPECT_EQ(now.previous.size(),
                before.accepted.size() + now.change.split_from.size());
      EXPECT_GT(now.triangles.size(), before.triangles.size());
      EXPECT_TRUE(isClosed(now.triangles) || kind == SceneKind::kLion);
      // What is not listed has not changed.
      std::vector<Triangle> expected = before.triangles;
      for (const int id : now.change.changed_triangles)
        expected[static_cast<std::size_t>(id)] =
            now.triangles[static_cast<std::size_t>(id)];
      expected.insert(expected.end(),
                      now.triangles.begin() +
                          static_cast<std::ptrdiff_t>(now.change.first_new_triangle),
                      now.triangles.end());
      EXPECT_TRUE(sameTriangles(expected, now.triangles));
      for (std::size_t k = 0; k < now.change.split_from.size(); ++k) {
        const auto from = static_cast<std::size_t>(now.change.split_from[k]);
        const Vec& p = now.previous[now.change.first_new_vertex + k];
        const Vec& q = from < before.accepted.size() ? before.accepted[from] : p;
        EXPECT_LT((p - q).norm(), 0.15);  // a quarter of a coarse edge
      }
    }
    EXPECT_GT(breaks, 0);
  }
}

TEST(FCL_PAPER_SCENES, aSinkEndsTheScene) {
  int frames = 0;
  generateScene(SceneKind::kBalls, smallScene(SceneKind::kBalls),
                [&](const SceneFrame&) { return ++frames < 2; });
  EXPECT_EQ(frames, 2);
}

TEST(FCL_PROXIMITY, nearPairsAreThoseOfAllPairs) {
  const TestMesh mesh = makeTriangleSoup(120, 0.5, 0.3, 3);
  std::vector<char> is_movable(mesh.vertices.size(), 1);
  for (std::size_t v = 0; v < 180; ++v) is_movable[v] = 0;
  const double distance = 0.04;
  std::vector<std::pair<int, int>> expected;
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f)
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
      const Triangle& t = mesh.triangles[f];
      if (v == t[0] || v == t[1] || v == t[2]) continue;
      if (!is_movable[v] && !is_movable[t[0]]) continue;
      const Vec w = closestWeights(mesh.vertices[v], mesh.vertices[t[0]],
                                   mesh.vertices[t[1]], mesh.vertices[t[2]]);
      const Vec closest = w[0] * mesh.vertices[t[0]] + w[1] * mesh.vertices[t[1]] +
                          w[2] * mesh.vertices[t[2]];
      if ((closest - mesh.vertices[v]).norm() < distance)
        expected.emplace_back(static_cast<int>(v), static_cast<int>(f));
    }
  ASSERT_GT(expected.size(), 20u);
  for (const double cell_size : {0.02, 0.1, 2.0}) {
    std::vector<std::pair<int, int>> found;
    for (const NearPair& pair :
         findNearPairs(mesh.vertices, mesh.triangles, is_movable, distance, cell_size))
      found.emplace_back(pair.vertex, pair.triangle);
    EXPECT_EQ(found, expected) << "cell size " << cell_size;
  }
}

TEST(FCL_PROXIMITY, closestPointIsNotFartherThanAnySample) {
  Random random(11);
  for (int i = 0; i < 200; ++i) {
    const Vec a = random.point(1), b = random.point(1), c = random.point(1);
    const Vec p = random.point(2);
    const Vec w = closestWeights(p, a, b, c);
    EXPECT_GE(w.minCoeff(), 0);
    EXPECT_NEAR(w.sum(), 1, 1e-12);
    const double distance = (w[0] * a + w[1] * b + w[2] * c - p).norm();
    for (int s = 0; s < 50; ++s) {
      const double x = random.uniform(0, 1);
      const double y = random.uniform(0, 1 - x);
      EXPECT_LE(distance, ((1 - x - y) * a + x * b + y * c - p).norm() + 1e-12);
    }
  }
}

TEST(FCL_CLOTH_SIMULATOR, bodiesCannotBeAddedToARunningScene) {
  ClothSimulator simulator{SimulatorOptions()};
  const TestMesh sheet = makeSheet(4, 4);
  simulator.addCloth(sheet, sheet.vertices);
  simulator.advanceFrame();
  EXPECT_THROW(simulator.addObstacle(makeBox(Vec(1, 1, 1))), Exception);
}

TEST(FCL_FRAGILE_SHELL, partsAreClosedAndApart) {
  for (int letter = 0; letter < numLetters(); ++letter) {
    SCOPED_TRACE(letter);
    Random random(5);
    const ShellDesign design = makeLetter(letter, 0.04, 2, 4, random);
    FragileShell shell(design);
    TestMesh mesh = shell.mesh();
    EXPECT_TRUE(isClosed(mesh.triangles));
    EXPECT_EQ(shell.findParts(), std::vector<int>(4, 0));
    for (auto& bond : shell.bonds()) bond.is_broken = true;
    const std::vector<int> parts = shell.findParts();
    EXPECT_EQ(parts, (std::vector<int>{0, 1, 2, 3}));
    TopologyChange change;
    change.first_new_triangle = mesh.triangles.size();
    change.first_new_vertex = mesh.vertices.size();
    shell.split(parts, 0.05, mesh.triangles, mesh.vertices, change);
    EXPECT_TRUE(isClosed(mesh.triangles));
    EXPECT_EQ(mesh.vertices.size(), change.first_new_vertex + change.split_from.size());
    // Every vertex belongs to one part, and parts do not touch.
    std::vector<int> part_of(mesh.vertices.size(), -1);
    const auto vertices = shell.verticesOf(parts);
    for (std::size_t part = 0; part < vertices.size(); ++part)
      for (const int v : vertices[part]) {
        EXPECT_EQ(part_of[static_cast<std::size_t>(v)], -1);
        part_of[static_cast<std::size_t>(v)] = static_cast<int>(part);
      }
    for (const Triangle& t : mesh.triangles)
      for (int k = 1; k < 3; ++k) EXPECT_EQ(part_of[t[k]], part_of[t[0]]);
    const std::vector<Triangle> triangles = mesh.triangles;
    const auto& at_rest = mesh.vertices;
    const SceneFrame frame{0,       0,      triangles, at_rest, at_rest, at_rest,
                           at_rest, change, {},        part_of, {}};
    const FrameFigures figures = SceneMeasure(1).measure(frame);
    EXPECT_FALSE(figures.crossing);
    EXPECT_EQ(figures.contacts(), 0u);
  }
}

TEST(FCL_AFFINE_BODY, aPushMovesThePointByItsMobility) {
  const TestMesh box = makeBox(Vec(0.3, 0.2, 0.1), 2);
  AffineBody body;
  const Vec centre =
      body.setMasses(box.vertices, std::vector<double>(box.vertices.size(), 0.5));
  EXPECT_LT(centre.norm(), 1e-15);
  body.frequency = 10;
  const Vec rest(0.3, -0.2, 0.1), impulse(0.2, 0.5, -0.1);
  body.push(1, rest, impulse);
  const Vec moved = body.end.centre + body.end.shape * rest - rest;
  EXPECT_LT((moved - body.mobility(1, rest) * impulse).norm(), 1e-12);
  const double mass = 0.5 * static_cast<double>(box.vertices.size());
  EXPECT_LT((body.end.centre * mass - impulse).norm(), 1e-12);
}

TEST(FCL_AFFINE_BODY, closestRotationIsOne) {
  Random random(3);
  for (int i = 0; i < 100; ++i) {
    Matrix3<double> m;
    for (int k = 0; k < 3; ++k) m.col(k) = random.point(1);
    const Matrix3<double> r = closestRotation(m);
    EXPECT_LT((r * r.transpose() - Matrix3<double>::Identity()).norm(), 1e-12);
    EXPECT_NEAR(r.determinant(), 1, 1e-12);
    EXPECT_LT((closestRotation(r) - r).norm(), 1e-12);
  }
}

}  // namespace
}  // namespace test
}  // namespace fcl
