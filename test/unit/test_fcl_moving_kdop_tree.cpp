// SPDX-License-Identifier: BSD-3-Clause
//
// The moving tree: its boxes contain what they should at every time, and no pair that
// meets is lost on the way down.
#include "tree/moving_kdop_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cfenv>
#include <cfloat>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <functional>
#include <limits>
#include <map>
#include <numeric>
#include <set>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>
#ifdef __SSE__
#include <xmmintrin.h>
#endif

#include "api/prepared_mesh.h"
#include "components.h"
#include "fcl/math/bv/OBBRSS.h"
#include "fcl/math/bv/kDOP.h"
#include "fcl/math/bv/kIOS.h"
#include "moving_mesh.h"
#include "placed_mesh.h"
#include "query/deformable_query.h"
#include "test_models.h"
#include "traverse.h"
#include "tree/box_position.h"
#include "tree_checks.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

using test::coordinatesAt;
using test::expectContainment;
using test::expectSameBoxes;
using test::expectStructure;
using test::halfAt;
using test::kTimes;
using test::MovingMesh;
using test::PreparedMovingMesh;
using test::Random;

template <typename S>
std::vector<S> coordinates(const std::vector<Vector3<double>>& points, double scale,
                           double offset) {
  std::vector<S> out;
  for (const auto& p : points)
    for (int k = 0; k < 3; ++k)
      out.push_back(static_cast<S>(scale * p[k] + offset * (k - 1.3)));
  return out;
}

template <typename S>
void testContainment(std::uint64_t seed) {
  Random random(seed);
  for (const double offset : {0., 1e6, 1e12, 1e30})
    for (const double scale : {1e-6, 1., 1e6}) {
      SCOPED_TRACE("seed " + std::to_string(seed) + ", offset " + std::to_string(offset) +
                   ", scale " + std::to_string(scale));
      const MovingMesh mesh = test::randomSoup(random, 50, 60, 1, 0.3);
      const auto t0 = coordinates<S>(mesh.t0, scale, offset);
      const auto t1 = coordinates<S>(mesh.t1, scale, offset);
      const VertexFrames frames(t0.data(), t1.data(), mesh.t0.size());
      const auto triangles =
          assignFeatures(mesh.triangles.data(), mesh.triangles.size(), mesh.t0.size());
      MovingKdopTree tree;
      tree.build(mesh.triangles.data(), mesh.triangles.size(), frames);
      tree.refit(frames);
      expectContainment(tree, triangles, frames);
      const MovingKdopTree before = tree;

      Pose turn, move;
      const double rotation[9] = {0.6, -0.8, 0, 0.8, 0.6, 0, 0, 0, 1};
      std::copy(rotation, rotation + 9, turn.rotation);
      move.translation[0] = 3 * scale;
      VertexFrames posed = frames;
      posed.setPoses(turn, move);
      tree.refit(posed);
      expectContainment(tree, triangles, posed);
      // Frames the other way round, and then the first ones again.
      const VertexFrames back(t1.data(), t0.data(), mesh.t0.size());
      tree.refit(back);
      expectContainment(tree, triangles, back);
      tree.refit(frames);
      expectSameBoxes(tree, before);
      // One array as both frames is no different from two equal ones.
      tree.refit({t0.data(), t0.data(), mesh.t0.size()});
      const MovingKdopTree still = tree;
      const std::vector<S> again = t0;
      tree.refit({t0.data(), again.data(), mesh.t0.size()});
      expectSameBoxes(tree, still);
      if (testing::Test::HasFailure()) return;
    }
}

TEST(FCL_MOVING_KDOP_TREE, boxesContainDoubleFrames) { testContainment<double>(41); }
TEST(FCL_MOVING_KDOP_TREE, boxesContainFloatFrames) { testContainment<float>(42); }

/// Links of a binary tree over so many leaves, in the order of `leaves`.
/// @param balance  which part of a range goes to the left: 0, one leaf; 1, half; 2, any
std::vector<std::int32_t> binaryLinks(Random& random,
                                      const std::vector<std::int32_t>& leaves,
                                      int balance) {
  struct Open {
    std::size_t node, first, count;
  };
  std::vector<std::int32_t> links(1);
  std::vector<Open> open{{0, 0, leaves.size()}};
  while (!open.empty()) {
    const Open o = open.back();
    open.pop_back();
    if (o.count == 1) {
      links[o.node] = ~leaves[o.first];
      continue;
    }
    const std::size_t left = balance == 0   ? 1
                             : balance == 1 ? o.count / 2
                                            : 1 + random.index(o.count - 1);
    links[o.node] = static_cast<std::int32_t>(links.size());
    open.push_back({links.size(), o.first, left});
    open.push_back({links.size() + 1, o.first + left, o.count - left});
    links.resize(links.size() + 2);
  }
  return links;
}

TEST(FCL_MOVING_KDOP_TREE, structureOfABinaryTree) {
  constexpr std::uint64_t kSeed = 49;
  Random random(kSeed);
  for (int i = 0; i < 60; ++i) {
    SCOPED_TRACE("seed " + std::to_string(kSeed) + ", " + std::to_string(i));
    const std::size_t count = i < 20 ? static_cast<std::size_t>(i) + 1 : 150;
    const MovingMesh mesh = test::randomSoup(random, count, 2 * count + 3, 1, 0.3);
    const VertexFrames frames(mesh.previous(), mesh.current(), mesh.t0.size());
    const auto triangles =
        assignFeatures(mesh.triangles.data(), mesh.triangles.size(), mesh.t0.size());
    std::vector<std::int32_t> leaves(count);
    std::iota(leaves.begin(), leaves.end(), 0);
    for (std::size_t k = count; k > 1; --k)
      std::swap(leaves[k - 1], leaves[random.index(k)]);
    MovingKdopTree tree;
    tree.build(mesh.triangles.data(), count, mesh.t0.size(),
               binaryLinks(random, leaves, i % 3));
    tree.refit(frames);
    expectContainment(tree, triangles, frames);
    ASSERT_FALSE(HasFailure());
  }
}

