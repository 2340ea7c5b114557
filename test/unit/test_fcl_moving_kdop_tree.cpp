// SPDX-License-Identifier: BSD-3-Clause
//
// The moving tree: its structure, and that its boxes contain everything below them at
// every time.
#include "tree/moving_kdop_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cfenv>
#include <cfloat>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <map>
#include <numeric>
#include <set>
#include <string>
#include <utility>
#include <vector>
#ifdef __SSE__
#include <xmmintrin.h>
#endif

#include "components.h"
#include "moving_mesh.h"
#include "offset_pad.h"
#include "prepare/prepared_mesh.h"
#include "query/deformable_query.h"
#include "test_models.h"
#include "tree/box_position.h"
#include "tree_checks.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

using test::expectContainment;
using test::expectSameBoxes;
using test::expectStructure;
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
      // The frames exchanged, and then the first ones again.
      const VertexFrames back(t1.data(), t0.data(), mesh.t0.size());
      tree.refit(back);
      expectContainment(tree, triangles, back);
      tree.refit(frames);
      expectSameBoxes(tree, before);
      // One array for both frames gives the same as two equal ones.
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

/// Links of a binary tree over a number of leaves, in the order of `leaves`.
/// @param balance  the part of a range that goes to the left: 0, one leaf; 1, half; 2,
/// any
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

// A tree that is built in place of another one has nothing of it.
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
    EXPECT_GT(tree.memUsage(), count * (sizeof(TreeTriangle) +
                                        2 * sizeof(detail::deformable::MovingKdop)));
  }
}

// Most lanes are in use, since a comparison with eight boxes costs as much as with one.
TEST(FCL_MOVING_KDOP_TREE, nodesAreWellFilled) {
  Random random(51);
  for (const std::size_t count : {64U, 100U, 513U, 3000U, 20000U}) {
    const MovingMesh mesh = test::randomSoup(random, count, count, 1, 0.1);
    EXPECT_LE(PreparedMovingMesh(mesh).tree().numNodes(), count / 5) << count;
  }
}

/// Sheets that overlap each other, and loose triangles, in any order.
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

// A component of 64 or more triangles has a node of its own, with nothing else below it.
// All smaller components are together.
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
    // kSmall is one group for all small components.
    const std::size_t kSmall = mesh.t0.size();
    for (std::size_t& c : component_of)
      if (sizes[c] < kLarge) c = kSmall;
    const std::set<std::size_t> groups(component_of.begin(), component_of.end());
    // In the tree's order the triangles of each group follow each other, and a node
    // begins and ends with them.
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

// No box is larger than necessary: the box of a vertex is its rounded coordinates, that
// of a triangle the largest of its vertices', that of a subtree the largest of its
// children's.
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
        const detail::deformable::Kdop16& box = frame ? v.box.t1 : v.box.t0;
        const double(&o)[3] = tree.origin(frame);
        const double offset[3] = {p[0] - o[0], p[1] - o[1], p[2] - o[2]};
        double d[8], farthest = 0;
        kdopCoordinates(offset, d);
        for (const double x : offset) farthest = std::max(farthest, std::abs(x));
        const float pad = test::offsetPad(farthest);
        for (int j = 0; j < 8; ++j) {
          ASSERT_EQ(box.half[j], roundUp(-d[j], pad));
          ASSERT_EQ(box.half[j + 8], roundUp(d[j], pad));
        }
      }
    const auto largest = [](const std::vector<detail::deformable::MovingKdop>& boxes) {
      detail::deformable::MovingKdop out = boxes[0];
      for (const detail::deformable::MovingKdop& box : boxes)
        for (int j = 0; j < 16; ++j) {
          out.t0.half[j] = std::max(out.t0.half[j], box.t0.half[j]);
          out.t1.half[j] = std::max(out.t1.half[j], box.t1.half[j]);
        }
      return out;
    };
    for (int i = 0; i < static_cast<int>(tree.numNodes()); ++i)
      for (int lane = 0; lane < tree.node(i).count; ++lane) {
        const MovingKdopNode& node = tree.node(i);
        std::vector<detail::deformable::MovingKdop> inside;
        if (node.isTriangle(lane))
          for (const auto& places : node.places)
            inside.push_back(tree.vertices()[places[lane]].box);
        else
          for (int k = 0; k < tree.node(node.child[lane]).count; ++k)
            inside.push_back(tree.node(node.child[lane]).box(k));
        const detail::deformable::MovingKdop expected = largest(inside),
                                             box = node.box(lane);
        ASSERT_EQ(std::memcmp(&expected, &box, sizeof(box)), 0) << "node " << i;
      }
  }
}

TEST(FCL_MOVING_KDOP_TREE, boxOfWhatIsNotANumber) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const double origin[3] = {0, 0, 0}, point[3] = {1, kNan, 1};
  detail::deformable::Kdop16 box;
  fitPoint(point, origin, 0.f, box);
  for (const int half : {1, 3, 5, 6, 9, 11, 13, 14})
    EXPECT_EQ(box.half[half], std::numeric_limits<float>::infinity()) << half;
  for (const int half : {0, 2, 4, 8, 10, 12}) EXPECT_LT(box.half[half], 3) << half;
}

/// Triangles at positions on the x axis. Each triangle is a point.
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

// A few hundred triangles are halved exactly, for any distribution. Each node has all
// triangles between its ends, and the lowest nodes but the last are full.
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
      // The lowest nodes by their positions on the axis.
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
          // The number that the tree uses: relative to a median, the sum of three
          // vertices.
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

// The tree is the same wherever the mesh is.
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

/// The sum of the widths of the triangles' boxes along all directions in both frames, and
/// the part of it that comes from rounding. Triangles with vertices that are `left_out`
/// do not count.
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
           const detail::deformable::MovingKdop& box) {
    for (int frame = 0; frame < 2; ++frame) {
      double d[3][8];
      for (std::size_t k = 0; k < 3; ++k) {
        const TreeVertex& v = tree.vertices()[triangle.place[k]];
        const double* p = frame ? v.t1 : v.t0;
        kdopCoordinates({p[0], p[1], p[2]}, d[k]);
      }
      const detail::deformable::Kdop16& half = frame ? box.t1 : box.t0;
      for (int j = 0; j < 8; ++j) {
        const double width =
            std::max({d[0][j], d[1][j], d[2][j]}) - std::min({d[0][j], d[1][j], d[2][j]});
        all += width;
        rounded += double{half.half[j]} + double{half.half[j + 8]} - width;
      }
    }
  }
};

// Some vertices fly away, however far, or the whole mesh jumps. The boxes of the other
// triangles become wider by at most an eighth, whichever vertices fly. They do not depend
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
      // The first vertex, another one, or several that fly apart, in one frame or in
      // both.
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
          EXPECT_LE(std::abs(v.t0[k] - tree.origin(0)[k]), tree.largestCoordinate());
          EXPECT_LE(std::abs(v.t1[k] - tree.origin(1)[k]), tree.largestCoordinate());
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

/// Runs a self-query in the floating-point mode of the caller, whose control word must
/// not change.
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
