// SPDX-License-Identifier: BSD-3-Clause
#include "tree/tree_builder.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>

#include "base/parallel.h"
#include "tree/component_groups.h"
#include "tree/item_splitter.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

/// A point near most of the mesh: the median of the coordinates of a few vertices.
void findMiddle(TriangleArray triangles, std::size_t num_triangles,
                const VertexFrames& frames, double (&middle)[3]) {
  constexpr std::size_t kSample = 31;
  assert(num_triangles > 0);
  double x[3][kSample];
  for (std::size_t i = 0; i < kSample; ++i) {
    std::uint32_t v[3];
    triangles.copyIds(i * num_triangles / kSample, v);
    double p[3];
    frames.at(0, v[0], p);
    for (int k = 0; k < 3; ++k) x[k][i] = std::isfinite(p[k]) ? p[k] : 0;
  }
  for (int k = 0; k < 3; ++k) {
    std::nth_element(x[k], x[k] + kSample / 2, x[k] + kSample);
    middle[k] = x[k][kSample / 2];
  }
}

/// Three times the centroids, relative to the middle, so that no digits are lost far from
/// the origin.
UninitializedVector<TreeItem> itemsOf(TriangleArray triangles, std::size_t num_triangles,
                                      const VertexFrames& frames, int num_threads) {
  constexpr std::size_t kBlock = 8192;
  double middle[3];
  findMiddle(triangles, num_triangles, frames, middle);
  UninitializedVector<Float4> points(frames.size());
  parallelForBlocks(frames.size(), kBlock, num_threads,
                    [&](std::size_t i, std::size_t last) {
                      for (; i < last; ++i) {
                        double p[3];
                        frames.at(0, i, p);
                        Float4 point{};
                        for (int k = 0; k < 3; ++k)
                          point[k] = clampedCoordinate(p[k] - middle[k]);
                        points[i] = point;
                      }
                    });
  UninitializedVector<TreeItem> items(num_triangles);
  parallelForBlocks(
      num_triangles, kBlock, num_threads, [&](std::size_t i, std::size_t last) {
        for (; i < last; ++i) {
          std::uint32_t v[3];
          triangles.copyIds(i, v);
          assert(std::max({v[0], v[1], v[2]}) < points.size());
          const Float4 sum = points[v[0]] + points[v[1]] + points[v[2]];
          items[i] = {{sum[0], sum[1], sum[2]}, static_cast<std::uint32_t>(i)};
        }
      });
  return items;
}

/// The component of each triangle, named by a vertex. Free leaves have the name
/// num_vertices: no part of a surface has them.
std::vector<std::uint32_t> componentsOf(TriangleArray triangles,
                                        std::size_t num_triangles,
                                        std::size_t num_vertices,
                                        const FreeLeaves& free) {
  assert(free.count() <= num_triangles);
  const std::size_t num_faces = num_triangles - free.count();
  const std::vector<std::uint32_t> component_of = findComponents(
      num_vertices, num_faces,
      [triangles](std::size_t i, std::uint32_t(&v)[3]) { triangles.copyIds(i, v); });
  std::vector<std::uint32_t> components(num_triangles,
                                        static_cast<std::uint32_t>(num_vertices));
  for (std::size_t i = 0; i < num_faces; ++i) {
    std::uint32_t v[3];
    triangles.copyIds(i, v);
    components[i] = component_of[v[0]];
  }
  return components;
}

}  // namespace

TreeStructure splitTriangles(TriangleArray triangles, std::size_t num_triangles,
                             const VertexFrames& frames, int num_threads,
                             FreeLeaves free) {
  // The largest number of triangles in a task.
  constexpr std::size_t kMaxTask = 8192;
  constexpr std::size_t kWidth = MovingKdopNode::kWidth;
  TreeStructure tree;
  tree.leaves.resize(num_triangles);
  UninitializedVector<TreeItem> items =
      itemsOf(triangles, num_triangles, frames, num_threads);
  std::vector<std::size_t> ends =
      groupItems(componentsOf(triangles, num_triangles, frames.size(), free),
                 frames.size() + 1, kLeastComponent, items);
  Splitter splitter(std::move(items), std::move(ends));
  std::vector<TreeChildren> top(1);
  const std::vector<OpenItems> roots = splitRange(splitter, {{0, num_triangles}, 0, 0, 0},
                                                  kMaxTask, kWidth, top, tree.leaves);
  std::vector<std::vector<TreeChildren>> subtrees(roots.size());
  parallelFor(roots.size(), num_threads, [&](std::size_t i) {
    subtrees[i].reserve(roots[i].range.count / 4);
    subtrees[i].emplace_back();
    OpenItems root = roots[i];
    root.node = 0;
    splitRange(splitter, root, 0, kWidth, subtrees[i], tree.leaves);
  });

  // The nodes below the root of a subtree get the numbers at which the walk reaches it.
  std::size_t num_nodes = top.size() - roots.size();
  for (const std::vector<TreeChildren>& subtree : subtrees) num_nodes += subtree.size();
  tree.nodes.resize(num_nodes);
  struct Numbered {
    std::size_t from, to;
  };
  std::vector<Numbered> open{{0, 0}};
  std::size_t next = 1, num_met = 0;
  while (!open.empty()) {
    const Numbered o = open.back();
    open.pop_back();
    const bool is_root = num_met < roots.size() && roots[num_met].node == o.from;
    const std::vector<TreeChildren>& from = is_root ? subtrees[num_met] : top;
    tree.nodes[o.to] = from[is_root ? 0 : o.from];
    const std::size_t num_open = open.size();
    const auto shift = static_cast<std::int32_t>(next) - 1;
    for (std::int32_t& child : tree.nodes[o.to].child) {
      if (child <= 0) continue;
      const auto to = is_root ? child + shift : static_cast<std::int32_t>(next++);
      if (!is_root)
        open.push_back({static_cast<std::size_t>(child), static_cast<std::size_t>(to)});
      child = to;
    }
    std::reverse(open.begin() + static_cast<std::ptrdiff_t>(num_open), open.end());
    if (!is_root) continue;
    for (std::size_t i = 1; i < from.size(); ++i) {
      tree.nodes[next] = from[i];
      for (std::int32_t& child : tree.nodes[next].child)
        if (child > 0) child += shift;
      ++next;
    }
    ++num_met;
  }
  assert(num_met == roots.size() && next == num_nodes && isInWalkOrder(tree));
  return tree;
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