// Nothing of a tree remains in one that is built in its place.
TEST(FCL_MOVING_KDOP_TREE, builtTwice) {
  Random random(50);
  MovingKdopTree tree;
  for (const std::size_t count : {1U, 700U, 8U, 9U, 64U, 65U, 2U, 600U, 3U}) {
    SCOPED_TRACE(count);
    const MovingMesh mesh = test::randomSoup(random, count, count + 3, 1, 0.3);
    const VertexFrames frames(mesh.previous(), mesh.current(), mesh.t0.size());
    const auto triangles =
        assignFeatures(mesh.triangles.data(), mesh.triangles.size(), mesh.t0.size());
    tree.build(mesh.triangles.data(), mesh.triangles.size(), frames);
    tree.refit(frames);
    expectContainment(tree, triangles, frames);
    MovingKdopTree other;
    other.build(mesh.triangles.data(), mesh.triangles.size(), frames);
    other.refit(frames);
    expectSameBoxes(tree, other);
    EXPECT_GT(tree.memUsage(), count * (sizeof(TreeTriangle) + 2 * sizeof(MovingKdop)));
  }
}

// Most lanes are in use: eight boxes are compared for the price of one.
TEST(FCL_MOVING_KDOP_TREE, nodesAreWellFilled) {
  Random random(51);
  for (const std::size_t count : {64U, 100U, 513U, 3000U, 20000U}) {
    const MovingMesh mesh = test::randomSoup(random, count, count, 1, 0.1);
    EXPECT_LE(PreparedMovingMesh(mesh).tree().numNodes(), count / 5) << count;
  }
}

/// Sheets in each other's way, and loose triangles, in any order.
MovingMesh scatteredSheets(Random& random, std::size_t count) {
  MovingMesh mesh;
  for (std::size_t i = 0; i < count; ++i) {
    const test::TestMesh sheet = test::makeSheet(1 + static_cast<int>(random.index(12)),
                                                 1 + static_cast<int>(random.index(12)));
    const std::size_t first = mesh.t0.size();
    const Vector3<double> at = random.point(random.index(3) ? 0.2 : 5);
    for (const auto& p : sheet.vertices) mesh.t0.push_back(p + at);
    for (const Triangle& t : sheet.triangles)
      mesh.triangles.emplace_back(t[0] + first, t[1] + first, t[2] + first);
  }
  const std::size_t num_loose = random.index(100);
  for (std::size_t i = 0; i < num_loose; ++i) {
    const std::size_t first = mesh.t0.size();
    for (int k = 0; k < 3; ++k) mesh.t0.push_back(random.point(1));
    mesh.triangles.emplace_back(first, first + 1, first + 2);
  }
  std::vector<std::size_t> order(mesh.t0.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  for (std::size_t k = order.size(); k > 1; --k)
    std::swap(order[k - 1], order[random.index(k)]);
  std::vector<Vector3<double>> points(mesh.t0.size());
  for (std::size_t i = 0; i < order.size(); ++i) points[order[i]] = mesh.t0[i];
  mesh.t0 = mesh.t1 = points;
  for (Triangle& t : mesh.triangles) t = {order[t[0]], order[t[1]], order[t[2]]};
  for (std::size_t k = mesh.triangles.size(); k > 1; --k)
    std::swap(mesh.triangles[k - 1], mesh.triangles[random.index(k)]);
  return mesh;
}

// A component of 64 triangles is what a node has below, and nothing else; all that are
// smaller are together.
TEST(FCL_MOVING_KDOP_TREE, largeComponentsHaveTreesOfTheirOwn) {
  constexpr std::uint64_t kSeed = 52;
  constexpr std::size_t kLarge = 64;
  Random random(kSeed);
  for (int i = 0; i < 40; ++i) {
    SCOPED_TRACE("seed " + std::to_string(kSeed) + ", " + std::to_string(i));
    const std::size_t count = i < 30 ? static_cast<std::size_t>(i) + 1 : 100;
    const MovingMesh mesh = scatteredSheets(random, count);
    const PreparedMovingMesh prepared(mesh);
    const MovingKdopTree& tree = prepared.tree();
    expectStructure(tree, assignFeatures(mesh.triangles.data(), mesh.triangles.size(),
                                         mesh.t0.size()));
    std::map<std::size_t, std::size_t> sizes;
    const auto of_vertex = test::componentsOf(mesh.triangles, mesh.t0.size());
    std::vector<std::size_t> component_of;
    for (const Triangle& t : mesh.triangles) component_of.push_back(of_vertex[t[0]]);
    for (const std::size_t c : component_of) ++sizes[c];
    // kSmall: one for all.
    const std::size_t kSmall = mesh.t0.size();
    for (std::size_t& c : component_of)
      if (sizes[c] < kLarge) c = kSmall;
    const std::set<std::size_t> groups(component_of.begin(), component_of.end());
    // In the tree's order each group is one run, and a node begins and ends with it.
    std::set<std::size_t> begun;
    const auto& triangles = tree.triangles();
    const auto groupAt = [&](std::size_t k) { return component_of[triangles[k].index]; };
    std::set<std::pair<std::size_t, std::size_t>> ranges;
    std::vector<std::size_t> size(tree.numNodes(), 0);
    for (std::size_t n = tree.numNodes(); n-- > 0;) {
      const MovingKdopNode& node = tree.node(static_cast<int>(n));
      for (int lane = 0; lane < node.count; ++lane) {
        if (node.isTriangle(lane)) {
          const auto t = static_cast<std::size_t>(node.triangle(lane));
          ranges.emplace(t, t + 1);
          ++size[n];
        } else {
          size[n] += size[static_cast<std::size_t>(node.child[lane])];
        }
      }
      const std::size_t first = tree.firstTriangle(static_cast<int>(n));
      ranges.emplace(first, first + size[n]);
    }
    for (std::size_t k = 0; k < triangles.size();) {
      const std::size_t first = k;
      while (k < triangles.size() && groupAt(k) == groupAt(first)) ++k;
      EXPECT_TRUE(begun.insert(groupAt(first)).second);
      EXPECT_TRUE(ranges.count({first, k})) << k - first << " triangles";
    }
    EXPECT_EQ(begun, groups);
    ASSERT_FALSE(HasFailure());
  }
}

// No box is larger than what it bounds needs: a vertex's is its rounded coordinates, a
// triangle's the largest of its vertices', a subtree's the largest of its children's.
TEST(FCL_MOVING_KDOP_TREE, boxesAreTheLeast) {
  constexpr std::uint64_t kSeed = 60;
  Random random(kSeed);
  for (const double size : {1., 1e-40, 1e30, 1e37, 1e38, 3e38, 1e300}) {
    SCOPED_TRACE("seed " + std::to_string(kSeed) + ", " + std::to_string(size));
    const MovingMesh mesh = test::randomSoup(random, 700, 500, size, size);
    const PreparedMovingMesh prepared(mesh);
    const MovingKdopTree& tree = prepared.tree();
    for (const TreeVertex& v : tree.vertices())
      for (int frame = 0; frame < 2; ++frame) {
        const double* p = frame ? v.t1 : v.t0;
        const Kdop16& box = frame ? v.box.t1 : v.box.t0;
        const double(&o)[3] = tree.origin(frame);
        const double offset[3] = {p[0] - o[0], p[1] - o[1], p[2] - o[2]};
        double d[8], farthest = 0;
        kdopCoordinates(offset, d);
        for (const double x : offset) farthest = std::max(farthest, std::abs(x));
        const float pad = offsetPad(farthest);
        for (int j = 0; j < 8; ++j) {
          ASSERT_EQ(box.half[j], roundUp(-d[j], pad));
          ASSERT_EQ(box.half[j + 8], roundUp(d[j], pad));
        }
      }
    const auto largest = [](const std::vector<MovingKdop>& boxes) {
      MovingKdop out = boxes[0];
      for (const MovingKdop& box : boxes)
        for (int j = 0; j < 16; ++j) {
          out.t0.half[j] = std::max(out.t0.half[j], box.t0.half[j]);
          out.t1.half[j] = std::max(out.t1.half[j], box.t1.half[j]);
        }
      return out;
    };
    for (int i = 0; i < static_cast<int>(tree.numNodes()); ++i)
      for (int lane = 0; lane < tree.node(i).count; ++lane) {
        const MovingKdopNode& node = tree.node(i);
        std::vector<MovingKdop> inside;
        if (node.isTriangle(lane))
          for (const auto& places : node.places)
            inside.push_back(tree.vertices()[places[lane]].box);
        else
          for (int k = 0; k < tree.node(node.child[lane]).count; ++k)
            inside.push_back(tree.node(node.child[lane]).box(k));
        const MovingKdop expected = largest(inside), box = node.box(lane);
        ASSERT_EQ(std::memcmp(&expected, &box, sizeof(box)), 0) << "node " << i;
      }
  }
}

TEST(FCL_MOVING_KDOP_TREE, boxOfWhatIsNotANumber) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const double origin[3] = {0, 0, 0}, point[3] = {1, kNan, 1};
  Kdop16 box;
  fitPoint(point, origin, 0.f, box);
  for (const int half : {1, 3, 5, 6, 9, 11, 13, 14})
    EXPECT_EQ(box.half[half], std::numeric_limits<float>::infinity()) << half;
  for (const int half : {0, 2, 4, 8, 10, 12}) EXPECT_LT(box.half[half], 3) << half;
}

