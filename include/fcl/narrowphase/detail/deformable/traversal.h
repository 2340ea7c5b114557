// SPDX-License-Identifier: BSD-3-Clause
//
// One traversal for a pair of trees and for a tree with itself.
#ifndef FCL_NARROWPHASE_DETAIL_DEFORMABLE_TRAVERSAL_H
#define FCL_NARROWPHASE_DETAIL_DEFORMABLE_TRAVERSAL_H

#include <cstdint>
#include <utility>
#include <vector>

#include "fcl/math/bv/moving_kdop.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief Two nodes still to be looked into, whose boxes overlap during window; the same
/// node twice stands for a subtree with itself.
struct NodePair {
  std::int32_t a;
  std::int32_t b;
  TimeWindow window;
};

/// @brief Size by which the larger of two nodes is opened: extents along the axes at t =
/// 0.
inline float extent(const MovingKdop& box) {
  float sum = 0;
  for (int k = 0; k < 3; ++k) sum += box.t0.half[k] + box.t0.half[k + 8];
  return sum;
}

/// @brief Visits every pair of triangles whose boxes overlap at some time.
///
/// @tparam TreeA, TreeB  const MovingKdopTree or RigidTreeReader
/// @tparam kSelf  tree_b is tree_a: each unordered pair of different triangles once
/// @param shift  between the two trees' origins and translations; null for kSelf
/// @param open  scratch, reused between calls; grows with the depth of the trees only
/// @param latest  latest() is a time after which a window is of no interest
/// @param visit  visit(triangle_a, triangle_b, window) -> false to stop
/// @return number of node pairs whose boxes were compared
///
/// Pairs are opened depth first, the one whose window starts earlier first.
template <bool kSelf, typename TreeA, typename TreeB, typename Latest, typename Visit>
std::uint64_t traverse(TreeA& tree_a, TreeB& tree_b, const KdopShift* shift,
                       std::vector<NodePair>& open, Latest&& latest, Visit&& visit) {
  std::uint64_t compared = 0;
  const auto pushIfOverlapping = [&](int a, const MovingKdop& box_a, int b,
                                     const MovingKdop& box_b) {
    ++compared;
    const TimeWindow window = overlapWindow<!kSelf>(box_a, box_b, shift);
    if (!window.isEmpty()) open.push_back({a, b, window});
  };

  open.clear();
  if (kSelf)
    open.push_back({0, 0, {0.f, 1.f}});
  else
    pushIfOverlapping(0, tree_a.box(0), 0, tree_b.box(0));

  while (!open.empty()) {
    const NodePair pair = open.back();
    open.pop_back();
    if (pair.window.lo > latest()) continue;

    if (kSelf && pair.a == pair.b) {
      if (tree_a.isLeaf(pair.a)) continue;
      const int left = tree_a.leftChild(pair.a);
      open.push_back({left + 1, left + 1, {0.f, 1.f}});
      open.push_back({left, left, {0.f, 1.f}});
      pushIfOverlapping(left, tree_a.box(left), left + 1, tree_a.box(left + 1));
      continue;
    }
    const bool leaf_a = tree_a.isLeaf(pair.a), leaf_b = tree_b.isLeaf(pair.b);
    if (leaf_a && leaf_b) {
      if (!visit(tree_a.triangle(pair.a), tree_b.triangle(pair.b), pair.window))
        return compared;
      continue;
    }
    // A box may lie in a table of few (RigidTreeReader): one of a tree at a time.
    const MovingKdop& box_a = tree_a.box(pair.a);
    const MovingKdop& box_b = tree_b.box(pair.b);
    const std::size_t first = open.size();
    if (leaf_b || (!leaf_a && extent(box_a) > extent(box_b))) {
      const int left = tree_a.leftChild(pair.a);
      pushIfOverlapping(left, tree_a.box(left), pair.b, box_b);
      pushIfOverlapping(left + 1, tree_a.box(left + 1), pair.b, box_b);
    } else {
      const int left = tree_b.leftChild(pair.b);
      pushIfOverlapping(pair.a, box_a, left, tree_b.box(left));
      pushIfOverlapping(pair.a, box_a, left + 1, tree_b.box(left + 1));
    }
    if (open.size() == first + 2 && open[first].window.lo < open[first + 1].window.lo)
      std::swap(open[first], open[first + 1]);
  }
  return compared;
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
