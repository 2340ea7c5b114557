// SPDX-License-Identifier: BSD-3-Clause
#include "fcl/narrowphase/detail/deformable/moving_kdop_tree.h"

#include <algorithm>
#include <limits>
#include <numeric>

namespace fcl {
namespace detail {
namespace deformable {
namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();

struct Bounds {
  float lo[3]{kInf, kInf, kInf};
  float hi[3]{-kInf, -kInf, -kInf};

  void add(const float (&p)[3]) {
    for (int k = 0; k < 3; ++k) {
      lo[k] = std::min(lo[k], p[k]);
      hi[k] = std::max(hi[k], p[k]);
    }
  }
  void add(const Bounds& b) {
    for (int k = 0; k < 3; ++k) {
      lo[k] = std::min(lo[k], b.lo[k]);
      hi[k] = std::max(hi[k], b.hi[k]);
    }
  }
  float halfArea() const {
    const float x = hi[0] - lo[0], y = hi[1] - lo[1], z = hi[2] - lo[2];
    return x * y + y * z + z * x;
  }
};

struct Item {
  float centroid[3];
  std::uint32_t triangle;
};

constexpr int kBins = 8;

int binOf(float c, float lo, float scale) {
  return std::max(0, std::min(kBins - 1, static_cast<int>((c - lo) * scale)));
}

/// Largest extent of the centroids, and along which axis.
struct Widest {
  int axis;
  float lo, width;
};

Widest widestAxis(const Item* items, std::size_t count) {
  Bounds all;
  for (std::size_t i = 0; i < count; ++i) all.add(items[i].centroid);
  int axis = 0;
  for (int k = 1; k < 3; ++k)
    if (all.hi[k] - all.lo[k] > all.hi[axis] - all.lo[axis]) axis = k;
  return {axis, all.lo[axis], all.hi[axis] - all.lo[axis]};
}

/// Moves the `first` items that lie lowest along the axis to the front.
void splitAt(Item* items, std::size_t count, std::size_t first, int axis) {
  std::nth_element(
      items, items + first, items + count, [axis](const Item& a, const Item& b) {
        return a.centroid[axis] != b.centroid[axis] ? a.centroid[axis] < b.centroid[axis]
                                                    : a.triangle < b.triangle;
      });
}

/// Splits items where area times count of the parts' centroid boxes, along the longest
/// axis, is least; in the middle where all centroids fall together. Returns the size of
/// the first part; none is empty.
std::size_t splitByArea(Item* items, std::size_t count) {
  const Widest widest = widestAxis(items, count);
  const int axis = widest.axis;
  if (widest.width > 0 && widest.width < kInf) {
    const float lo = widest.lo, scale = static_cast<float>(kBins) / widest.width;
    Bounds bin_bounds[kBins];
    std::size_t bin_count[kBins] = {};
    for (std::size_t i = 0; i < count; ++i) {
      const int b = binOf(items[i].centroid[axis], lo, scale);
      bin_bounds[b].add(items[i].centroid);
      ++bin_count[b];
    }
    float right_cost[kBins];
    Bounds side;
    std::size_t n = 0;
    for (int b = kBins - 1; b > 0; --b) {
      side.add(bin_bounds[b]);
      n += bin_count[b];
      right_cost[b] = n ? side.halfArea() * static_cast<float>(n) : kInf;
    }
    side = Bounds();
    n = 0;
    int best = 0;
    float best_cost = kInf;
    for (int b = 1; b < kBins; ++b) {
      side.add(bin_bounds[b - 1]);
      n += bin_count[b - 1];
      const float cost =
          n ? side.halfArea() * static_cast<float>(n) + right_cost[b] : kInf;
      if (cost < best_cost) {
        best_cost = cost;
        best = b;
      }
    }
    if (best > 0) {
      const Item* middle = std::partition(items, items + count, [&](const Item& item) {
        return binOf(item.centroid[axis], lo, scale) < best;
      });
      const auto first = static_cast<std::size_t>(middle - items);
      if (first > 0 && first < count) return first;
    }
  }
  splitAt(items, count, count / 2, axis);
  return count / 2;
}

/// Splits items near the middle, the first part a multiple of `unit`, so that units of
/// the lower levels come out full.
std::size_t splitInUnits(Item* items, std::size_t count, std::size_t unit) {
  const std::size_t units = (count + unit - 1) / unit;
  const std::size_t first = units / 2 * unit;
  splitAt(items, count, first, widestAxis(items, count).axis);
  return first;
}

/// Up to so many triangles are halved, which is faster than looking for the best place
/// and fills the nodes; above, area decides (objects of a scene come apart).
constexpr std::size_t kMaxHalved = 512;

/// From this depth on everything is halved: no input makes a deep tree.
constexpr int kMaxAreaDepth = 24;

struct Range {
  std::size_t first, count;
};

/// Splits a range into at most eight, the largest first.
std::size_t splitInEight(Item* items, Range all, int depth,
                         Range (&out)[MovingKdopNode::kWidth]) {
  constexpr std::size_t kWidth = MovingKdopNode::kWidth;
  const bool by_area = all.count > kMaxHalved && depth < kMaxAreaDepth;
  // The lowest level that holds all: each child is one unit.
  std::size_t unit = 1;
  while (unit * kWidth < all.count) unit *= kWidth;
  out[0] = all;
  std::size_t n = 1;
  while (n < kWidth) {
    Range* largest = std::max_element(
        out, out + n, [](const Range& a, const Range& b) { return a.count < b.count; });
    const Range r = *largest;
    if (r.count <= (by_area ? 1 : unit)) break;
    const std::size_t first = by_area ? splitByArea(items + r.first, r.count)
                                      : splitInUnits(items + r.first, r.count, unit);
    *largest = {r.first, first};
    out[n++] = {r.first + first, r.count - first};
  }
  // In the order of the items: neighbours in the tree are neighbours in memory.
  std::sort(out, out + n,
            [](const Range& a, const Range& b) { return a.first < b.first; });
  return n;
}

Float4 larger(Float4 x, Float4 y) { return x > y ? x : y; }

/// The smallest box around both.
void merge(const Kdop16& a, const Kdop16& b, Kdop16& out) {
  for (int q = 0; q < 4; ++q) {
    const Float4 most = larger(quad(a, q), quad(b, q));
    __builtin_memcpy(out.half + 4 * q, &most, sizeof(most));
  }
}

void merge(const MovingKdop& a, const MovingKdop& b, MovingKdop& out) {
  merge(a.t0, b.t0, out.t0);
  merge(a.t1, b.t1, out.t1);
}

/// The largest of a row; the lanes that are not in use are below all others.
float largest(const float (&row)[MovingKdopNode::kWidth]) {
  Float4 a, b;
  __builtin_memcpy(&a, row, sizeof(a));
  __builtin_memcpy(&b, row + 4, sizeof(b));
  const Float4 m = larger(a, b);
  return std::max(std::max(m[0], m[1]), std::max(m[2], m[3]));
}

/// The smallest box around all children.
MovingKdop bound(const MovingKdopNode& node) {
  MovingKdop out;
  for (int r = 0; r < 16; ++r) {
    out.t0.half[MovingKdopNode::halfAxis(r)] = largest(node.rows[r].t0);
    out.t1.half[MovingKdopNode::halfAxis(r)] = largest(node.rows[r].t1);
  }
  return out;
}

}  // namespace

void fitPoint(const double* point, const double (&origin)[3], float pad, Kdop16& out) {
  const double p[3] = {point[0] - origin[0], point[1] - origin[1], point[2] - origin[2]};
  double d[8];
  kdopCoordinates(p, d);
  for (int j = 0; j < 8; ++j) {
    out.half[j] = roundUp(-d[j], pad);
    out.half[j + 8] = roundUp(d[j], pad);
  }
}

void MovingKdopTree::build(const std::vector<MeshTriangle>& triangles,
                           const VertexFrames& frames) {
  std::vector<Item> items(triangles.size());
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    double sum[3] = {0, 0, 0};
    for (const std::uint32_t v : triangles[i].v) {
      double p[3];
      frames.at(0, v, p);
      for (int k = 0; k < 3; ++k) sum[k] += p[k] / 3;
    }
    for (int k = 0; k < 3; ++k)
      items[i].centroid[k] = static_cast<float>(
          std::max(-1e37, std::min(1e37, sum[k])));  // widths must not overflow
    items[i].triangle = static_cast<std::uint32_t>(i);
  }