/// Triangles at places of the x axis, each a point.
MovingMesh pointsAt(const std::vector<double>& places) {
  MovingMesh mesh;
  for (const double x : places) {
    for (int k = 0; k < 3; ++k) mesh.t0.emplace_back(x, 0, 0);
    const std::size_t n = mesh.t0.size();
    mesh.triangles.emplace_back(n - 3, n - 2, n - 1);
  }
  mesh.t1 = mesh.t0;
  return mesh;
}

// A few hundred triangles are halved exactly, however unevenly they lie: each node has
// all that lie between its ends, and the lowest nodes but the last are full.
TEST(FCL_MOVING_KDOP_TREE, halvesAreExact) {
  constexpr std::uint64_t kSeed = 61;
  Random random(kSeed);
  for (int shape = 0; shape < 5; ++shape)
    for (const std::size_t count : {9U, 64U, 65U, 200U, 511U, 512U}) {
      SCOPED_TRACE("seed " + std::to_string(kSeed) + ", shape " + std::to_string(shape) +
                   ", " + std::to_string(count));
      std::vector<double> places;
      for (std::size_t i = 0; i < count; ++i) {
        const double x = random.uniform(0, 1);
        places.push_back(shape == 0   ? x
                         : shape == 1 ? std::ldexp(x, static_cast<int>(i % 100))
                         : shape == 2 ? (i == 7 ? 1e30 : x)
                         : shape == 3 ? (i % 3 ? 1e-30 * x : x)
                                      : -std::ldexp(1, -static_cast<int>(i % 16)));
      }
      for (std::size_t i = count; i > 1; --i)
        std::swap(places[i - 1], places[random.index(i)]);
      const MovingMesh mesh = pointsAt(places);
      const PreparedMovingMesh prepared(mesh);
      const MovingKdopTree& tree = prepared.tree();
      expectStructure(tree, prepared.features());
      std::vector<double> sample;
      for (std::size_t i = 0; i < 31; ++i) sample.push_back(places[i * count / 31]);
      std::sort(sample.begin(), sample.end());
      // Lowest nodes, by their places on the axis.
      std::vector<std::pair<float, float>> ranges;
      std::size_t full = 0;
      for (int i = 0; i < static_cast<int>(tree.numNodes()); ++i) {
        const MovingKdopNode& node = tree.node(i);
        if (!node.isTriangle(0)) continue;
        full += node.count == MovingKdopNode::kWidth;
        std::pair<float, float> range(FLT_MAX, -FLT_MAX);
        for (int lane = 0; lane < node.count; ++lane) {
          const std::uint32_t t =
              tree.triangles()[static_cast<std::size_t>(node.triangle(lane))].index;
          // As the tree sees it: relative to a median, three vertices together.
          const auto x = static_cast<float>(places[t] - sample[15]);
          range.first = std::min(range.first, x + x + x);
          range.second = std::max(range.second, x + x + x);
        }
        ranges.push_back(range);
      }
      std::sort(ranges.begin(), ranges.end());
      EXPECT_EQ(full, count / MovingKdopNode::kWidth);
      for (std::size_t i = 1; i < ranges.size(); ++i)
        EXPECT_LE(ranges[i - 1].second, ranges[i].first);
    }
}

