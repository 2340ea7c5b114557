// SPDX-License-Identifier: BSD-3-Clause
#include "self_culling/regions_apart.h"

#include <algorithm>
#include <cassert>
#include <cstddef>

#include "base/bits.h"
#include "base/prefetch.h"
#include "self_culling/border_proof.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

constexpr std::uint32_t kNone = MovingKdopNode::kNoPlace;

/// Marks vertices of the borders of regions that may come within a distance of an edge of
/// the border that does not have them.
class BorderMarks {
 public:
  BorderMarks(const MovingKdopTree& tree, const Kernels& kernels, double distance,
              std::vector<std::uint8_t>& is_apart)
      : proof_(tree, kernels),
        distance_(distance),
        is_apart_(is_apart),
        next_(tree.vertices().size()) {}

  void mark(const RegionBorder& border, int direction) {
    markShortLoops(border);
    proof_.markNear(border, direction, distance_, is_apart_);
  }

 private:
  /// In place of a next vertex: there are several.
  static constexpr std::uint32_t kSeveral = kNone - 1;

  /// Marks the vertices of loops of three edges: they have no edge without a vertex of
  /// the opposite one. Also marks vertices that the border passes more than once, which
  /// may be in such a loop, and those next to them.
  void markShortLoops(const RegionBorder& border) {
    for (const std::uint32_t v : border.points) next_[v] = kNone;
    for (std::size_t i = 0; i < border.size(); ++i) {
      std::uint32_t& next = next_[border.from(i)];
      next = next == kNone ? border.to(i) : kSeveral;
    }
    for (std::size_t i = 0; i < border.size(); ++i) {
      const std::uint32_t from = border.from(i), to = border.to(i), third = next_[to];
      assert(third != kNone);  // an edge of the border begins where another one ends
      if (next_[from] == kSeveral || third == kSeveral || next_[third] == from)
        is_apart_[from] = is_apart_[to] = 0;
    }
  }

  BorderProof proof_;
  double distance_;
  std::vector<std::uint8_t>& is_apart_;
  /// The vertex to which the border's edge from a vertex leads.
  std::vector<std::uint32_t> next_;
};

/// Regions, and which of their vertices are apart from all features without them.
class RegionMarks {
 public:
  RegionMarks(const MovingKdopTree& tree, const EmbeddedRegions& regions,
              const Kernels& kernels, double distance, RegionsApart& apart)
      : tree_(tree),
        regions_(regions),
        kernels_(kernels),
        distance_(distance),
        apart_(apart),
        is_apart_(tree.vertices().size(), 1) {}

  /// Finds the region of each node. Marks the vertices over which triangles may be low,
  /// and those whose fans have such a triangle.
  void markLow() {
    constexpr std::size_t kAhead = 8;
    const std::size_t count = apart_.nodes.size();
    int direction[3];
    // Children come after their parents.
    for (std::size_t i = 0; i < count; ++i) {
      if (regions_.nodes[i]) apart_.nodes[i] = static_cast<std::uint32_t>(i);
      const std::uint32_t region = apart_.nodes[i];
      assert(region == kNone || (region <= i && regions_.nodes[region]));
      if (region == kNone || isBody(region)) continue;
      prefetch(std::min(i + kAhead, count - 1));
      const MovingKdopNode& node = tree_.node(static_cast<int>(i));
      for (int lane = 0; lane < node.count; ++lane)
        if (!node.isTriangle(lane))
          apart_.nodes[static_cast<std::size_t>(node.child[lane])] = region;
      if (node.triangles == 0) continue;
      directionOf(regions_.directions[region], direction);
      markLow(node, direction);
    }
  }

  void markBorders() {
    BorderMarks borders(tree_, kernels_, distance_, is_apart_);
    for (std::size_t i = 0; i < regions_.nodes.size(); ++i)
      if (regions_.nodes[i] && !isBody(i))
        borders.mark(tree_.regionBorders().known(static_cast<std::int32_t>(i)),
                     regions_.directions[i]);
  }

  /// Keeps the region of those nodes that only have vertices without a mark.
  void keepApart() {
    std::vector<std::uint32_t>& nodes = apart_.nodes;
    for (std::size_t i = nodes.size(); i-- > 0;) {
      if (nodes[i] == kNone || isBody(nodes[i])) continue;
      const MovingKdopNode& node = tree_.node(static_cast<int>(i));
      for (int lane = 0; lane < node.count && nodes[i] != kNone; ++lane)
        if (!isApart(node, lane, nodes[i])) nodes[i] = kNone;
    }
  }

 private:
  bool isBody(std::size_t region) const {
    return regions_.directions[region] == EmbeddedRegions::kNoDirection;
  }

  /// Prefetches what markLow() reads of a node.
  void prefetch(std::size_t i) const {
    const MovingKdopNode& node = tree_.node(static_cast<int>(i));
    prefetchMemory(&node.places[0]);
    prefetchMemory(&node.places[2]);
    prefetchMemory(&node.count);
  }

  void markLow(const MovingKdopNode& node, const int (&direction)[3]) {
    // New vertices come in the order of the triangles, about four with a node.
    constexpr std::uint32_t kAhead = 24, kEach = 5;
    const std::size_t size = is_apart_.size();
    const std::uint32_t place = node.places[0][0] + kAhead;
    for (std::uint32_t k = place; k < place + kEach && k < size; ++k)
      prefetchMemory(&tree_.vertices()[k]);
    for (std::uint32_t left =
             kernels_.lowCorners(tree_.vertices().data(), node, direction, distance_);
         left != 0; left &= left - 1) {
      const int corner = lowestBit(left), lane = corner % 8;
      assert(corner < 24 && lane < node.count && node.isTriangle(lane));
      is_apart_[node.places[corner / 8][lane]] = 0;
      for (const auto& places : node.places) apart_.fans[places[lane]] = 0;
    }
  }

  bool isApart(const MovingKdopNode& node, int lane, std::uint32_t region) const {
    if (!node.isTriangle(lane))
      return apart_.nodes[static_cast<std::size_t>(node.child[lane])] == region;
    return is_apart_[node.places[0][lane]] && is_apart_[node.places[1][lane]] &&
           is_apart_[node.places[2][lane]];
  }

  const MovingKdopTree& tree_;
  const EmbeddedRegions& regions_;
  const Kernels& kernels_;
  double distance_;
  RegionsApart& apart_;
  std::vector<std::uint8_t> is_apart_;
};

}  // namespace

RegionsApart findRegionsApart(const MovingKdopTree& tree, const EmbeddedRegions& regions,
                              const Kernels& kernels, double distance) {
  assert(regions.isOf(tree) && distance >= 0);
  RegionsApart apart{std::vector<std::uint32_t>(tree.numNodes(), kNone),
                     regions.interior};
  RegionMarks marks(tree, regions, kernels, distance, apart);
  marks.markLow();
  marks.markBorders();
  marks.keepApart();
  return apart;
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
