// SPDX-License-Identifier: BSD-3-Clause
#include "self_culling/embedded_regions.h"

#include <algorithm>
#include <cassert>
#include <cstddef>

#include "base/parallel.h"
#include "self_culling/border_proof.h"
#include "tree/border_finder.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

/// The directions that ranges of triangles face, computed from blocks of eight triangles.
class FacedDirections {
 public:
  FacedDirections(const MovingKdopTree& tree, const Kernels& kernels)
      : tree_(tree),
        kernels_(kernels),
        blocks_((tree.triangles().size() + kLength - 1) / kLength, kUnknown) {}

  /// The directions of triangles [first, last). Threads must not use ranges with common
  /// triangles at the same time.
  std::uint32_t of(std::size_t first, std::size_t last) {
    assert(first < last && last <= tree_.triangles().size());
    const std::size_t from = (first + kLength - 1) / kLength, to = last / kLength;
    if (from > to) return ofEight(first, last);
    std::uint32_t faced = kUnknown;
    // If a surface is not smooth, a few blocks are enough to show it.
    for (const std::size_t step : {std::size_t{16}, std::size_t{4}, std::size_t{1}})
      for (std::size_t i = from; i < to && faced != 0; i += step) {
        if (blocks_[i] == kUnknown) blocks_[i] = ofEight(i * kLength, (i + 1) * kLength);
        faced &= blocks_[i];
      }
    if (faced != 0 && first < from * kLength) faced &= ofEight(first, from * kLength);
    if (faced != 0 && to * kLength < last) faced &= ofEight(to * kLength, last);
    assert(faced >> 2 * kNumAxes == 0);
    return faced;
  }

 private:
  static constexpr std::size_t kLength = 8;
  static constexpr std::uint32_t kUnknown = ~std::uint32_t{0};

  std::uint32_t ofEight(std::size_t first, std::size_t last) const {
    assert(first < last && last - first <= kLength && last <= tree_.triangles().size());
    return kernels_.facedDirections(tree_.vertices().data(), &tree_.triangles()[first],
                                    last - first);
  }

  const MovingKdopTree& tree_;
  const Kernels& kernels_;
  std::vector<std::uint32_t> blocks_;
};

/// A node that may be the root of a region, and the end of its triangles.
struct OpenNode {
  std::int32_t node;
  std::uint32_t last;
};

/// The nodes that are still to be searched; the number of triangles of the regions that
/// were found; and the number of triangles whose borders were tested in vain, because not
/// even a part was a region.
struct Searched {
  std::vector<OpenNode> rest;
  std::size_t embedded{0}, in_vain{0};
};

/// Finds borders and tests them; one for each thread.
struct BorderSearch {
  BorderFinder finder;
  BorderProof proof;

  BorderSearch(const MovingKdopTree& tree, const Kernels& kernels)
      : finder(tree), proof(tree, kernels) {}
};

class RegionSearch {
 public:
  /// @param found  nodes that are proved already, to which others are added
  RegionSearch(const MovingKdopTree& tree, const Kernels& kernels,
               std::uint32_t least_triangles, EmbeddedRegions& found)
      : tree_(tree),
        least_triangles_(least_triangles),
        faced_(tree, kernels),
        found_(found) {}

  /// The nodes at which the search begins: the root, if it is not proved already.
  std::vector<OpenNode> roots() const {
    if (found_.nodes[0]) return {};
    return {{0, static_cast<std::uint32_t>(tree_.triangles().size())}};
  }

  /// Finds the largest region among a node, its first part, the first part of that and so
  /// on. A part of an embedded region is embedded, too. So the search begins with the
  /// smallest part and goes up as long as the parts are embedded. In this way no large
  /// border is tested in vain where layers lie on each other. Threads may search
  /// different nodes at the same time if none is below another.
  /// @return also has the other parts of the nodes that are not embedded
  Searched search(const OpenNode& open, BorderSearch& borders) {
    std::vector<OpenNode> chain{open};
    for (std::vector<OpenNode> parts = partsOf(open); !parts.empty();
         parts = partsOf(parts.front()))
      chain.push_back(parts.front());
    Searched out;
    std::size_t largest = chain.size();
    while (largest > 0 && isEmbedded(chain[largest - 1], borders, out.in_vain)) --largest;
    if (largest < chain.size()) {
      take(chain[largest], borders);
      const Region region = regionOf(chain[largest]);
      out.embedded = region.last - region.first;
      out.in_vain = 0;
    }
    for (std::size_t i = 0; i < largest; ++i)
      for (const OpenNode& part : partsOf(chain[i]))
        if (i + 1 == chain.size() || part.node != chain[i + 1].node)
          out.rest.push_back(part);
    return out;
  }

