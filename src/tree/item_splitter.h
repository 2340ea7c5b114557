// SPDX-License-Identifier: BSD-3-Clause
//
// How ranges of items are split into the nodes of a tree.
#ifndef FCL_CCD_TREE_ITEM_SPLITTER_H
#define FCL_CCD_TREE_ITEM_SPLITTER_H

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <utility>
#include <vector>

#include "tree/tree_structure.h"

namespace fcl {
namespace detail {
namespace deformable {

inline Float4 vectorOf(const TreeItem& item) {
  Float4 v;
  std::memcpy(&v, &item, sizeof(v));
  return v;
}

/// In one store: three stores take longer.
inline void setItem(const Float4& v, TreeItem& item) {
  std::memcpy(&item, &v, sizeof(v));
}

/// Bounds of points. Their fourth number has no meaning.
struct Bounds {
  static constexpr float kInf = std::numeric_limits<float>::infinity();

  Float4 lo{kInf, kInf, kInf, kInf};
  Float4 hi{-kInf, -kInf, -kInf, -kInf};

  void add(const Float4& p) { add({p, p}); }
  void add(const Bounds& b) {
    lo = lo < b.lo ? lo : b.lo;
    hi = hi > b.hi ? hi : b.hi;
  }
  float halfArea() const {
    const Float4 d = hi - lo;
    return d[0] * d[1] + d[1] * d[2] + d[2] * d[0];
  }
};

/// Divides the longest extent of items into slabs of equal width. Only every stride-th
/// item is used to find the extent.
class SplitSlabs {
 public:
  SplitSlabs(const TreeItem* items, std::size_t count, std::size_t stride, int num_slabs)
      : last_(num_slabs - 1) {
    assert(count > 0 && stride > 0 && num_slabs > 0);
    // Four bounds, each of every fourth item: with a single one each minimum would wait
    // for the previous one.
    Bounds of[4];
    std::size_t i = 0;
    for (; i + 3 * stride < count; i += 4 * stride)
      for (std::size_t k = 0; k < 4; ++k) of[k].add(vectorOf(items[i + k * stride]));
    for (; i < count; i += stride) of[0].add(vectorOf(items[i]));
    Bounds all;
    for (const Bounds& bounds : of) all.add(bounds);
    const Float4 width = all.hi - all.lo;
    for (int k = 1; k < 3; ++k)
      if (width[k] > width[axis_]) axis_ = k;
    lo_ = all.lo[axis_];
    // 64 / 2^-120 is still a float. A smaller extent counts as one point.
    if (width[axis_] >= 0x1p-120f) scale_ = static_cast<float>(num_slabs) / width[axis_];
  }

  int axis() const { return axis_; }

  /// Whether all items that were used count as one point.
  bool isOne() const { return scale_ == 0; }

  /// The slab of one of the items that were used.
  int operator()(const TreeItem& item) const {
    assert(coordinate(item) >= 0);  // not below the least of the items that were used
    return std::min(static_cast<int>(coordinate(item)), last_);
  }

  /// Whether an item lies before a slab. The slab is not the first one, and not beyond
  /// the last one.
  bool isBefore(const TreeItem& item, int slab) const {
    assert(slab > 0 && slab <= last_);
    return coordinate(item) < static_cast<float>(slab);
  }

 private:
  float coordinate(const TreeItem& item) const {
    return (item.point[axis_] - lo_) * scale_;
  }

  int axis_{0};
  int last_;
  float lo_;
  float scale_{0};
};

/// Splits ranges of items and puts the items into order. Different threads may split
/// different ranges at the same time.
class Splitter {
 public:
  /// @param ends  the end of each group of items, if there are groups: a range with
  /// several groups is split between groups
  Splitter(UninitializedVector<TreeItem> items, std::vector<std::size_t> ends)
      : items_(std::move(items)), scratch_(items_.size()), ends_(std::move(ends)) {
    assert(std::is_sorted(ends_.begin(), ends_.end()));
    assert(ends_.empty() || ends_.back() == items_.size());
  }

  struct ItemRange {
    std::size_t first, count;
  };

  std::uint32_t index(std::size_t i) const {
    assert(i < items_.size());
    return items_[i].index;
  }

