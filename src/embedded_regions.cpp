// SPDX-License-Identifier: BSD-3-Clause
#include "fcl/narrowphase/detail/deformable/embedded_regions.h"

#include <algorithm>
#include <cstddef>

#include "parallel.h"
#include "region_border.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

/// The directions that ranges of triangles face, from blocks of eight.
class FacedDirections {
 public:
  FacedDirections(const MovingKdopTree& tree, const Kernels& kernels)
      : tree_(tree),
        kernels_(kernels),
        blocks_((tree.triangles().size() + kLength - 1) / kLength, kUnknown) {}

  /// Those of triangles [first, last). Not for ranges with common triangles at a time.
  std::uint32_t of(std::size_t first, std::size_t last) {
    const std::size_t from = (first + kLength - 1) / kLength, to = last / kLength;
    if (from > to) return ofEight(first, last);
    std::uint32_t faced = kUnknown;
    // Where a surface is not smooth, some of the blocks say so.
    for (const std::size_t step : {std::size_t{16}, std::size_t{4}, std::size_t{1}})
      for (std::size_t i = from; i < to && faced != 0; i += step) {
        if (blocks_[i] == kUnknown) blocks_[i] = ofEight(i * kLength, (i + 1) * kLength);
        faced &= blocks_[i];
      }
    if (faced != 0 && first < from * kLength) faced &= ofEight(first, from * kLength);
    if (faced != 0 && to * kLength < last) faced &= ofEight(to * kLength, last);
    return faced;
  }

 private:
  static constexpr std::size_t kLength = 8;
  static constexpr std::uint32_t kUnknown = ~std::uint32_t{0};

  std::uint32_t ofEight(std::size_t first, std::size_t last) const {
    return kernels_.facedDirections(tree_.vertices().data(), &tree_.triangles()[first],
                                    last - first);
  }

  const MovingKdopTree& tree_;
  const Kernels& kernels_;
  std::vector<std::uint32_t> blocks_;
};

/// A node that is not below an embedded one, and where its triangles end.
struct OpenNode {
  std::int32_t node;
  std::uint32_t last;
};

}  // namespace

EmbeddedRegions findEmbeddedRegions(const MovingKdopTree& tree, const Kernels& kernels,
                                    int num_threads, std::uint32_t least_triangles) {
  EmbeddedRegions found{std::vector<std::uint8_t>(tree.numNodes(), 0),
                        std::vector<std::uint8_t>(tree.vertices().size(), 0)};
  FacedDirections faced(tree, kernels);
  // Level by level; regions of a level have no triangle in common, nor do they write to
  // the same vertices.
  constexpr std::size_t kTasks = 64;
  std::vector<OpenNode> open{{0, static_cast<std::uint32_t>(tree.triangles().size())}},
      next;
  for (; !open.empty(); open.swap(next)) {
    parallelForBlocks(
        open.size(), open.size() / kTasks + 1, num_threads,
        [&](std::size_t i, std::size_t last) {
          RegionBorder border(tree, kernels);
          for (; i < last; ++i) {
            const std::uint32_t first = tree.firstTriangle(open[i].node),
                                end = open[i].last;
            const std::uint32_t directions = faced.of(first, end);
            if (directions == 0) continue;
            const Region region{first, end, tree.placesBefore(first),
                                tree.placesBefore(end)};
            const bool embedded = border.find(region, found.interior.data()) &&
                                  border.isEmbedded(directions);
            found.nodes[static_cast<std::size_t>(open[i].node)] = embedded;
            if (!embedded)
              std::fill(found.interior.begin() + region.first_place,
                        found.interior.begin() + region.last_place, std::uint8_t{0});
          }
        });
    next.clear();
    for (const OpenNode& o : open) {
      if (found.nodes[static_cast<std::size_t>(o.node)]) continue;
      const MovingKdopNode& node = tree.node(o.node);
      std::uint32_t last = o.last;
      for (int lane = node.count; lane-- > 0;) {
        if (node.isTriangle(lane)) continue;
        const std::uint32_t first = tree.firstTriangle(node.child[lane]);
        if (last - first >= least_triangles) next.push_back({node.child[lane], last});
        last = first;
      }
    }
  }
  return found;
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