 private:
  /// The children that have enough triangles and are not proved already.
  std::vector<OpenNode> partsOf(const OpenNode& open) const {
    std::vector<OpenNode> parts;
    forEachPart(tree_, open.node, open.last, least_triangles_,
                [&](std::int32_t child, std::uint32_t last) {
                  if (!found_.nodes[static_cast<std::size_t>(child)])
                    parts.push_back({child, last});
                });
    return parts;
  }

  Region regionOf(const OpenNode& open) const {
    return deformable::regionOf(tree_, open.node, open.last);
  }

  const RegionBorder& borderOf(const OpenNode& open, BorderSearch& borders) const {
    return tree_.regionBorders().of(open.node,
                                    [&] { return borders.finder.find(regionOf(open)); });
  }

  bool isEmbedded(const OpenNode& open, BorderSearch& borders, std::size_t& in_vain) {
    const Region region = regionOf(open);
    const std::uint32_t directions = faced_.of(region.first, region.last);
    if (directions == 0) return false;
    const RegionBorder& border = borderOf(open, borders);
    if (border.size() > 0 && borders.proof.isEmbedded(border, directions)) {
      found_.directions[static_cast<std::size_t>(open.node)] =
          static_cast<std::uint8_t>(borders.proof.direction());
      return true;
    }
    in_vain += region.last - region.first;
    return false;
  }

  /// Records a node as a region, and its inside vertices. These have a closed fan, no
  /// border passes them, and no triangle before the region has them.
  void take(const OpenNode& open, BorderSearch& borders) {
    assert(!found_.nodes[static_cast<std::size_t>(open.node)]);
    assert(found_.directions[static_cast<std::size_t>(open.node)] < 2 * kNumAxes);
    found_.nodes[static_cast<std::size_t>(open.node)] = 1;
    const Region region = regionOf(open);
    for (std::uint32_t v = region.first_place; v < region.last_place; ++v)
      found_.interior[v] = tree_.fans()[v].is_closed;
    for (const std::uint32_t v : borderOf(open, borders).points) {
      assert(v < region.last_place);
      if (v >= region.first_place) found_.interior[v] = 0;
    }
  }

  const MovingKdopTree& tree_;
  std::uint32_t least_triangles_;
  FacedDirections faced_;
  EmbeddedRegions& found_;
};

}  // namespace

void addEmbeddedRegions(const MovingKdopTree& tree, const Kernels& kernels,
                        int num_threads, EmbeddedRegions& found,
                        std::uint32_t least_triangles) {
  assert(tree.numNodes() > 0 && least_triangles > 0 && found.isOf(tree));
  RegionSearch regions(tree, kernels, least_triangles, found);
  // Two open nodes have no common triangle, and no vertex is written for both.
  constexpr std::size_t kTasks = 64;
  // The open nodes are from all parts of the mesh. If most of them are tested in vain,
  // the search stops.
  const std::size_t spare = 16 * std::size_t{least_triangles};
  const auto known = std::count(found.interior.begin(), found.interior.end(), 1);
  // A closed surface has about twice as many triangles as vertices.
  std::size_t embedded = 2 * static_cast<std::size_t>(known), in_vain = 0;
  std::vector<OpenNode> open = regions.roots();
  while (!open.empty() && in_vain <= spare + 2 * embedded) {
    std::vector<Searched> searched(open.size());
    parallelForBlocks(open.size(), open.size() / kTasks + 1, num_threads,
                      [&](std::size_t i, std::size_t last) {
                        BorderSearch borders(tree, kernels);
                        for (; i < last; ++i)
                          searched[i] = regions.search(open[i], borders);
                      });
    open.clear();
    for (const Searched& s : searched) {
      open.insert(open.end(), s.rest.begin(), s.rest.end());
      embedded += s.embedded;
      in_vain += s.in_vain;
    }
  }
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