  struct Open {
    Range range;
    std::size_t node;
    int depth;
  };
  std::vector<Children> nodes(1);
  std::vector<Open> open{{{0, items.size()}, 0, 0}};
  while (!open.empty()) {
    const Open o = open.back();
    open.pop_back();
    Range parts[MovingKdopNode::kWidth];
    const std::size_t n = splitInEight(items.data(), o.range, o.depth, parts);
    nodes[o.node].count = static_cast<std::int32_t>(n);
    for (std::size_t i = n; i-- > 0;) {
      std::int32_t& child = nodes[o.node].child[i];
      if (parts[i].count == 1) {
        child = ~static_cast<std::int32_t>(items[parts[i].first].triangle);
        continue;
      }
      child = static_cast<std::int32_t>(nodes.size());
      open.push_back({parts[i], nodes.size(), o.depth + 1});
      nodes.emplace_back();
    }
  }
  number(nodes, triangles, frames.size());
}

void MovingKdopTree::build(const std::vector<MeshTriangle>& triangles,
                           std::size_t num_vertices,
                           const std::vector<std::int32_t>& links) {
  struct Open {
    std::int32_t link;
    std::size_t node;
  };
  std::vector<Children> nodes(1);
  std::vector<Open> open{{0, 0}};
  while (!open.empty()) {
    const Open o = open.back();
    open.pop_back();
    std::int32_t binary[MovingKdopNode::kWidth];
    const int n = openBinary(o.link, binary, nodes[o.node].child, [&](std::int32_t i) {
      return links[static_cast<std::size_t>(i)];
    });
    nodes[o.node].count = n;
    for (int i = n; i-- > 0;) {
      const std::int32_t child = nodes[o.node].child[i];
      if (child < 0) continue;
      nodes[o.node].child[i] = static_cast<std::int32_t>(nodes.size());
      open.push_back({child, nodes.size()});
      nodes.emplace_back();
    }
  }
  number(nodes, triangles, num_vertices);
}

/// Gives triangles and vertices their places: in the order of a walk through the tree.
void MovingKdopTree::number(const std::vector<Children>& nodes,
                            const std::vector<MeshTriangle>& triangles,
                            std::size_t num_vertices) {
  std::vector<MovingKdopNode>(nodes.size()).swap(nodes_);
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    std::copy(nodes[i].child, nodes[i].child + nodes[i].count, nodes_[i].child);
    nodes_[i].count = nodes[i].count;
  }
  constexpr std::uint32_t kNoPlace = MovingKdopNode::kNoPlace;
  std::vector<std::uint32_t> place_of(num_vertices, kNoPlace);
  triangles_.clear();
  triangles_.reserve(triangles.size());
  vertex_ids_.clear();
  vertex_ids_.reserve(num_vertices);
  std::vector<std::int32_t> open{0};
  while (!open.empty()) {
    MovingKdopNode& node = nodes_[static_cast<std::size_t>(open.back())];
    open.pop_back();
    node.clearRest();
    std::fill(node.places[0], node.places[0] + 3 * MovingKdopNode::kWidth, kNoPlace);
    for (int i = node.count; i-- > 0;)
      if (!node.isTriangle(i)) open.push_back(node.child[i]);
    for (int i = 0; i < node.count; ++i) {
      if (!node.isTriangle(i)) continue;
      const auto index = static_cast<std::uint32_t>(node.triangle(i));
      const MeshTriangle& t = triangles[index];
      TreeTriangle out{{}, t.owned, {t.v[0], t.v[1], t.v[2]}, index};
      for (int k = 0; k < 3; ++k) {
        std::uint32_t& place = place_of[t.v[k]];
        if (place == kNoPlace) {
          place = static_cast<std::uint32_t>(vertex_ids_.size());
          vertex_ids_.push_back(t.v[k]);
        }
        out.place[k] = node.places[k][i] = place;
      }
      node.child[i] = ~static_cast<std::int32_t>(triangles_.size());
      triangles_.push_back(out);
    }
  }
  vertices_.resize(vertex_ids_.size());
  fans_ = VertexFans(triangles_, vertex_ids_.size());
}