// The same tree wherever the mesh is.
TEST(FCL_MOVING_KDOP_TREE, structureFarFromTheOrigin) {
  constexpr std::uint64_t kSeed = 62;
  Random random(kSeed);
  MovingMesh mesh = test::crumpledSheet(random, 40, 0.1);
  for (auto& p : mesh.t0)
    for (int k = 0; k < 3; ++k) p[k] = std::ldexp(std::round(std::ldexp(p[k], 20)), -20);
  const PreparedMovingMesh here(mesh);
  MovingMesh moved = mesh;
  for (auto& p : moved.t0)
    for (int k = 0; k < 3; ++k) p[k] += std::ldexp(k + 1, 28);
  const PreparedMovingMesh there(moved);
  ASSERT_EQ(here.tree().triangles().size(), there.tree().triangles().size());
  for (std::size_t i = 0; i < here.tree().triangles().size(); ++i)
    ASSERT_EQ(here.tree().triangles()[i].index, there.tree().triangles()[i].index);
}

// A moved half-axis is not below the sum, nor above it by more than a few units of float.
TEST(FCL_MOVING_KDOP, shiftedHalvesAreNotBelowTheSum) {
  constexpr std::uint64_t kSeed = 65;
  Random random(kSeed);
  int rounded = 0;
  for (int i = 0; i < 100000; ++i) {
    // Sums of these are exact in doubles.
    const int exponent = static_cast<int>(random.index(230)) - 140;
    const auto number = [&] {
      return std::ldexp(static_cast<float>(random.uniform(-1, 1)),
                        exponent + static_cast<int>(random.index(28)));
    };
    const float half = number(), shift = number();
    const double sum = double{half} + double{shift};
    const auto moved = double{shifted(half, shift)};
    ASSERT_GE(moved, sum) << "seed " << kSeed << ", " << i;
    ASSERT_LE(moved, sum + std::abs(sum) * 0x1p-21 + 0x1p-149);
    rounded += double{half + shift} < sum;
  }
  EXPECT_GT(rounded, 10000);
  constexpr float kInf = std::numeric_limits<float>::infinity();
  EXPECT_EQ(shifted(kInf, kLeastHalf), kInf);
  EXPECT_EQ(shifted(kLeastHalf, kLeastHalf), kLeastHalf);
}

/// A box whose bounds are multiples of a power of two, so that the exact overlap below
/// is exact.
MovingKdop gridBox(Random& random, int exponent) {
  MovingKdop box;
  for (Kdop16* frame : {&box.t0, &box.t1})
    for (float& half : frame->half)
      half = std::ldexp(static_cast<float>(random.index(2000)) - 700, exponent);
  return box;
}

/// Whether the boxes overlap at t = k / 64.
bool doOverlapAt(const MovingKdop& a, const MovingKdop& b, int k) {
  for (int j = 0; j < 16; ++j)
    if (halfAt(a, j, k / 64.) + halfAt(b, (j + 8) % 16, k / 64.) < 0) return false;
  return true;
}

void expectNoMiss(const MovingKdop& a, const MovingKdop& b) {
  const TimeWindow w = overlapWindow<false>(a, b, nullptr);
  for (int k = 0; k <= 64; ++k)
    if (doOverlapAt(a, b, k)) {
      ASSERT_FALSE(w.isEmpty()) << "overlap at " << k << "/64";
      ASSERT_LE(w.lo, k / 64.);
      ASSERT_GE(w.hi, k / 64.);
    }
}

TEST(FCL_MOVING_KDOP, windowNeverMisses) {
  constexpr std::uint64_t kSeed = 43;
  Random random(kSeed);
  int windows = 0;
  for (int i = 0; i < 20000; ++i) {
    const int exponent = static_cast<int>(random.index(200)) - 100;
    MovingKdop a = gridBox(random, exponent), b = gridBox(random, exponent);
    // Most directions overlap all the time, else nearly no box would.
    for (int j = 0; j < 16; ++j)
      if (random.index(4)) {
        a.t0.half[j] = std::abs(a.t0.half[j]) + std::abs(b.t0.half[(j + 8) % 16]);
        a.t1.half[j] = std::abs(a.t1.half[j]) + std::abs(b.t1.half[(j + 8) % 16]);
      }
    ASSERT_NO_FATAL_FAILURE(expectNoMiss(a, b)) << "seed " << kSeed << ", " << i;
    // The window is no wider than rounding makes it.
    const TimeWindow w = overlapWindow<false>(a, b, nullptr);
    if (w.isEmpty()) continue;
    ++windows;
    double lo = 0, hi = 1;
    for (int j = 0; j < 16; ++j) {
      const double s0 = double{a.t0.half[j]} + double{b.t0.half[(j + 8) % 16]},
                   s1 = double{a.t1.half[j]} + double{b.t1.half[(j + 8) % 16]};
      if (s0 < 0) lo = std::max(lo, s0 / (s0 - s1));
      if (s1 < 0) hi = std::min(hi, s0 / (s0 - s1));
    }
    ASSERT_NEAR(w.lo, lo, 1e-6) << "seed " << kSeed << ", " << i;
    ASSERT_NEAR(w.hi, hi, 1e-6) << "seed " << kSeed << ", " << i;
  }
  EXPECT_GT(windows, 2000);
}

MovingKdop cube(float x0, float x1, float half) {
  MovingKdop box;
  std::fill(box.t0.half, box.t0.half + 16, half);
  box.t1 = box.t0;
  box.t0.half[0] = half - x0;
  box.t0.half[8] = half + x0;
  box.t1.half[0] = half - x1;
  box.t1.half[8] = half + x1;
  return box;
}

// Unbounded at one end of the step, far apart at the other: they may meet in between.
TEST(FCL_MOVING_KDOP, unboundedNeverSeparates) {
  const MovingKdop rest = cube(0, 0, 1);
  for (int j = 0; j < 16; ++j)
    for (const bool at_t0 : {true, false}) {
      SCOPED_TRACE("half-axis " + std::to_string(j) + (at_t0 ? " at 0" : " at 1"));
      MovingKdop box = cube(0, 0, 1);
      (at_t0 ? box.t0 : box.t1).half[j] = std::numeric_limits<float>::infinity();
      (at_t0 ? box.t1 : box.t0).half[j] = -99;
      expectNoMiss(box, rest);
      expectNoMiss(rest, box);
    }
}

/// A mesh as a query sees it, with its triangles as the user counts them.
struct Body {
  const MeshInstance& instance;
  std::vector<std::array<std::uint32_t, 3>> triangles;

