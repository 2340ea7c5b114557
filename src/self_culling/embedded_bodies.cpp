// SPDX-License-Identifier: BSD-3-Clause
#include "self_culling/embedded_bodies.h"

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <vector>

#include "base/parallel.h"
#include "base/prefetch.h"
#include "tree/border_finder.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

/// Whether the triangles of a region are a closed surface: around each of their vertices
/// they form a closed fan, with all triangles that the mesh has there. So each edge has
/// two triangles with the same orientation.
bool isClosed(const MovingKdopTree& tree, const Region& region) {
  // Most nodes are a part of a component, and soon have a vertex of a triangle before
  // them.
  const auto begin = tree.triangles().begin();
  const auto isFirst = [&](const TreeTriangle& t) {
    return std::min({t.place[0], t.place[1], t.place[2]}) >= region.first_place;
  };
  if (!std::all_of(begin + region.first, begin + region.last, isFirst)) return false;
  // All corners of the region are at the vertices below. If these have as many corners in
  // the mesh, none of them is outside of the region.
  std::size_t corners = 3 * std::size_t{region.last - region.first};
  for (std::uint32_t v = region.first_place; v < region.last_place; ++v) {
    const VertexFan fan = tree.fans()[v];
    if (!fan.is_closed || fan.count > corners) return false;
    corners -= fan.count;
  }
  return corners == 0;
}

/// The centers of a node's boxes in both frames.
TreeVertex centerOf(const MovingKdopTree& tree, std::int32_t i) {
  const MovingKdopNode& node = tree.node(i);
  double center[2][3];
  for (int frame = 0; frame < 2; ++frame)
    for (int k = 0; k < 3; ++k) {
      const float(&lower)[8] = (frame == 0 ? node.t0 : node.t1)[2 * k],
            (&upper)[8] = (frame == 0 ? node.t0 : node.t1)[2 * k + 1];
      const double low = -double{*std::max_element(lower, lower + node.count)},
                   high = double{*std::max_element(upper, upper + node.count)};
      assert(low <= high);
      center[frame][k] = tree.origin(frame)[k] + 0.5 * (low + high);
    }
  TreeVertex point{};
  point.setPath(center[0], center[1]);
  return point;
}

/// Whether a closed surface stays star-shaped.
/// @param center  the point to try
/// @param[in,out] least  begins as LeastSight(); of all triangles. Null: not wanted
bool isStarShaped(const MovingKdopTree& tree, const Region& region,
                  const TreeVertex& center, const Kernels& kernels, LeastSight* least) {
  // A closed surface has about twice as many triangles as vertices, and these are in the
  // order of the triangles. So this number of vertices is prefetched for a block.
  constexpr std::size_t kAhead = 48, kEach = 5;
  const TreeVertex* vertices = tree.vertices().data();
  const TreeTriangle* triangles = tree.triangles().data();
  // The ray goes through the middle of the first triangle.
  double ray[3] = {0, 0, 0};
  for (int k = 0; k < 3; ++k)
    for (const std::uint32_t place : triangles[region.first].place)
      ray[k] += vertices[place].t0[k] - center.t0[k];
  bool left = true, right = true, is_hit = false;
  for (std::size_t i = region.first; i < region.last; i += 8) {
    const std::size_t count = std::min<std::size_t>(8, region.last - i);
    const unsigned all = (1U << count) - 1;
    const std::size_t ahead = region.first_place + (i - region.first) / 2 + kAhead;
    for (std::size_t k = ahead; k < ahead + kEach && k < region.last_place; ++k)
      prefetchMemory(&vertices[k]);
    const EightViews views =
        kernels.viewFrom(center, ray, vertices, triangles + i, count, least);
    assert((views.left & views.right) == 0 && (views.left | views.right) <= all);
    left = left && views.left == all;
    right = right && views.right == all;
    if (!(left || right)) return false;
    const unsigned hit = all & ~views.missed;
    if (hit == 0) continue;
    const bool is_one = (hit & (hit - 1)) == 0;
    if (is_hit || !is_one) return false;
    is_hit = true;
  }
  // The point is inside: in each direction it sees at least one triangle.
  assert(is_hit);
  return true;
}

/// Whether a closed surface stays star-shaped, and its features stay further apart than a
/// distance.
bool isApartBody(const MovingKdopTree& tree, const Region& region,
                 const TreeVertex& center, const Kernels& kernels, double distance) {
  LeastSight least;
  if (!isStarShaped(tree, region, center, kernels, &least)) return false;
  const auto leastOf = [](const double(&x)[8]) { return *std::min_element(x, x + 8); };
  assert(!(leastOf(least.distance_square) < 0) && !(leastOf(least.sine_square) < 0));
  return leastOf(least.distance_square) * leastOf(least.sine_square) >
         distance * distance * (1 + 0x1p-30);
}

/// The nodes that are closed surfaces, parents first.
std::vector<ClosedNode> closedNodes(const MovingKdopTree& tree) {
  std::vector<ClosedNode> closed;
  std::vector<ClosedNode> open{{0, static_cast<std::uint32_t>(tree.triangles().size())}};
  while (!open.empty()) {
    const ClosedNode node = open.back();
    open.pop_back();
    if (isClosed(tree, regionOf(tree, node.node, node.last))) closed.push_back(node);
    forEachPart(tree, node.node, node.last, kLeastBody,
                [&open](std::int32_t child, std::uint32_t last) {
                  open.push_back({child, last});
                });
  }
  return closed;
}

}  // namespace

EmbeddedRegions findEmbeddedBodies(const MovingKdopTree& tree, const Kernels& kernels,
                                   int num_threads, double distance) {
  assert(distance >= 0);
  EmbeddedRegions found(tree);
  const std::vector<ClosedNode>& closed =
      tree.regionBorders().closedNodes([&] { return closedNodes(tree); });
  std::vector<std::uint8_t> is_body(closed.size());
  constexpr std::size_t kTasks = 64;
  parallelForBlocks(
      closed.size(), closed.size() / kTasks + 1, num_threads,
      [&](std::size_t i, std::size_t last) {
        for (; i < last; ++i) {
          const Region region = regionOf(tree, closed[i].node, closed[i].last);
          const TreeVertex center = centerOf(tree, closed[i].node);
          is_body[i] = distance > 0
                           ? isApartBody(tree, region, center, kernels, distance)
                           : isStarShaped(tree, region, center, kernels, nullptr);
        }
      });
  for (std::size_t i = 0; i < closed.size(); ++i) {
    const Region region = regionOf(tree, closed[i].node, closed[i].last);
    // A body inside of a body that was found would count its triangles twice.
    assert(region.first_place < region.last_place);
    if (!is_body[i] || found.interior[region.first_place]) continue;
    found.nodes[static_cast<std::size_t>(closed[i].node)] = 1;
    std::fill(found.interior.begin() + region.first_place,
              found.interior.begin() + region.last_place, std::uint8_t{1});
  }
  return found;
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