void MovingKdopTree::refit(const VertexFrames& frames) {
  double lo[3], hi[3];
  std::fill(lo, lo + 3, std::numeric_limits<double>::infinity());
  std::fill(hi, hi + 3, -std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < vertices_.size(); ++i) {
    TreeVertex& v = vertices_[i];
    const VertexPath path = frames[vertex_ids_[i]];
    for (int k = 0; k < 3; ++k) {
      v.t0[k] = path.t0[k];
      v.t1[k] = path.t1[k];
      lo[k] = std::min(lo[k], std::min(path.t0[k], path.t1[k]));
      hi[k] = std::max(hi[k], std::max(path.t0[k], path.t1[k]));
    }
  }
  reach_ = 0;
  for (int k = 0; k < 3; ++k) {
    origin_[k] = 0.5 * lo[k] + 0.5 * hi[k];
    reach_ = std::max(reach_, std::max(hi[k] - origin_[k], origin_[k] - lo[k]));
  }
  // A coordinate relative to the origin is rounded by 2^-53 of itself, a sum of two by as
  // much again of the sum: together less than 2^-50 of the reach.
  const float pad = roundUp(reach_ * 0x1p-50, 0.f);
  for (TreeVertex& v : vertices_) {
    fitPoint(v.t0, origin_, pad, v.box.t0);
    fitPoint(v.t1, origin_, pad, v.box.t1);
  }

  for (std::size_t i = nodes_.size(); i-- > 0;) {
    MovingKdopNode& node = nodes_[i];
    for (int lane = 0; lane < node.count; ++lane) {
      MovingKdop box;
      if (node.isTriangle(lane)) {
        const TreeTriangle& t = triangles_[static_cast<std::size_t>(node.triangle(lane))];
        merge(vertices_[t.place[0]].box, vertices_[t.place[1]].box, box);
        merge(box, vertices_[t.place[2]].box, box);
      } else {
        box = bound(nodes_[static_cast<std::size_t>(node.child[lane])]);
      }
      node.setBox(lane, box);
    }
  }
}

