// SPDX-License-Identifier: BSD-3-Clause
#include "self_culling/embedded_fans.h"

#include <algorithm>
#include <cassert>

#include "base/parallel.h"
#include "base/prefetch.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

/// Collects vertices whose fans have the same form, until there are eight of them.
class FanQueue {
 public:
  FanQueue(const MovingKdopTree& tree, const Kernels& kernels, double distance,
           std::vector<std::uint8_t>& embedded)
      : tree_(tree), kernels_(kernels), distance_(distance), embedded_(embedded) {}

  void add(std::uint32_t vertex, const VertexFan& fan) {
    const bool is_short = fan.count <= VertexFans::kShort;
    Alike& alike = is_short ? short_[fan.is_closed][fan.count] : long_;
    if (!is_short && alike.size > 0) {
      const VertexFan first = tree_.fans()[alike.vertices[0]];
      if (first.count != fan.count || first.is_closed != fan.is_closed) prove(alike);
    }
    assert(fan.count >= (fan.is_closed ? 3U : 2U) && alike.size < 8);
    alike.vertices[alike.size++] = vertex;
    if (alike.size == 8) prove(alike);
  }

  void finish() {
    for (auto& kind : short_)
      for (Alike& alike : kind)
        if (alike.size > 0) prove(alike);
    if (long_.size > 0) prove(long_);
  }

 private:
  struct Alike {
    std::uint32_t vertices[8];
    std::uint32_t size{0};
  };

  void prove(Alike& alike) {
    EightFans eight;
    assert(alike.size > 0 && alike.size <= 8);
    // If there are fewer than eight, the last one is repeated.
    for (std::uint32_t i = 0; i < 8; ++i) {
      const std::uint32_t vertex = alike.vertices[std::min(i, alike.size - 1)];
      const VertexFan fan = tree_.fans()[vertex];
      assert(i == 0 || (fan.count == eight.count && fan.is_closed == eight.is_closed));
      eight.center[i] = &tree_.vertices()[vertex];
      eight.spokes[i] = fan.spokes;
      eight.count = fan.count;
      eight.is_closed = fan.is_closed;
    }
    const unsigned proved =
        kernels_.areFansEmbedded(tree_.vertices().data(), eight, distance_);
    for (std::uint32_t i = 0; i < alike.size; ++i)
      embedded_[alike.vertices[i]] = proved >> i & 1U;
    alike.size = 0;
  }

  const MovingKdopTree& tree_;
  const Kernels& kernels_;
  double distance_;
  std::vector<std::uint8_t>& embedded_;
  /// Short fans by kind (open, closed) and number of spokes.
  Alike short_[2][VertexFans::kShort + 1];
  /// Long fans of the same form that follow each other.
  Alike long_;
};

}  // namespace

std::vector<std::uint8_t> findEmbeddedFans(const MovingKdopTree& tree,
                                           const std::vector<std::uint8_t>& left_out,
                                           const Kernels& kernels, int num_threads,
                                           double distance) {
  constexpr std::size_t kBlock = 4096, kAhead = 64;
  const std::size_t count = tree.vertices().size();
  assert(left_out.size() == count && distance >= 0 && tree.fans().size() == count);
  std::vector<std::uint8_t> embedded(count, 0);
  parallelForBlocks(count, kBlock, num_threads, [&](std::size_t i, std::size_t last) {
    FanQueue queue(tree, kernels, distance, embedded);
    for (; i < last; ++i) {
      const std::size_t ahead = std::min(i + kAhead, count - 1);
      if (!left_out[ahead]) prefetchMemory(&tree.vertices()[ahead]);
      if (left_out[i]) continue;
      const VertexFan fan = tree.fans()[i];
      if (fan.count > 0) queue.add(static_cast<std::uint32_t>(i), fan);
    }
    queue.finish();
  });
  return embedded;
}

std::vector<std::uint32_t> findNodesInFans(const MovingKdopTree& tree,
                                           const std::vector<std::uint8_t>& embedded) {
  // For smaller fans a pass over all nodes costs more than it saves.
  constexpr std::uint32_t kLeastSpokes = 64, kNoPlace = MovingKdopNode::kNoPlace;
  assert(embedded.size() == tree.vertices().size());
  if (tree.fans().longest() < kLeastSpokes) return {};
  std::vector<std::uint32_t> centers(tree.numNodes(), kNoPlace);
  const auto isIn = [&](const MovingKdopNode& node, int lane, std::uint32_t center) {
    if (!node.isTriangle(lane))
      return centers[static_cast<std::size_t>(node.child[lane])] == center;
    return node.places[0][lane] == center || node.places[1][lane] == center ||
           node.places[2][lane] == center;
  };
  const auto areAllIn = [&](const MovingKdopNode& node, std::uint32_t center) {
    for (int lane = 1; lane < node.count; ++lane)
      if (!isIn(node, lane, center)) return false;
    return true;
  };
  // Children come after their parents.
  for (std::size_t i = centers.size(); i-- > 0;) {
    const MovingKdopNode& node = tree.node(static_cast<int>(i));
    if (!node.isTriangle(0)) {
      const std::uint32_t center = centers[static_cast<std::size_t>(node.child[0])];
      if (center != kNoPlace && areAllIn(node, center)) centers[i] = center;
      continue;
    }
    for (const auto& places : node.places) {
      const std::uint32_t center = places[0];
      assert(center < embedded.size());
      if (embedded[center] && tree.fans()[center].count >= kLeastSpokes &&
          areAllIn(node, center))
        centers[i] = center;
    }
  }
  return centers;
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