  Body(const MeshInstance& i, const std::vector<Triangle>& of) : instance(i) {
    for (const Triangle& t : of)
      triangles.push_back({static_cast<std::uint32_t>(t[0]),
                           static_cast<std::uint32_t>(t[1]),
                           static_cast<std::uint32_t>(t[2])});
  }
  /// The user's number of a triangle as the tree counts.
  int index(int i) const {
    if (!instance.tree) return i;
    return static_cast<int>(
        instance.tree->triangles()[static_cast<std::size_t>(i)].index);
  }
};

using Visits = std::map<std::pair<int, int>, int>;

/// Whether the exact ranges of two triangles along the 8 directions meet at t.
bool doTrianglesOverlapAt(const Body& a, std::size_t i, const Body& b, std::size_t j,
                          double t) {
  long double lo[2][8], hi[2][8];
  const VertexPath first = a.instance.frames[a.triangles[i][0]];
  for (int side = 0; side < 2; ++side) {
    const Body& body = side ? b : a;
    const auto& triangle = body.triangles[side ? j : i];
    for (std::size_t c = 0; c < 3; ++c) {
      long double d[8];
      coordinatesAt(body.instance.frames[triangle[c]], t, first.t0, first.t0, d);
      for (int k = 0; k < 8; ++k) {
        lo[side][k] = c ? std::min(lo[side][k], d[k]) : d[k];
        hi[side][k] = c ? std::max(hi[side][k], d[k]) : d[k];
      }
    }
  }
  for (int k = 0; k < 8; ++k)
    if (lo[0][k] > hi[1][k] || lo[1][k] > hi[0][k]) return false;
  return true;
}

/// Calls visit with the tree to traverse.
template <typename Visit>
void withTree(const MeshInstance& mesh, Visit&& visit) {
  if (mesh.tree) {
    visit(*mesh.tree);
  } else {
    RigidTreeReader reader(mesh.rigid);
    visit(reader);
  }
}

Visits visitsOf(const Body& a, const Body& b, double latest = 1) {
  Visits visits;
  const bool self = &a == &b;
  const auto visit = [&](int i, int j, float earliest) {
    EXPECT_GE(earliest, 0);
    EXPECT_LE(earliest, latest);
    const int k = a.index(i), l = b.index(j);
    ++visits[self && l < k ? std::make_pair(l, k) : std::make_pair(k, l)];
  };
  const KdopShift shift = relativeShift(a.instance, b.instance);
  withTree(a.instance, [&](auto& tree_a) {
    withTree(b.instance, [&](auto& tree_b) {
      if constexpr (std::is_same_v<decltype(tree_a), decltype(tree_b)>)
        if (self) {
          test::traverse<true>(tree_a, tree_b, nullptr, visit, latest);
          return;
        }
      test::traverse<false>(tree_a, tree_b, &shift, visit, latest);
    });
  });
  return visits;
}

/// Every pair that overlaps at a time up to latest is visited, none twice.
/// @return number of pairs that had to be visited
int expectVisits(const Body& a, const Body& b, double latest = 1) {
  const Visits visits = visitsOf(a, b, latest);
  for (const auto& [pair, times] : visits) {
    EXPECT_EQ(times, 1);
    EXPECT_TRUE(&a != &b || pair.first != pair.second);
  }
  int needed = 0;
  for (std::size_t i = 0; i < a.triangles.size(); ++i)
    for (std::size_t j = &a == &b ? i + 1 : 0; j < b.triangles.size(); ++j)
      for (const double t : kTimes)
        if (t <= latest && doTrianglesOverlapAt(a, i, b, j, t)) {
          ++needed;
          EXPECT_TRUE(visits.count({static_cast<int>(i), static_cast<int>(j)}))
              << i << " and " << j << " overlap at " << t;
          break;
        }
  return needed;
}

/// A mesh with a moving tree.
struct MovingBody : PreparedMovingMesh {
  Body body;

  explicit MovingBody(const MovingMesh& mesh, const Pose& beginning = Pose(),
                      const Pose& end = Pose())
      : PreparedMovingMesh(mesh, beginning, end), body(instance(), mesh.triangles) {}
};

TEST(FCL_MOVING_KDOP_TREE, traversalVisitsEveryOverlap) {
  constexpr std::uint64_t kSeed = 44;
  Random random(kSeed);
  int needed = 0;
  for (int i = 0; i < 20; ++i) {
    SCOPED_TRACE("seed " + std::to_string(kSeed) + ", " + std::to_string(i));
    const MovingMesh a = i % 2 ? test::crumpledSheet(random, 5, 0.3)
                               : test::randomSoup(random, 40, 120, 3, 0.5);
    const MovingMesh b = test::crumpledSheet(random, 4, 0.5);
    const MovingBody pa(a), pb(b);
    for (const double latest : {1., 0.5, 0.}) {
      needed += expectVisits(pa.body, pa.body, latest);
      needed += expectVisits(pa.body, pb.body, latest);
    }
    const std::size_t all = visitsOf(pa.body, pa.body).size();
    EXPECT_LT(all, a.triangles.size() * (a.triangles.size() - 1) / 2);
    EXPECT_LE(visitsOf(pa.body, pa.body, 0).size(), all);
  }
  EXPECT_GT(needed, 10000);
}

/// A binary tree, as MovingKdopTree::build() takes it, that makes a root of eight
/// children: nodes of eight triangles, then single triangles.
std::vector<std::int32_t> rootOfNodesAndTriangles(unsigned num_nodes) {
  std::vector<std::int32_t> links(1);
  std::int32_t next = 0;
  const std::function<void(std::size_t, unsigned, unsigned)> fill =
      [&](std::size_t node, unsigned depth, unsigned lane) {
        const unsigned leaf_depth = depth >= 3 && lane % 8 < num_nodes ? 6 : 3;
        if (depth >= leaf_depth) {
          links[node] = ~next++;
          return;
        }
        const std::size_t left = links.size();
        links.resize(left + 2);
        links[node] = static_cast<std::int32_t>(left);
        // Lanes are filled level by level: the first turn is the lowest bit.
        fill(left, depth + 1, lane);
        fill(left + 1, depth + 1, lane | 1U << depth);
      };
  fill(0, 0, 0);
  return links;
}

