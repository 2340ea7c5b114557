// SPDX-License-Identifier: BSD-3-Clause
#include "tree_builder.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>

#include "parallel.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();

using Item = TreeItem;

Float4 vectorOf(const Item& item) {
  Float4 v;
  __builtin_memcpy(&v, &item, sizeof(v));
  return v;
}

/// At once: three parts of it take longer.
void setItem(const Float4& v, Item& item) { __builtin_memcpy(&item, &v, sizeof(v)); }

struct Bounds {
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

/// Cuts the longest extent of items, of which every stride-th is looked at, into slabs of
/// one width.
class Slabs {
 public:
  Slabs(const Item* items, std::size_t count, std::size_t stride, int num_slabs)
      : last_(num_slabs - 1) {
    // Of every fourth item apart: one minimum would wait for the one before.
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
    // 64 / 2^-120 is still a float; what is less wide counts as one place.
    if (width[axis_] >= 0x1p-120f) scale_ = static_cast<float>(num_slabs) / width[axis_];
  }

  int axis() const { return axis_; }

  /// Whether all items that were looked at fall together.
  bool isOne() const { return scale_ == 0; }

  /// The slab of an item that was looked at.
  int operator()(const Item& item) const {
    return std::min(static_cast<int>(coordinate(item)), last_);
  }

  /// Whether an item lies before a slab, which is neither the first nor beyond the last.
  bool isBefore(const Item& item, int slab) const {
    return coordinate(item) < static_cast<float>(slab);
  }

 private:
  float coordinate(const Item& item) const { return (item.place[axis_] - lo_) * scale_; }

  int axis_{0};
  int last_;
  float lo_;
  float scale_{0};
};

/// Splits ranges of items, which are brought into order; different ranges at the same
/// time.
class Splitter {
 public:
  explicit Splitter(UninitializedVector<Item> items)
      : items_(std::move(items)), scratch_(items_.size()) {}

  struct Range {
    std::size_t first, count;
  };

  std::uint32_t index(std::size_t i) const { return items_[i].index; }

  /// Splits a range into at most `max_parts`, which are no more than eight. None is
  /// empty.
  std::size_t split(Range all, std::size_t max_parts, int depth,
                    Range (&out)[MovingKdopNode::kWidth]) {
    constexpr std::size_t kWidth = MovingKdopNode::kWidth;
    std::size_t n = 1;
    out[0] = all;
    max_parts = std::min(max_parts, kWidth);
    if (all.count <= max_parts) {
      for (; n < all.count; ++n) out[n] = {all.first + n, 1};
      out[0].count = 1;
      return n;
    }
    const bool by_area = all.count > kMaxHalved && depth < kMaxAreaDepth;
    // The lowest level that holds all: each child is one unit.
    std::size_t unit = 1;
    while (unit * kWidth < all.count) unit *= kWidth;
    while (n < max_parts) {
      Range* largest = std::max_element(
          out, out + n, [](const Range& a, const Range& b) { return a.count < b.count; });
      const Range r = *largest;
      if (r.count <= (by_area ? 1 : unit)) break;
      const std::size_t first = by_area ? splitByArea(r) : splitInUnits(r, unit);
      *largest = {r.first, first};
      out[n++] = {r.first + first, r.count - first};
    }
    // In the order of the items: neighbours in the tree are neighbours in memory.
    std::sort(out, out + n,
              [](const Range& a, const Range& b) { return a.first < b.first; });
    return n;
  }

 private:
  /// Up to so many triangles are halved, which is faster than looking for the best place
  /// and fills the nodes; above, area decides (objects of a scene come apart).
  static constexpr std::size_t kMaxHalved = 512;

  /// Area is estimated from about so many triangles.
  static constexpr std::size_t kMaxSample = 512;

  /// From this depth on everything is halved: no input makes a deep tree.
  static constexpr int kMaxAreaDepth = 24;

