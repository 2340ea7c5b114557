// SPDX-License-Identifier: BSD-3-Clause
//
// The borders of a tree's nodes have the edges of their triangles that are left. They are
// found once, and kept as long as the structure stays. No answer depends on whether they
// were kept.
#include "tree/border_finder.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <new>
#include <string>
#include <thread>
#include <vector>

#include "generated_scenes.h"
#include "kernels/kernels.h"
#include "mesh_generators.h"
#include "moving_mesh.h"
#include "regions_of.h"
#include "self_culling/embedded_regions.h"
#include "tree_checks.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

using test::expectBorders;
using test::MovingMesh;
using test::Random;
using Points = std::vector<Vector3<double>>;

VertexFrames framesOf(const Points& t0, const Points& t1) {
  return {t0[0].data(), t1[0].data(), t0.size()};
}

MovingKdopTree treeOf(const test::TestMesh& mesh) {
  const VertexFrames frames = framesOf(mesh.vertices, mesh.vertices);
  MovingKdopTree tree;
  tree.build(mesh.triangles.data(), mesh.triangles.size(), frames);
  tree.refit(frames);
  return tree;
}

EmbeddedRegions regionsOf(const MovingKdopTree& tree) {
  return test::regionsOf(tree, kernels(), 1, 8);
}

// Edges of one triangle to many, twice in the same direction, from a vertex to itself.
TEST(FCL_REGION_BORDER, isWhatIsLeftOfTheEdges) {
  for (const test::TestMesh& mesh :
       {test::makeSheet(12, 9), test::makeIcosphere(3, 1), test::makeBox({1, 1, 1}, 6),
        test::makeTriangleSoup(300, 1, 0.1, 5)})
    ASSERT_NO_FATAL_FAILURE(expectBorders(treeOf(mesh)));
  constexpr std::uint64_t kSeed = 120;
  Random random(kSeed);
  for (int i = 0; i < 60; ++i) {
    SCOPED_TRACE("seed " + std::to_string(kSeed) + ", " + std::to_string(i));
    const std::size_t count = 1 + random.index(200);
    const MovingMesh soup =
        test::randomSoup(random, count, 3 + random.index(count), 1, 0);
    ASSERT_NO_FATAL_FAILURE(expectBorders(treeOf({soup.t0, soup.triangles})));
    // A sheet with holes, and with a few triangles turned.
    test::TestMesh holes = test::makeSheet(9, 9);
    for (int k = 0; k < 12; ++k) {
      const std::size_t at = random.index(holes.triangles.size());
      holes.triangles.erase(holes.triangles.begin() + static_cast<std::ptrdiff_t>(at));
    }
    if (i % 2) {
      Triangle& t = holes.triangles[random.index(holes.triangles.size())];
      t = Triangle(t[0], t[2], t[1]);
    }
    ASSERT_NO_FATAL_FAILURE(expectBorders(treeOf(holes)));
  }
}

TEST(FCL_REGION_BORDER, isFoundOnce) {
  RegionBorders borders(3);
  int count = 0;
  const auto find = [&count] {
    ++count;
    RegionBorder border;
    border.points.resize(1000);
    return border;
  };
  const std::size_t before = borders.memUsage();
  const RegionBorder& first = borders.of(1, find);
  EXPECT_EQ(first.points.size(), 1000U);
  EXPECT_EQ(&borders.of(1, find), &first);
  EXPECT_EQ(count, 1);
  EXPECT_GE(borders.memUsage(), before + 1000 * sizeof(std::uint32_t));
  EXPECT_NE(&borders.of(2, find), &first);
  EXPECT_EQ(count, 2);
  // A border without edges is kept, too.
  EXPECT_EQ(borders.of(0, [] { return RegionBorder(); }).size(), 0U);
  EXPECT_EQ(&borders.of(0, find), &borders.of(0, find));
  EXPECT_EQ(count, 2);
}

TEST(FCL_REGION_BORDER, whatFailsLeavesNone) {
  RegionBorders borders(1);
  const auto fail = []() -> RegionBorder { throw std::bad_alloc(); };
  EXPECT_THROW(borders.of(0, fail), std::bad_alloc);
  const auto found = [] {
    RegionBorder border;
    border.begins.resize(4);
    return border;
  };
  EXPECT_EQ(borders.of(0, found).size(), 4U);
}

// Two threads find the same border at the same time: both get the same one.
TEST(FCL_REGION_BORDER, threadsAtATime) {
  RegionBorders borders(1);
  std::atomic<int> inside{0};
  const auto find = [&inside] {
    ++inside;
    while (inside < 2) std::this_thread::yield();
    return RegionBorder();
  };
  const RegionBorder* found[2];
  std::thread other([&] { found[1] = &borders.of(0, find); });
  found[0] = &borders.of(0, find);
  other.join();
  EXPECT_EQ(inside, 2);
  EXPECT_EQ(found[0], found[1]);
}

// Copies have the same structure, as long as none of them changes.
TEST(FCL_REGION_BORDER, ofCopies) {
  const test::TestMesh sheet = test::makeSheet(20, 20),
                       sphere = test::makeIcosphere(3, 1);
  const MovingKdopTree tree = treeOf(sheet);
  expectBorders(tree);
  MovingKdopTree copy = tree;
  EXPECT_EQ(&copy.regionBorders(), &tree.regionBorders());
  const VertexFrames frames = framesOf(sphere.vertices, sphere.vertices);
  copy.build(sphere.triangles.data(), sphere.triangles.size(), frames);
  copy.refit(frames);
  EXPECT_NE(&copy.regionBorders(), &tree.regionBorders());
  expectBorders(copy);
  expectBorders(tree);
}

TEST(FCL_REGION_BORDER, isCountedAsMemory) {
  const MovingKdopTree tree = treeOf(test::makeSheet(20, 20));
  const std::size_t before = tree.memUsage();
  expectBorders(tree);
  // Each triangle has at least one edge in the border of its lowest node.
  EXPECT_GE(tree.memUsage(), before + tree.triangles().size() * sizeof(std::uint32_t));
}

// A tree with queries in all previous steps has the regions of one without.
TEST(FCL_REGION_BORDER, regionsAreTheSameThroughout) {
  for (const test::FrameSequence& sequence :
       {test::makeCrumplingSheet(9), test::makeWavingCloth(4)}) {
    const auto build = [&sequence] {
      return treeOf({sequence.frames[0], sequence.triangles});
    };
    MovingKdopTree kept = build();
    std::size_t count = 0;
    for (std::size_t i = 0; i + 1 < sequence.frames.size(); ++i) {
      const VertexFrames frames = framesOf(sequence.frames[i], sequence.frames[i + 1]);
      MovingKdopTree fresh = build();
      kept.refit(frames);
      fresh.refit(frames);
      const EmbeddedRegions expected = regionsOf(fresh);
      for (int k = 0; k < 2; ++k) {
        const EmbeddedRegions regions = regionsOf(kept);
        EXPECT_EQ(regions.nodes, expected.nodes) << "step " << i;
        EXPECT_EQ(regions.interior, expected.interior) << "step " << i;
      }
      for (const std::uint8_t is_region : expected.nodes) count += is_region;
    }
    EXPECT_GT(count, 10U);
  }
}

}  // namespace
}  // namespace deformable
}  // namespace detail
}  // namespace fcl