// No step finds more pairs than a query has room for, and one finds as many.
TEST(FCL_MOVING_KDOP_TREE, pairsOfAStep) {
  using SelfTraversal =
      deformable::Traversal<true, const MovingKdopTree, const MovingKdopTree>;
  std::size_t most = 0;
  for (unsigned num_nodes = 0; num_nodes <= 8; ++num_nodes) {
    const std::size_t count = 8 + 7 * num_nodes;
    MovingMesh mesh;  // all triangles in one place
    for (std::size_t i = 0; i < count; ++i) {
      mesh.triangles.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
      for (const Vector3<double>& p :
           {Vector3<double>(0, 0, 0), Vector3<double>(1, 0, 0), Vector3<double>(0, 1, 0)})
        mesh.t0.push_back(p);
    }
    mesh.t1 = mesh.t0;
    MovingKdopTree tree;
    tree.build(mesh.triangles.data(), count, mesh.t0.size(),
               rootOfNodesAndTriangles(num_nodes));
    tree.refit(VertexFrames(mesh.previous(), mesh.current(), mesh.t0.size()));
    ASSERT_EQ(tree.node(0).count, 8);
    ASSERT_EQ(tree.node(0).triangles, 0xffU & (0xffU << num_nodes));
    SelfTraversal traversal(tree, tree, nullptr, deformable::SelfCulling(), nullptr,
                            deformable::kernels(), false);
    deformable::WorkList open;
    traversal.start(open);
    std::size_t all = 0;
    while (open.size() > 0) {
      const deformable::NodePair work = open[open.size() - 1];
      open.cut(open.size() - 1);
      std::size_t found = 0;
      traversal.step(work, open, [&found](int, int, float) { ++found; });
      EXPECT_LE(found, SelfTraversal::maxPairs());
      most = std::max(most, found);
      all += found;
    }
    EXPECT_EQ(all, count * (count - 1) / 2);
  }
  EXPECT_EQ(most, SelfTraversal::maxPairs());
}

// Trees of every small size, where nodes are full, nearly empty or mixed.
TEST(FCL_MOVING_KDOP_TREE, traversalOfSmallTrees) {
  constexpr std::uint64_t kSeed = 52;
  Random random(kSeed);
  const MovingMesh other = test::randomSoup(random, 11, 30, 1, 0.5);
  const MovingBody po(other);
  for (std::size_t count = 1; count < 80; ++count) {
    SCOPED_TRACE("seed " + std::to_string(kSeed) + ", " + std::to_string(count));
    const MovingMesh mesh = test::randomSoup(random, count, 3 * count, 1, 0.5);
    const MovingBody p(mesh);
    expectVisits(p.body, p.body);
    expectVisits(p.body, po.body);
    expectVisits(po.body, p.body, 0.5);
    ASSERT_FALSE(HasFailure());
  }
}

/// FCL's own tree, read as one of eight children a node.
template <typename BV>
void expectVisitsOfRigidTrees(std::uint64_t seed) {
  using S = typename BV::S;
  Random random(seed);
  int needed = 0;
  for (int i = 0; i < 6; ++i) {
    SCOPED_TRACE("seed " + std::to_string(seed) + ", " + std::to_string(i));
    const test::TestMesh sheet = test::floatMesh(test::makeSheet(5, 4)),
                         soup = test::floatMesh(
                             test::makeTriangleSoup(i % 2 ? 60 : 3, 0.6, 0.3, seed + 1));
    const auto model_a = test::makeModel<BVHModel<BV>>(sheet),
               model_b = test::makeModel<BVHModel<BV>>(soup);
    const auto random_pose = [&](const Matrix3<S>& rotation) {
      Transform3<S> tf = Transform3<S>::Identity();
      tf.linear() = rotation;
      tf.translation() = random.point(0.5).cast<S>();
      return tf;
    };
    const Matrix3<S> turned = AngleAxis<S>(static_cast<S>(random.uniform(0, 3)),
                                           random.point(1).cast<S>().normalized())
                                  .toRotationMatrix();
    const Matrix3<S> rotation = i < 3 ? Matrix3<S>(Matrix3<S>::Identity()) : turned;
    const test::PlacedMesh pa(*model_a, random_pose(rotation), random_pose(rotation),
                              "a"),
        pb(*model_b, random_pose(turned), random_pose(turned), "b");
    ASSERT_EQ(pa.instance().tree, nullptr);
    ASSERT_EQ(pb.instance().tree, nullptr);
    const Body a(pa.instance(), sheet.triangles), b(pb.instance(), soup.triangles);
    const MovingMesh mesh = test::crumpledSheet(random, 4, 0.3);
    Pose poses[2];
    for (Pose& pose : poses) pose.translation[2] = random.uniform(-0.3, 0.3);
    const MovingBody c(mesh, poses[0], poses[1]);
    for (const double latest : {1., 0.5, 0.}) {
      needed += expectVisits(a, b, latest);
      needed += expectVisits(b, a, latest);
      needed += expectVisits(a, a, latest);
      needed += expectVisits(a, c.body, latest);
      needed += expectVisits(c.body, b, latest);
    }
    EXPECT_LT(visitsOf(a, a).size(),
              a.triangles.size() * (a.triangles.size() - 1) * 2 / 5);
    EXPECT_LT(visitsOf(a, c.body).size(), a.triangles.size() * c.body.triangles.size());
    ASSERT_FALSE(testing::Test::HasFailure());
  }
  EXPECT_GT(needed, 3000);
}

TEST(FCL_MOVING_KDOP_TREE, traversalOfRigidTrees) {
  expectVisitsOfRigidTrees<AABB<double>>(53);
  expectVisitsOfRigidTrees<OBB<double>>(54);
  expectVisitsOfRigidTrees<KDOP<double, 16>>(55);
  expectVisitsOfRigidTrees<KDOP<float, 24>>(56);
  expectVisitsOfRigidTrees<OBBRSS<float>>(57);
  expectVisitsOfRigidTrees<kIOS<double>>(58);
}

TEST(FCL_MOVING_KDOP_TREE, oneTriangleAndNothingToVisit) {
  MovingMesh mesh;
  mesh.t0 = mesh.t1 = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}};
  const MovingBody one(mesh), other(mesh);
  EXPECT_TRUE(visitsOf(one.body, one.body).empty());
  EXPECT_EQ(visitsOf(one.body, other.body).size(), 1U);
}

