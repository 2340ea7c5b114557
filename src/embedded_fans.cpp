// SPDX-License-Identifier: BSD-3-Clause
#include "fcl/narrowphase/detail/deformable/embedded_fans.h"

#include <algorithm>

#include "parallel.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

/// Vertices whose fans are alike, until there are eight of them.
class FanQueue {
 public:
  FanQueue(const MovingKdopTree& tree, const Kernels& kernels,
           std::vector<std::uint8_t>& embedded)
      : tree_(tree), kernels_(kernels), embedded_(embedded) {}

  void add(std::uint32_t vertex, const VertexFan& fan) {
    Alike& alike = alike_[fan.is_closed][fan.count];
    alike.vertices[alike.size++] = vertex;
    if (alike.size == 8) prove(alike);
  }

  void finish() {
    for (auto& kind : alike_)
      for (Alike& alike : kind)
        if (alike.size > 0) prove(alike);
  }

 private:
  struct Alike {
    std::uint32_t vertices[8];
    std::uint32_t size{0};
  };

  void prove(Alike& alike) {
    EightFans eight;
    // The last one fills up the eight.
    for (std::uint32_t i = 0; i < 8; ++i) {
      const std::uint32_t vertex = alike.vertices[std::min(i, alike.size - 1)];
      const VertexFan fan = tree_.fans()[vertex];
      eight.center[i] = &tree_.vertices()[vertex];
      eight.spokes[i] = fan.spokes;
      eight.count = fan.count;
      eight.is_closed = fan.is_closed;
    }
    const unsigned proved = kernels_.areFansEmbedded(tree_.vertices().data(), eight);
    for (std::uint32_t i = 0; i < alike.size; ++i)
      embedded_[alike.vertices[i]] = proved >> i & 1U;
    alike.size = 0;
  }

  const MovingKdopTree& tree_;
  const Kernels& kernels_;
  std::vector<std::uint8_t>& embedded_;
  /// By kind, open and closed, and number of spokes.
  Alike alike_[2][VertexFans::kMaxSpokes + 1];
};

}  // namespace

std::vector<std::uint8_t> findEmbeddedFans(const MovingKdopTree& tree,
                                           const std::vector<std::uint8_t>& left_out,
                                           const Kernels& kernels, int num_threads) {
  constexpr std::size_t kBlock = 4096, kAhead = 64;
  const std::size_t count = tree.vertices().size();
  std::vector<std::uint8_t> embedded(count, 0);
  parallelForBlocks(count, kBlock, num_threads, [&](std::size_t i, std::size_t last) {
    FanQueue queue(tree, kernels, embedded);
    for (; i < last; ++i) {
      __builtin_prefetch(&tree.vertices()[std::min(i + kAhead, count - 1)]);
      const VertexFan fan = tree.fans()[i];
      if (!left_out[i] && fan.count > 0) queue.add(static_cast<std::uint32_t>(i), fan);
    }
    queue.finish();
  });
  return embedded;
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
