// SPDX-License-Identifier: BSD-3-Clause
//
// Properties of every moving tree: its structure, and that its boxes contain everything
// below them.
#ifndef FCL_TEST_SUPPORT_TREE_CHECKS_H
#define FCL_TEST_SUPPORT_TREE_CHECKS_H

#include <gtest/gtest.h>

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "real.h"
#include "sanitizer.h"
#include "tree/border_finder.h"
#include "tree/moving_kdop_tree.h"

namespace fcl {
namespace test {

using detail::deformable::BorderFinder;
using detail::deformable::kLeastHalf;
using detail::deformable::MeshTriangle;
using detail::deformable::MovingKdopNode;
using detail::deformable::MovingKdopTree;
using detail::deformable::RegionBorder;
using detail::deformable::regionOf;
using detail::deformable::TreeTriangle;
using detail::deformable::TreeVertex;
using detail::deformable::VertexFan;
using detail::deformable::VertexFans;
using detail::deformable::VertexFrames;
using detail::deformable::VertexPath;

constexpr double kTimes[] = {0, 1e-9, 0.125, 1. / 3, 0.5, 0.7, 0.9375, 1};

/// The 8 coordinates of a vertex at t, relative to origins of both frames, in Real.
inline void coordinatesAt(const VertexPath& p, double t, const double (&origin0)[3],
                          const double (&origin1)[3], Real (&d)[8]) {
  Real x[3];
  for (int k = 0; k < 3; ++k)
    x[k] = (1 - Real{t}) * (Real{p.t0[k]} - origin0[k]) +
           Real{t} * (Real{p.t1[k]} - origin1[k]);
  const Real all[8] = {x[0],        x[1],        x[2],        x[0] + x[1],
                       x[0] + x[2], x[1] + x[2], x[0] - x[1], x[0] - x[2]};
  std::copy(all, all + 8, d);
}

/// The bound of half-axis j at t; infinity at one end means no bound.
inline Real halfAt(const detail::deformable::MovingKdop& box, int j, double t) {
  constexpr float kInf = std::numeric_limits<float>::infinity();
  const float half0 = box.t0.half[j], half1 = box.t1.half[j];
  if (half0 == kInf || half1 == kInf) return kInf;
  return (1 - Real{t}) * half0 + Real{t} * half1;
}

/// The parent of a node, and the node's lane there.
struct Place {
  int node{-1};
  int lane{0};
};

/// Every triangle is met once. Children come after their parents. Triangles and vertices
/// have the order in which the tree meets them, and the data of the user's. Unused lanes
/// overlap nothing.
/// @return the place of each node
inline std::vector<Place> expectStructure(const MovingKdopTree& tree,
                                          const std::vector<MeshTriangle>& triangles) {
  const int count = static_cast<int>(tree.numNodes());
  std::vector<Place> parent(tree.numNodes());
  std::vector<int> met(triangles.size(), 0);
  for (int i = 0; i < count; ++i) {
    const MovingKdopNode& node = tree.node(i);
    EXPECT_GE(node.count, 1);
    EXPECT_LE(node.count, MovingKdopNode::kWidth);
    EXPECT_TRUE(i == 0 || parent[static_cast<std::size_t>(i)].node >= 0) << "no parent";
    for (int lane = 0; lane < node.count; ++lane) {
      if (node.isTriangle(lane)) {
        ++met.at(static_cast<std::size_t>(node.triangle(lane)));
        continue;
      }
      EXPECT_GT(node.child[lane], i);
      Place& place = parent.at(static_cast<std::size_t>(node.child[lane]));
      EXPECT_EQ(place.node, -1) << "two parents";
      place = {i, lane};
    }
    for (int lane = node.count; lane < MovingKdopNode::kWidth; ++lane) {
      const detail::deformable::MovingKdop box = node.box(lane);
      for (int j = 0; j < 16; ++j) {
        EXPECT_EQ(box.t0.half[j], kLeastHalf);
        EXPECT_EQ(box.t1.half[j], kLeastHalf);
      }
    }
  }
  for (const int times : met) EXPECT_EQ(times, 1);

  // The order of a walk, with a node's own triangles before its subtrees.
  int next = 0;
  std::vector<int> open{0};
  while (!open.empty()) {
    const MovingKdopNode& node = tree.node(open.back());
    EXPECT_EQ(tree.firstTriangle(open.back()), static_cast<std::uint32_t>(next));
    open.pop_back();
    for (int lane = node.count; lane-- > 0;)
      if (!node.isTriangle(lane)) open.push_back(node.child[lane]);
    for (int lane = 0; lane < node.count; ++lane)
      if (node.isTriangle(lane)) {
        EXPECT_EQ(node.triangle(lane), next++);
      }
  }

  EXPECT_EQ(tree.triangles().size(), triangles.size());
  std::vector<int> named(triangles.size(), 0);
  std::map<std::uint32_t, std::uint32_t> place_of;
  for (const TreeTriangle& t : tree.triangles()) {
    ++named.at(t.index);
    EXPECT_EQ(t.owned, triangles[t.index].owned);
    for (int k = 0; k < 3; ++k) {
      EXPECT_EQ(t.id[k], triangles[t.index].v[k]);
      const auto place =
          place_of.emplace(t.id[k], static_cast<std::uint32_t>(place_of.size())).first;
      EXPECT_EQ(t.place[k], place->second);
    }
  }
  for (const int times : named) EXPECT_EQ(times, 1);
  EXPECT_EQ(tree.vertices().size(), place_of.size());
  return parent;
}

/// Whether the box contains the vertex at t.
inline void expectContained(const VertexPath& path, double t, const MovingKdopTree& tree,
                            const detail::deformable::MovingKdop& box) {
  Real d[8];
  coordinatesAt(path, t, tree.origin(0), tree.origin(1), d);
  for (int j = 0; j < 8; ++j) {
    ASSERT_LE(-d[j], halfAt(box, j, t)) << "half-axis " << j << " at " << t;
    ASSERT_LE(d[j], halfAt(box, j + 8, t)) << "half-axis " << j + 8 << " at " << t;
  }
}

/// The displacement is a bound on the change of each coordinate. It is not much larger,
/// as long as a float can represent it.
inline void expectBounded(const VertexPath& path, double displacement, bool is_least) {
  Real moved = 0;
  for (int k = 0; k < 3; ++k) moved = std::max(moved, abs(Real{path.t1[k]} - path.t0[k]));
  ASSERT_LE(moved, displacement);
  if (is_least && moved <= 0x1p127L) {
    ASSERT_LE(displacement, moved * (1 + 0x1p-21L) + 2 * FLT_MIN);
  }
}

/// Every box of the tree contains the triangles below it, and the boxes of vertices
/// contain these. No vertex below moves further than the node's displacement.
inline void expectContainment(const MovingKdopTree& tree,
                              const std::vector<MeshTriangle>& triangles,
                              const VertexFrames& frames) {
  const std::vector<Place> parent = expectStructure(tree, triangles);
  ASSERT_FALSE(testing::Test::HasFailure());
  // Under sanitizers the boxes around every 16th triangle: they look for errors in
  // memory.
  constexpr std::uint32_t kEvery = kHasAddressSanitizer ? 16 : 1;
  for (int i = 0; i < static_cast<int>(tree.numNodes()); ++i)
    for (int lane = 0; lane < tree.node(i).count; ++lane) {
      if (!tree.node(i).isTriangle(lane)) continue;
      if (static_cast<std::uint32_t>(tree.node(i).triangle(lane)) % kEvery != 0) continue;
      const TreeTriangle& triangle =
          tree.triangles()[static_cast<std::size_t>(tree.node(i).triangle(lane))];
      for (int k = 0; k < 3; ++k) {
        const VertexPath path = frames[triangle.id[k]];
        const TreeVertex& vertex = tree.vertices()[triangle.place[k]];
        for (int c = 0; c < 3; ++c) {
          ASSERT_EQ(vertex.t0[c], path.t0[c]);
          ASSERT_EQ(vertex.t1[c], path.t1[c]);
        }
        ASSERT_NO_FATAL_FAILURE(expectBounded(path, vertex.displacement(), true));
        for (Place p{i, lane}; p.node >= 0; p = parent[static_cast<std::size_t>(p.node)])
          ASSERT_NO_FATAL_FAILURE(
              expectBounded(path, tree.node(p.node).displacement[p.lane], false));
        for (const double t : kTimes) {
          ASSERT_NO_FATAL_FAILURE(expectContained(path, t, tree, vertex.box));
          for (Place p{i, lane}; p.node >= 0;
               p = parent[static_cast<std::size_t>(p.node)])
            ASSERT_NO_FATAL_FAILURE(
                expectContained(path, t, tree, tree.node(p.node).box(p.lane)))
                << "node " << p.node << ", lane " << p.lane;
        }
      }
    }
}

/// Each vertex has the fan of its triangles. A closed fan may begin at any spoke.
inline void expectFans(const MovingKdopTree& tree) {
  const VertexFans expected(tree.triangles(), tree.vertices().size());
  ASSERT_EQ(tree.fans().size(), expected.size());
  for (std::size_t v = 0; v < expected.size(); ++v) {
    const VertexFan mine = tree.fans()[v], its = expected[v];
    ASSERT_EQ(mine.count, its.count);
    ASSERT_EQ(mine.is_closed, its.is_closed);
    std::vector<std::uint32_t> spokes(mine.spokes, mine.spokes + mine.count);
    if (mine.is_closed)
      std::rotate(spokes.begin(), std::find(spokes.begin(), spokes.end(), its.spokes[0]),
                  spokes.end());
    ASSERT_TRUE(std::equal(spokes.begin(), spokes.end(), its.spokes)) << "vertex " << v;
  }
}

/// The border has the edges of the triangles that are left: each counts as often as its
/// vertices follow each other in that order, less as often as they do in the other order.
inline void expectBorder(const RegionBorder& border, const MovingKdopTree& tree,
                         std::uint32_t first, std::uint32_t last) {
  using Edge = std::pair<std::uint32_t, std::uint32_t>;
  std::map<Edge, int> count;
  for (std::uint32_t i = first; i < last; ++i)
    for (int k = 0; k < 3; ++k) {
      const auto& place = tree.triangles()[i].place;
      const Edge edge{place[k], place[(k + 1) % 3]};
      ++count[edge];
      if (edge.first != edge.second) --count[{edge.second, edge.first}];
    }
  std::set<Edge> left;
  bool is_simple = true;
  for (const auto& [edge, times] : count) {
    if (times > 0) left.insert(edge);
    is_simple = is_simple && times <= 1;
  }
  if (!is_simple) left.clear();
  std::set<Edge> edges;
  for (std::size_t i = 0; i < border.size(); ++i)
    edges.insert({border.from(i), border.to(i)});
  ASSERT_EQ(edges.size(), border.size()) << "an edge twice";
  ASSERT_EQ(edges, left);
  if (left.empty()) return;

  // Paths begin at vertices that the border passes more than once, and pass no other such
  // vertex. If there is no such vertex, they are closed.
  std::map<std::uint32_t, int> passes;
  for (const Edge& edge : edges) ++passes[edge.first];
  ASSERT_FALSE(border.paths.empty());
  ASSERT_EQ(border.paths[0], 0U);
  for (std::size_t p = 0; p < border.paths.size(); ++p) {
    const std::size_t begin = border.paths[p], end = p + 1 < border.paths.size()
                                                         ? border.paths[p + 1]
                                                         : border.size();
    ASSERT_LT(begin, end);
    for (std::size_t i = begin; i + 1 < end; ++i) {
      ASSERT_EQ(border.to(i), border.from(i + 1));
      ASSERT_EQ(passes.at(border.to(i)), 1);
    }
    const bool is_closed = border.from(begin) == border.to(end - 1);
    ASSERT_TRUE(is_closed || passes.at(border.from(begin)) > 1);
    ASSERT_TRUE(is_closed || passes.at(border.to(end - 1)) > 1);
  }
  const bool is_passed_once = std::all_of(passes.begin(), passes.end(),
                                          [](const auto& p) { return p.second == 1; });
  ASSERT_EQ(border.is_one_loop, border.paths.size() == 1 && is_passed_once);
}

/// The borders that the tree keeps are those of its nodes. After the call all of them are
/// kept, as if queries had asked for them.
inline void expectBorders(const MovingKdopTree& tree) {
  std::vector<std::uint32_t> last(tree.numNodes(), 0);
  BorderFinder finder(tree);
  for (std::size_t i = last.size(); i-- > 0;) {
    const auto number = static_cast<int>(i);
    const MovingKdopNode& node = tree.node(number);
    for (int lane = 0; lane < node.count; ++lane)
      last[i] =
          std::max(last[i], node.isTriangle(lane)
                                ? static_cast<std::uint32_t>(node.triangle(lane)) + 1
                                : last[static_cast<std::size_t>(node.child[lane])]);
    const RegionBorder& border = tree.regionBorders().of(
        number, [&] { return finder.find(regionOf(tree, number, last[i])); });
    ASSERT_NO_FATAL_FAILURE(
        expectBorder(border, tree, tree.firstTriangle(number), last[i]))
        << "node " << i;
  }
}

/// The triangles of the nodes that have only triangles, by the user's ids.
inline std::set<std::vector<std::uint32_t>> lowestNodes(const MovingKdopTree& tree) {
  std::set<std::vector<std::uint32_t>> nodes;
  for (int i = 0; i < static_cast<int>(tree.numNodes()); ++i) {
    const auto& node = tree.node(i);
    std::vector<std::uint32_t> triangles;
    for (int lane = 0; lane < node.count && node.isTriangle(lane); ++lane)
      triangles.push_back(
          tree.triangles()[static_cast<std::size_t>(node.triangle(lane))].index);
    if (triangles.size() == static_cast<std::size_t>(node.count)) nodes.insert(triangles);
  }
  return nodes;
}

/// Both trees have the same boxes, to the bit.
inline void expectSameBoxes(const MovingKdopTree& x, const MovingKdopTree& y) {
  ASSERT_EQ(x.numNodes(), y.numNodes());
  for (int i = 0; i < static_cast<int>(x.numNodes()); ++i) {
    ASSERT_EQ(x.node(i).count, y.node(i).count);
    for (int lane = 0; lane < x.node(i).count; ++lane) {
      ASSERT_EQ(x.node(i).child[lane], y.node(i).child[lane]);
      ASSERT_EQ(x.node(i).displacement[lane], y.node(i).displacement[lane]);
      const detail::deformable::MovingKdop a = x.node(i).box(lane),
                                           b = y.node(i).box(lane);
      ASSERT_EQ(std::memcmp(&a, &b, sizeof(a)), 0) << "node " << i;
    }
  }
}

}  // namespace test
}  // namespace fcl

#endif