TEST(FCL_MOVING_KDOP_TREE, treesFarFromEachOthersOrigin) {
  constexpr std::uint64_t kSeed = 45;
  Random random(kSeed);
  for (const double far : {0., 1e3, 1e6, 1e9, 1e15})
    for (const double size : {1e-3, 1., 1e5}) {
      SCOPED_TRACE("seed " + std::to_string(kSeed) + ", " + std::to_string(far) + ", " +
                   std::to_string(size));
      MovingMesh a = test::crumpledSheet(random, 4, 0.4);
      MovingMesh b = test::crumpledSheet(random, 5, 0.4);
      Pose pose_a[2], pose_b[2];
      for (int k = 0; k < 3; ++k) {
        // a is there by its pose, b by half its pose and half its coordinates.
        for (int frame = 0; frame < 2; ++frame) {
          pose_a[frame].translation[k] = far * (k + 1);
          pose_b[frame].translation[k] = 0.5 * far * (k + 1) + (frame ? 0.1 * size : 0);
        }
        for (auto* points : {&a.t0, &a.t1})
          for (auto& p : *points) p[k] *= size;
        for (auto* points : {&b.t0, &b.t1})
          for (auto& p : *points) p[k] = size * p[k] + 0.5 * far * (k + 1);
      }
      const MovingBody pa(a, pose_a[0], pose_a[1]), pb(b, pose_b[0], pose_b[1]);
      EXPECT_GT(expectVisits(pa.body, pb.body), 100);
      EXPECT_GT(expectVisits(pb.body, pa.body), 100);
      // Not by giving up: most pairs are still culled where floats can tell them apart.
      if (far <= 1e6 * size) {
        EXPECT_LT(visitsOf(pa.body, pb.body).size(),
                  a.triangles.size() * b.triangles.size() * 3 / 4);
      }
    }
}

/// Widths of the triangles' boxes along all directions in both frames, and how much of
/// them comes from rounding; without those of triangles with vertices that are
/// `left_out`.
struct Widths {
  double all{0}, rounded{0};

  Widths(const MovingKdopTree& tree, const std::vector<std::uint32_t>& left_out) {
    const auto isLeftOut = [&left_out](std::uint32_t id) {
      return std::find(left_out.begin(), left_out.end(), id) != left_out.end();
    };
    for (int i = 0; i < static_cast<int>(tree.numNodes()); ++i)
      for (int lane = 0; lane < tree.node(i).count; ++lane) {
        if (!tree.node(i).isTriangle(lane)) continue;
        const TreeTriangle& triangle =
            tree.triangles()[static_cast<std::size_t>(tree.node(i).triangle(lane))];
        if (std::any_of(triangle.id, triangle.id + 3, isLeftOut)) continue;
        add(tree, triangle, tree.node(i).box(lane));
      }
  }

 private:
  void add(const MovingKdopTree& tree, const TreeTriangle& triangle,
           const MovingKdop& box) {
    for (int frame = 0; frame < 2; ++frame) {
      double d[3][8];
      for (std::size_t k = 0; k < 3; ++k) {
        const TreeVertex& v = tree.vertices()[triangle.place[k]];
        const double* p = frame ? v.t1 : v.t0;
        kdopCoordinates({p[0], p[1], p[2]}, d[k]);
      }
      const Kdop16& half = frame ? box.t1 : box.t0;
      for (int j = 0; j < 8; ++j) {
        const double width =
            std::max({d[0][j], d[1][j], d[2][j]}) - std::min({d[0][j], d[1][j], d[2][j]});
        all += width;
        rounded += double{half.half[j]} + double{half.half[j + 8]} - width;
      }
    }
  }
};

// However far some vertices fly, and wherever the whole jumps, the boxes of what stays
// are no wider by more than an eighth, whichever vertices these are; nor do they depend
// on the order of the vertices.
TEST(FCL_MOVING_KDOP_TREE, whatFliesOffBlursNothingElse) {
  constexpr std::uint64_t kSeed = 64;
  Random random(kSeed);
  const MovingMesh sheet = test::crumpledSheet(random, 20, 0.05);
  const auto count = static_cast<std::uint32_t>(sheet.t0.size());
  for (const double far : {10., 1e3, 1e5, 1e7, 1e9, 1e20, 1e37, 1e39, 1e100, 1e307})
    for (int i = 0; i < 12; ++i) {
      SCOPED_TRACE("seed " + std::to_string(kSeed) + ", " + std::to_string(far) + ", " +
                   std::to_string(i));
      MovingMesh mesh = sheet;
      // The first one, one, or several that fly apart; in one frame, or in both.
      std::vector<std::uint32_t> flying(i % 3 == 2 ? 5 : 1);
      for (auto& id : flying)
        id = i % 3 == 0 ? 0 : static_cast<std::uint32_t>(random.index(count));
      for (const std::uint32_t id : flying) {
        const Vector3<double> away = far * random.point(1);
        if (i / 3 % 3 != 0) mesh.t0[id] += away;
        if (i / 3 % 3 != 1) mesh.t1[id] += away;
      }
      const Vector3<double> jump = far * random.point(1);
      if (i >= 9 && far < 1e6)
        for (auto& p : mesh.t1) p += jump;
      const PreparedMovingMesh prepared(mesh);
      const MovingKdopTree& tree = prepared.tree();
      const Widths widths(tree, flying);
      EXPECT_LT(widths.rounded, widths.all / 8);
      for (const TreeVertex& v : tree.vertices())
        for (int k = 0; k < 3; ++k) {
          EXPECT_LE(std::abs(v.t0[k] - tree.origin(0)[k]), tree.reach());
          EXPECT_LE(std::abs(v.t1[k] - tree.origin(1)[k]), tree.reach());
        }

      MovingMesh reversed = mesh;
      std::reverse(reversed.t0.begin(), reversed.t0.end());
      std::reverse(reversed.t1.begin(), reversed.t1.end());
      for (Triangle& t : reversed.triangles)
        for (int k = 0; k < 3; ++k) t[k] = count - 1 - t[k];
      expectSameBoxes(PreparedMovingMesh(reversed).tree(), tree);
    }
}

int depthOf(const MovingKdopTree& tree, int i = 0) {
  const MovingKdopNode& node = tree.node(i);
  int below = 0;
  for (int lane = 0; lane < node.count; ++lane)
    if (!node.isTriangle(lane)) below = std::max(below, depthOf(tree, node.child[lane]));
  return 1 + below;
}

