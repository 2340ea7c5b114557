// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_TREE_BORDER_FINDER_H
#define FCL_CCD_TREE_BORDER_FINDER_H

#include <cassert>
#include <cstdint>
#include <vector>

#include "tree/moving_kdop_tree.h"
#include "tree/region_borders.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief Triangles [first, last) of a tree, and the vertices [first_place, last_place)
/// that no triangle before them has.
struct Region {
  std::uint32_t first, last, first_place, last_place;
};

/// @param node  a node of the tree
/// @param last  the end of the triangles below it
inline Region regionOf(const MovingKdopTree& tree, std::int32_t node,
                       std::uint32_t last) {
  const std::uint32_t first = tree.firstTriangle(node);
  assert(first < last && last <= tree.triangles().size());
  return {first, last, tree.placesBefore(first), tree.placesBefore(last)};
}

/// @brief Calls visit(child, last) for each child of a node that is not a triangle and
/// has enough triangles, the last child first.
/// @param last  the end of the triangles below the node, then of those below the child
template <typename Visit>
void forEachPart(const MovingKdopTree& tree, std::int32_t parent, std::uint32_t last,
                 std::uint32_t least_triangles, Visit&& visit) {
  const MovingKdopNode& node = tree.node(parent);
  for (int lane = node.count; lane-- > 0;) {
    if (node.isTriangle(lane)) continue;
    const std::uint32_t first = tree.firstTriangle(node.child[lane]);
    assert(first < last);
    if (last - first >= least_triangles) visit(node.child[lane], last);
    last = first;
  }
}

/// @brief Finds the border of one region after another.
class BorderFinder {
 public:
  explicit BorderFinder(const MovingKdopTree& tree) : tree_(tree) {}

  RegionBorder find(const Region& region);

 private:
  struct Edge {
    std::uint32_t from, to;
  };

  void listEdges(const Region& region);
  bool cancelOpposites();
  bool linkPaths();
  RegionBorder border() const;

  const MovingKdopTree& tree_;
  /// For each vertex of the region, the number of the region's triangles that have it.
  /// Then whether an edge of it may be left.
  std::vector<std::uint32_t> counts_;
  /// Edges as sortable numbers: the lower place, the higher place, and one bit, which is
  /// set if the edge starts at the higher place.
  std::vector<std::uint64_t> keys_;
  std::vector<Edge> unlinked_;
  std::vector<std::uint8_t> taken_;
  /// The edges of all paths in order, and the first edge of each path.
  std::vector<Edge> edges_;
  std::vector<std::uint32_t> paths_;
  bool is_one_loop_{false};
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
