// SPDX-License-Identifier: BSD-3-Clause
#include "self_culling/regions_apart.h"

#include <algorithm>
#include <cassert>
#include <cstddef>

#include "numerics/error_bounds.h"
#include "numerics/moving_vector.h"
#include "self_culling/border_proof.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

constexpr std::uint32_t kNone = MovingKdopNode::kNoPlace;

Vec difference(const double* p, const double* q) {
  return {p[0] - q[0], p[1] - q[1], p[2] - q[2]};
}

double squaredLength(const TreeVertex& p, const TreeVertex& q) {
  const Vec a = difference(p.t0, q.t0), b = difference(p.t1, q.t1);
  return std::max(dot(a, a), dot(b, b));
}

/// A lower bound on the product of a triangle's normal and a direction of 1, 0 and -1
/// during the step.
double leastAreaSeen(const TreeVertex* const (&x)[3], const Vec& direction) {
  const Vec v0 = difference(x[1]->t0, x[0]->t0), v1 = difference(x[1]->t1, x[0]->t1),
            w0 = difference(x[2]->t0, x[0]->t0), w1 = difference(x[2]->t1, x[0]->t1);
  const double first = dot(cross(v0, w0), direction),
               middle = 0.5 * dot(cross(v0, w1) + cross(v1, w0), direction),
               last = dot(cross(v1, w1), direction);
  const double size =
      std::max(maxNorm(v0), maxNorm(v1)) * std::max(maxNorm(w0), maxNorm(w1));
  return isInRange(size) ? std::min(std::min(first, middle), last) - kFanBound * size : 0;
}

/// For each node, the root of the region that it is below, or kNone.
std::vector<std::uint32_t> regionsOfNodes(const MovingKdopTree& tree,
                                          const EmbeddedRegions& regions) {
  std::vector<std::uint32_t> region(tree.numNodes(), kNone);
  // Children come after their parents.
  for (std::size_t i = 0; i < region.size(); ++i) {
    if (regions.nodes[i]) region[i] = static_cast<std::uint32_t>(i);
    const MovingKdopNode& node = tree.node(static_cast<int>(i));
    for (int lane = 0; lane < node.count; ++lane)
      if (!node.isTriangle(lane))
        region[static_cast<std::size_t>(node.child[lane])] = region[i];
  }
  return region;
}

/// Marks the vertices of a triangle over which its height may be no more than the
/// distance as not apart.
void markLow(const MovingKdopTree& tree, const MovingKdopNode& node, int lane,
             const Vec& direction, double distance, std::vector<std::uint8_t>& is_apart) {
  const std::uint32_t place[3] = {node.places[0][lane], node.places[1][lane],
                                  node.places[2][lane]};
  const TreeVertex* const x[3] = {&tree.vertices()[place[0]], &tree.vertices()[place[1]],
                                  &tree.vertices()[place[2]]};
  const double area = leastAreaSeen(x, direction);
  // More than the rounding of the products below, and of the lengths.
  constexpr double kUp = 1 + 0x1p-40;
  const double least = distance * distance * dot(direction, direction) * kUp;
  for (int k = 0; k < 3; ++k) {
    const double opposite = squaredLength(*x[(k + 1) % 3], *x[(k + 2) % 3]);
    if (!(area > 0 && area * area > least * opposite)) is_apart[place[k]] = 0;
  }
}

}  // namespace

std::vector<std::uint32_t> findNodesApart(const MovingKdopTree& tree,
                                          const EmbeddedRegions& regions,
                                          double distance) {
  assert(regions.nodes.size() == tree.numNodes() &&
         regions.interior.size() == tree.vertices().size());
  std::vector<std::uint32_t> nodes = regionsOfNodes(tree, regions);
  std::vector<std::uint8_t> is_apart = regions.interior;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (nodes[i] == kNone) continue;
    int d[3];
    directionOf(regions.directions[nodes[i]], d);
    const MovingKdopNode& node = tree.node(static_cast<int>(i));
    for (int lane = 0; lane < node.count; ++lane)
      if (node.isTriangle(lane))
        markLow(tree, node, lane, {double(d[0]), double(d[1]), double(d[2])}, distance,
                is_apart);
  }
  const auto isApart = [&](const MovingKdopNode& node, int lane, std::uint32_t region) {
    if (!node.isTriangle(lane))
      return nodes[static_cast<std::size_t>(node.child[lane])] == region;
    return is_apart[node.places[0][lane]] && is_apart[node.places[1][lane]] &&
           is_apart[node.places[2][lane]];
  };
  for (std::size_t i = nodes.size(); i-- > 0;) {
    const MovingKdopNode& node = tree.node(static_cast<int>(i));
    for (int lane = 0; lane < node.count && nodes[i] != kNone; ++lane)
      if (!isApart(node, lane, nodes[i])) nodes[i] = kNone;
  }
  return nodes;
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