  /// Moves the items before a slab to the front, in the order that they have, and returns
  /// how many there are.
  std::size_t partition(Range r, const Slabs& slabs, int slab) {
    Item* items = items_.data() + r.first;
    Item* scratch = scratch_.data() + r.first;
    std::size_t before = 0, after = 0;
    for (std::size_t i = 0; i < r.count; ++i) {
      // No branch: nobody could foretell it.
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

  /// Moves the `first` items that lie lowest along the axis to the front.
  void splitAt(Range r, std::size_t first) {
    constexpr int kSlabs = 64;
    const Slabs slabs(items_.data() + r.first, r.count, 1, kSlabs);
    if (slabs.isOne()) return;
    std::uint32_t count[kSlabs] = {};
    for (std::size_t i = r.first; i < r.first + r.count; ++i) ++count[slabs(items_[i])];
    // The slab where the cut is.
    std::size_t before = 0;
    int slab = 0;
    for (; before + count[slab] <= first; ++slab) before += count[slab];
    if (slab > 0) partition(r, slabs, slab);
    if (before == first) return;
    Range rest{r.first + before, r.count - before};
    if (slab + 1 < kSlabs) rest.count = partition(rest, slabs, slab + 1);
    Item* items = items_.data() + rest.first;
    std::nth_element(items, items + (first - before), items + rest.count,
                     [axis = slabs.axis()](const Item& a, const Item& b) {
                       return a.place[axis] != b.place[axis]
                                  ? a.place[axis] < b.place[axis]
                                  : a.index < b.index;
                     });
  }

  /// Splits a range where area times count of the parts' centroid boxes, along the
  /// longest axis, is least; in the middle where all centroids fall together. Returns the
  /// size of the first part; none is empty.
  std::size_t splitByArea(Range r) {
    constexpr int kSlabs = 8;
    const std::size_t stride = 1 + r.count / kMaxSample;
    const Slabs slabs(items_.data() + r.first, r.count, stride, kSlabs);
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
    float best_cost = kInf;
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

  /// Splits a range near the middle, the first part a multiple of `unit`, so that units
  /// of the lower levels come out full.
  std::size_t splitInUnits(Range r, std::size_t unit) {
    const std::size_t units = (r.count + unit - 1) / unit;
    const std::size_t first = units / 2 * unit;
    splitAt(r, first);
    return first;
  }

  UninitializedVector<Item> items_;
  UninitializedVector<Item> scratch_;
};

/// Where most of a mesh is: the median of a few vertices' coordinates.
void findMiddle(const Triangle* triangles, std::size_t num_triangles,
                const VertexFrames& frames, double (&middle)[3]) {
  constexpr std::size_t kSample = 31;
  double x[3][kSample];
  for (std::size_t i = 0; i < kSample; ++i) {
    std::uint32_t v[3];
    vertexIds(triangles[i * num_triangles / kSample], v);
    double p[3];
    frames.at(0, v[0], p);
    for (int k = 0; k < 3; ++k) x[k][i] = std::isfinite(p[k]) ? p[k] : 0;
  }
  for (int k = 0; k < 3; ++k) {
    std::nth_element(x[k], x[k] + kSample / 2, x[k] + kSample);
    middle[k] = x[k][kSample / 2];
  }
}

/// Centroids relative to the middle, so that far from the origin nothing is lost.
UninitializedVector<Item> itemsOf(const Triangle* triangles, std::size_t num_triangles,
                                  const VertexFrames& frames, int num_threads) {
  constexpr std::size_t kBlock = 8192;
  double middle[3];
  findMiddle(triangles, num_triangles, frames, middle);
  UninitializedVector<Float4> places(frames.size());
  parallelForBlocks(frames.size(), kBlock, num_threads,
                    [&](std::size_t i, std::size_t last) {
                      for (; i < last; ++i) {
                        double p[3];
                        frames.at(0, i, p);
                        Float4 place{};
                        for (int k = 0; k < 3; ++k) place[k] = placeOf(p[k] - middle[k]);
                        places[i] = place;
                      }
                    });
  UninitializedVector<Item> items(num_triangles);
  parallelForBlocks(
      num_triangles, kBlock, num_threads, [&](std::size_t i, std::size_t last) {
        for (; i < last; ++i) {
          std::uint32_t v[3];
          vertexIds(triangles[i], v);
          const Float4 sum = places[v[0]] + places[v[1]] + places[v[2]];
          items[i] = {{sum[0], sum[1], sum[2]}, static_cast<std::uint32_t>(i)};
        }
      });
  return items;
}

/// A range of items, the node that it becomes, and the first leaf of that.
struct Open {
  Splitter::Range range;
  std::size_t node, first_leaf;
  int depth;
};

/// Splits a range, down to ranges of which none is larger than max_left.
/// @param max_parts  of the range itself
/// @param nodes  the range's own is there; those below are added
/// @return the ranges that are left, in the order of a walk
std::vector<Open> split(Splitter& splitter, const Open& root, std::size_t max_left,
                        std::size_t max_parts, std::vector<TreeChildren>& nodes,
                        std::vector<std::uint32_t>& leaves) {
  constexpr std::size_t kWidth = MovingKdopNode::kWidth;
  std::vector<Open> open{root}, left;
  while (!open.empty()) {
    const Open o = open.back();
    open.pop_back();
    if (o.range.count <= max_left) {
      left.push_back(o);
      continue;
    }
    Splitter::Range parts[kWidth];
    const std::size_t n =
        splitter.split(o.range, o.node == root.node ? max_parts : kWidth, o.depth, parts);
    TreeChildren node{};
    node.count = static_cast<std::int32_t>(n);
    std::size_t leaf = o.first_leaf;
    for (std::size_t i = 0; i < n; ++i) {
      if (parts[i].count > 1) continue;
      leaves[leaf] = splitter.index(parts[i].first);
      node.child[i] = ~static_cast<std::int32_t>(leaf++);
    }
    // The first child is the first to go on with.
    const std::size_t num_nodes = nodes.size();
    for (std::size_t i = 0; i < n; ++i) {
      if (parts[i].count == 1) continue;
      node.child[i] = static_cast<std::int32_t>(nodes.size());
      open.push_back({parts[i], nodes.size(), leaf, o.depth + 1});
      leaf += parts[i].count;
      nodes.emplace_back();
    }
    std::reverse(open.end() - static_cast<std::ptrdiff_t>(nodes.size() - num_nodes),
                 open.end());
    nodes[o.node] = node;
  }
  return left;
}

}  // namespace

TreeStructure splitItems(UninitializedVector<TreeItem> items, std::size_t max_parts,
                         int depth) {
  TreeStructure tree;
  const std::size_t count = items.size();
  tree.leaves.resize(count);
  Splitter splitter(std::move(items));
  std::vector<TreeChildren> nodes(1);
  split(splitter, {{0, count}, 0, 0, depth}, 0, max_parts, nodes, tree.leaves);
  tree.nodes.assign(nodes.begin(), nodes.end());
  return tree;
}

TreeStructure splitTriangles(const Triangle* triangles, std::size_t num_triangles,
                             const VertexFrames& frames, int num_threads) {
  // A task: so many triangles at most.
  constexpr std::size_t kMaxTask = 8192;
  constexpr std::size_t kWidth = MovingKdopNode::kWidth;
  TreeStructure tree;
  tree.leaves.resize(num_triangles);
  Splitter splitter(itemsOf(triangles, num_triangles, frames, num_threads));
  std::vector<TreeChildren> top(1);
  const std::vector<Open> roots =
      split(splitter, {{0, num_triangles}, 0, 0, 0}, kMaxTask, kWidth, top, tree.leaves);
  std::vector<std::vector<TreeChildren>> subtrees(roots.size());
  parallelFor(roots.size(), num_threads, [&](std::size_t i) {
    subtrees[i].reserve(roots[i].range.count / 4);
    subtrees[i].emplace_back();
    Open root = roots[i];
    root.node = 0;
    split(splitter, root, 0, kWidth, subtrees[i], tree.leaves);
  });

  // The nodes of a subtree below its root go where the walk comes to it.
  std::size_t num_nodes = top.size() - roots.size();
  for (const std::vector<TreeChildren>& subtree : subtrees) num_nodes += subtree.size();
  tree.nodes.resize(num_nodes);
  struct Numbered {
    std::size_t from, to;
  };
  std::vector<Numbered> open{{0, 0}};
  std::size_t next = 1, num_met = 0;
  while (!open.empty()) {
    const Numbered o = open.back();
    open.pop_back();
    const bool is_root = num_met < roots.size() && roots[num_met].node == o.from;
    const std::vector<TreeChildren>& from = is_root ? subtrees[num_met] : top;
    tree.nodes[o.to] = from[is_root ? 0 : o.from];
    const std::size_t num_open = open.size();
    const auto shift = static_cast<std::int32_t>(next) - 1;
    for (std::int32_t& child : tree.nodes[o.to].child) {
      if (child <= 0) continue;
      const auto to = is_root ? child + shift : static_cast<std::int32_t>(next++);
      if (!is_root)
        open.push_back({static_cast<std::size_t>(child), static_cast<std::size_t>(to)});
      child = to;
    }
    std::reverse(open.begin() + static_cast<std::ptrdiff_t>(num_open), open.end());
    if (!is_root) continue;
    for (std::size_t i = 1; i < from.size(); ++i) {
      tree.nodes[next] = from[i];
      for (std::int32_t& child : tree.nodes[next].child)
        if (child > 0) child += shift;
      ++next;
    }
    ++num_met;
  }
  return tree;
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