std::size_t MovingKdopTree::memUsage() const {
  return nodes_.capacity() * sizeof(nodes_[0]) +
         triangles_.capacity() * sizeof(triangles_[0]) +
         vertices_.capacity() * sizeof(vertices_[0]) +
         vertex_ids_.capacity() * sizeof(vertex_ids_[0]) + fans_.memUsage();
}

KdopShift relativeShift(const double (&origin_a)[3], const double (&translation_a)[2][3],
                        double reach_a, const double (&origin_b)[3],
                        const double (&translation_b)[2][3], double reach_b) {
  KdopShift shift;
  for (int frame = 0; frame < 2; ++frame) {
    double offset[3], d[8];
    double size = 0;  // of every number that enters a moved coordinate
    for (int k = 0; k < 3; ++k) {
      const double a = translation_a[frame][k], b = translation_b[frame][k];
      offset[k] = (origin_a[k] - origin_b[k]) + (a - b);
      size = std::max(size, std::abs(origin_a[k]) + std::abs(origin_b[k]) + std::abs(a) +
                                std::abs(b));
    }
    kdopCoordinates(offset, d);
    size = 2 * (size + reach_a + reach_b);
    // Doubles: three roundings of the offset, one of the diagonal, and one of each posed
    // coordinate, each 2^-53 of a number below size: 2^-49 in all. Floats: in the sum of
    // box, box and shift two roundings of 2^-24, each of a number below 2 (reach_a +
    // reach_b) + |shift|, and the shift's own, which roundUp covers.
    Kdop16& out = frame == 0 ? shift.t0 : shift.t1;
    for (int j = 0; j < 8; ++j) {
      const float pad = roundUp(
          size * 0x1p-49 + (2 * (reach_a + reach_b) + std::abs(d[j])) * 0x1p-22, 0.f);
      out.half[j] = roundUp(-d[j], pad);
      out.half[j + 8] = roundUp(d[j], pad);
    }
  }
  return shift;
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