  /// Splits a range into at most `max_parts` parts, and at most eight. No part is empty.
  std::size_t split(ItemRange all, std::size_t max_parts, int depth,
                    ItemRange (&out)[MovingKdopNode::kWidth]) {
    constexpr std::size_t kWidth = MovingKdopNode::kWidth;
    assert(all.count > 0 && all.first + all.count <= items_.size() && max_parts > 0);
    max_parts = std::min(max_parts, kWidth);
    std::size_t n = splitGroups(all, max_parts, out);
    assert(n <= max_parts && followEachOther(all, out, n));
    if (n > 1) return n;
    if (all.count <= max_parts) {
      for (; n < all.count; ++n) out[n] = {all.first + n, 1};
      out[0].count = 1;
      assert(followEachOther(all, out, n));
      return n;
    }
    const bool by_area = all.count > kMaxHalved && depth < kMaxAreaDepth;
    // The lowest level that has room for all items: each child is one unit.
    std::size_t unit = 1;
    while (unit * kWidth < all.count) unit *= kWidth;
    while (n < max_parts) {
      ItemRange* largest = std::max_element(
          out, out + n,
          [](const ItemRange& a, const ItemRange& b) { return a.count < b.count; });
      const ItemRange r = *largest;
      if (r.count <= (by_area ? 1 : unit)) break;
      const std::size_t first = by_area ? splitByArea(r) : splitInUnits(r, unit);
      assert(first > 0 && first < r.count);
      *largest = {r.first, first};
      out[n++] = {r.first + first, r.count - first};
    }
    // Sorted by the order of the items: neighbours in the tree are neighbours in memory.
    std::sort(out, out + n,
              [](const ItemRange& a, const ItemRange& b) { return a.first < b.first; });
    assert(followEachOther(all, out, n));
    return n;
  }

 private:
  /// Whether parts follow each other from the beginning of a range to its end. None is
  /// empty.
  [[maybe_unused]] static bool followEachOther(ItemRange all, const ItemRange* parts,
                                               std::size_t n) {
    std::size_t end = all.first;
    for (std::size_t i = 0; i < n; end += parts[i++].count)
      if (parts[i].first != end || parts[i].count == 0) return false;
    return end == all.first + all.count;
  }

  /// As split(), but between groups. A range within one group is not split.
  std::size_t splitGroups(ItemRange all, std::size_t max_parts,
                          ItemRange (&out)[MovingKdopNode::kWidth]) const {
    out[0] = all;
    const std::size_t end_of_all = all.first + all.count;
    const auto first = std::upper_bound(ends_.begin(), ends_.end(), all.first);
    if (first == ends_.end() || *first >= end_of_all) return 1;
    const auto last = std::lower_bound(first, ends_.end(), end_of_all);
    const auto groups = static_cast<std::size_t>(last - first) + 1;
    // Number of groups in a part: as many as make a tree of full nodes, if that is
    // possible.
    std::size_t unit = 1;
    while (unit * max_parts < groups) unit *= MovingKdopNode::kWidth;
    if (unit >= groups) unit = (groups + max_parts - 1) / max_parts;
    std::size_t n = 0, begin = all.first;
    for (std::size_t next = unit; begin < end_of_all; next += unit) {
      const std::size_t end =
          next < groups ? first[static_cast<std::ptrdiff_t>(next - 1)] : end_of_all;
      out[n++] = {begin, end - begin};
      begin = end;
    }
    return n;
  }

  /// Ranges of at most this many triangles are halved. This is faster than a search for
  /// the best cut, and fills the nodes. Larger ranges are split by area, which separates
  /// the objects of a scene.
  static constexpr std::size_t kMaxHalved = 512;

  /// The area is estimated from about this many triangles.
  static constexpr std::size_t kMaxSample = 512;

  /// From this depth on all ranges are halved, so that no input makes a deep tree.
  static constexpr int kMaxAreaDepth = 24;

  /// Moves the items before a slab to the front, without a change of their order, and
  /// returns their number.
  std::size_t partition(ItemRange r, const SplitSlabs& slabs, int slab) {
    TreeItem* items = items_.data() + r.first;
    TreeItem* scratch = scratch_.data() + r.first;
    std::size_t before = 0, after = 0;
    for (std::size_t i = 0; i < r.count; ++i) {
      // No branch: it would be unpredictable.
      const bool is_before = slabs.isBefore(items[i], slab);
      const Float4 item = vectorOf(items[i]);
      setItem(item, items[before]);
      setItem(item, scratch[after]);
      before += is_before;
      after += !is_before;
    }
    std::copy(scratch, scratch + after, items + before);
    return before;
  }