// 24 levels by area at most, and then as many as halves need.
TEST(FCL_MOVING_KDOP_TREE, depthIsBounded) {
  Random random(46);
  constexpr std::size_t kCount = 20000;
  for (int shape = 0; shape < 5; ++shape) {
    SCOPED_TRACE(shape);
    MovingMesh mesh;
    for (std::size_t i = 0; i < kCount; ++i) {
      const double x = shape == 0   ? 0  // all centroids the same
                       : shape == 1 ? std::ldexp(1, static_cast<int>(i % 250) - 125)
                       : shape == 2 ? std::pow(1.0075, static_cast<double>(i)) * 1e-30
                       : shape == 3 ? 1e300 * random.uniform(-1, 1)
                                    // all but 40 the same
                                    : std::ldexp(i < 40 ? 1 : 0, static_cast<int>(i));
      for (int k = 0; k < 3; ++k) {
        mesh.t0.emplace_back(x, shape == 3 ? x : 0, 0);
        mesh.t1.emplace_back(x, 0, 1);
      }
      mesh.triangles.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
    }
    const PreparedMovingMesh prepared(mesh);
    expectStructure(prepared.tree(), prepared.features());
    EXPECT_LE(depthOf(prepared.tree()), 24 + 5);
    EXPECT_GE(depthOf(prepared.tree()), 5);
    if (shape == 0) {
      EXPECT_EQ(depthOf(prepared.tree()), 5);
    }
  }
}

// Beyond float's range a box is unbounded, and everything has to be visited.
TEST(FCL_MOVING_KDOP_TREE, coordinatesBeyondFloat) {
  constexpr std::uint64_t kSeed = 47;
  Random random(kSeed);
  for (const double size : {1e36, 1e37, 1e38, 2e38, 1e39, 1e45, 1e53, 1e60, 1e300}) {
    SCOPED_TRACE("seed " + std::to_string(kSeed) + ", " + std::to_string(size));
    const MovingMesh a = test::randomSoup(random, 25, 60, size, size);
    const MovingMesh b = test::randomSoup(random, 15, 40, size, 0.1 * size);
    const MovingBody pa(a), pb(b);
    const std::size_t n = a.triangles.size(), m = b.triangles.size();
    EXPECT_GT(expectVisits(pa.body, pa.body), 10);
    EXPECT_GT(expectVisits(pa.body, pb.body), 10);
    if (size > 1e60) {
      EXPECT_EQ(visitsOf(pa.body, pa.body).size(), n * (n - 1) / 2);
      EXPECT_EQ(visitsOf(pa.body, pb.body).size(), n * m);
    }
  }
}

// Two triangles that touch at t = 0, where no float bounds them, and are apart at t = 1,
// where floats do.
TEST(FCL_MOVING_KDOP_TREE, unboundedInOneFrame) {
  MovingMesh mesh;
  for (const double side : {-1., 1.}) {
    for (int k = 0; k < 3; ++k) {
      mesh.t0.emplace_back(-1e45, k == 1 ? 1e36 : 0, k == 2 ? 1e36 : 0);
      mesh.t1.emplace_back(side * 1e36, k == 1 ? 1e36 : 0, k == 2 ? 1e36 : 0);
    }
  }
  mesh.t0.emplace_back(1e45, 0, 0);  // keeps the origin at 0
  mesh.t1.emplace_back(1e45, 0, 0);
  mesh.triangles = {{0, 1, 2}, {3, 4, 5}};
  const MovingBody prepared(mesh);
  EXPECT_EQ(expectVisits(prepared.body, prepared.body), 1);
}

/// Runs a self-query in the mode set by the caller, whose control word must survive.
QueryAnswer answerOf(const MeshInstance& mesh) {
  QueryOptions options;
  options.toc_err = 1e-7;
#ifdef __SSE__
  const unsigned before = _mm_getcsr();
#endif
  const int rounding = std::fegetround();
  QueryAnswer answer = querySelf(mesh, options);
#ifdef __SSE__
  EXPECT_EQ(_mm_getcsr(), before);
#endif
  EXPECT_EQ(std::fegetround(), rounding);
  return answer;
}

void expectSameAnswer(const QueryAnswer& x, const QueryAnswer& y) {
  EXPECT_EQ(x.hasCrossing(), y.hasCrossing());
  EXPECT_EQ(x.counts.feature_pairs, y.counts.feature_pairs);
  EXPECT_EQ(x.counts.exact_tests, y.counts.exact_tests);
  ASSERT_EQ(x.contacts.size(), y.contacts.size());
  for (std::size_t i = 0; i < x.contacts.size(); ++i) {
    EXPECT_EQ(x.contacts[i].toc_lo, y.contacts[i].toc_lo);
    EXPECT_EQ(x.contacts[i].toc_hi, y.contacts[i].toc_hi);
    for (int k = 0; k < 4; ++k)
      EXPECT_EQ(x.contacts[i].vertices[k], y.contacts[i].vertices[k]);
  }
}

TEST(FCL_MOVING_KDOP_TREE, callersFloatingPointModeDoesNotMatter) {
  constexpr std::uint64_t kSeed = 48;
  Random random(kSeed);
  for (const double scale : {1., 1e-160, 1e-307}) {
    MovingMesh mesh = test::crumpledSheet(random, 6, 0.5);
    for (auto* points : {&mesh.t0, &mesh.t1})
      for (auto& p : *points) p *= scale;
    const PreparedMovingMesh prepared(mesh);
    const QueryAnswer normal = answerOf(prepared.instance());
    EXPECT_GT(normal.contacts.size(), 20U) << "seed " << kSeed;
    for (const int mode : {FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO}) {
      std::fesetround(mode);
      const QueryAnswer answer = answerOf(prepared.instance());
      std::fesetround(FE_TONEAREST);
      expectSameAnswer(answer, normal);
    }
#ifdef __SSE__
    const unsigned csr = _mm_getcsr();
    _mm_setcsr(csr | 0x8040);  // flush to zero, denormals are zero
    const QueryAnswer answer = answerOf(prepared.instance());
    _mm_setcsr(csr);
    expectSameAnswer(answer, normal);
#endif
  }
}

}  // namespace
}  // namespace deformable
}  // namespace detail
}  // namespace fcl