  /// Moves the `first` items with the lowest coordinates along the axis to the front.
  void splitAt(ItemRange r, std::size_t first) {
    constexpr int kSlabs = 64;
    const SplitSlabs slabs(items_.data() + r.first, r.count, 1, kSlabs);
    if (slabs.isOne()) return;
    std::uint32_t count[kSlabs] = {};
    for (std::size_t i = r.first; i < r.first + r.count; ++i) ++count[slabs(items_[i])];
    // The slab that contains the cut.
    std::size_t before = 0;
    int slab = 0;
    for (; before + count[slab] <= first; ++slab) before += count[slab];
    assert(slab < kSlabs);
    [[maybe_unused]] const std::size_t moved = slab > 0 ? partition(r, slabs, slab) : 0;
    assert(moved == before && before <= first);
    if (before == first) return;
    ItemRange rest{r.first + before, r.count - before};
    if (slab + 1 < kSlabs) rest.count = partition(rest, slabs, slab + 1);
    assert(first - before < rest.count);
    TreeItem* items = items_.data() + rest.first;
    std::nth_element(items, items + (first - before), items + rest.count,
                     [axis = slabs.axis()](const TreeItem& a, const TreeItem& b) {
                       return a.point[axis] != b.point[axis]
                                  ? a.point[axis] < b.point[axis]
                                  : a.index < b.index;
                     });
  }

  /// Splits a range along its longest axis at the lowest cost: the sum over both parts of
  /// the area of the centroids' box times the number of items. If all centroids count as
  /// one point, it splits in the middle. Returns the size of the first part. No part is
  /// empty.
  std::size_t splitByArea(ItemRange r) {
    constexpr int kSlabs = 8;
    const std::size_t stride = 1 + r.count / kMaxSample;
    const SplitSlabs slabs(items_.data() + r.first, r.count, stride, kSlabs);
    if (slabs.isOne()) return r.count / 2;
    Bounds bounds[kSlabs];
    std::size_t count[kSlabs] = {};
    for (std::size_t i = r.first; i < r.first + r.count; i += stride) {
      const int s = slabs(items_[i]);
      bounds[s].add(vectorOf(items_[i]));
      ++count[s];
    }
    // The first and the last slab are not empty.
    float cost_after[kSlabs];
    Bounds side;
    std::size_t n = 0;
    for (int s = kSlabs - 1; s > 0; --s) {
      side.add(bounds[s]);
      n += count[s];
      cost_after[s] = side.halfArea() * static_cast<float>(n);
    }
    side = Bounds();
    n = 0;
    int best = 1;
    float best_cost = Bounds::kInf;
    for (int s = 1; s < kSlabs; ++s) {
      side.add(bounds[s - 1]);
      n += count[s - 1];
      const float cost = side.halfArea() * static_cast<float>(n) + cost_after[s];
      if (cost < best_cost) {
        best_cost = cost;
        best = s;
      }
    }
    return partition(r, slabs, best);
  }

  /// Splits a range near the middle. The first part is a multiple of `unit`, so that the
  /// nodes of lower levels are full.
  std::size_t splitInUnits(ItemRange r, std::size_t unit) {
    const std::size_t units = (r.count + unit - 1) / unit;
    const std::size_t first = units / 2 * unit;
    splitAt(r, first);
    return first;
  }

  UninitializedVector<TreeItem> items_;
  UninitializedVector<TreeItem> scratch_;
  std::vector<std::size_t> ends_;
};

/// @brief A range of items, the node that it becomes, and the first leaf of this node.
struct OpenItems {
  Splitter::ItemRange range;
  std::size_t node, first_leaf;
  int depth;
};

/// @brief Splits a range until no part is larger than max_left.
/// @param max_parts  the largest number of children of the range's own node
/// @param nodes  has the range's own node already; the nodes below it are added
/// @return the ranges that are not split, in the order of a walk
std::vector<OpenItems> splitRange(Splitter& splitter, const OpenItems& root,
                                  std::size_t max_left, std::size_t max_parts,
                                  std::vector<TreeChildren>& nodes,
                                  std::vector<std::uint32_t>& leaves);

/// @brief Splits items into a tree. Its leaves are the indices of the items. At the top
/// it splits by surface area, at the bottom into halves, so that the lowest nodes are
/// full.
/// @param ends  as groupItems() returns it: each part of the tree has several whole
/// groups, or lies within one group
/// @param max_parts  the largest number of children of the root
/// @param depth  the depth of the root in the whole tree: deep down all ranges are halved
TreeStructure splitItems(UninitializedVector<TreeItem> items,
                         std::vector<std::size_t> ends, std::size_t max_parts, int depth);

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
