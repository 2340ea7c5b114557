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

constexpr int kBins = 16;

int binOf(float c, float lo, float scale) {
  return std::max(0, std::min(kBins - 1, static_cast<int>((c - lo) * scale)));
}

/// Splits items into two non-empty parts and returns the size of the first. The cost is
/// area times count of the parts' centroid boxes along the longest axis; a median split
/// where all centroids fall together or the depth budget is spent.
std::size_t split(Item* items, std::size_t count, bool search) {
  Bounds all;
  for (std::size_t i = 0; i < count; ++i) all.add(items[i].centroid);
  int axis = 0;
  for (int k = 1; k < 3; ++k)
    if (all.hi[k] - all.lo[k] > all.hi[axis] - all.lo[axis]) axis = k;
  const float width = all.hi[axis] - all.lo[axis];

  if (search && count > 4 && width > 0 && width < kInf) {
    const float lo = all.lo[axis], scale = static_cast<float>(kBins) / width;
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
  std::nth_element(
      items, items + count / 2, items + count, [axis](const Item& a, const Item& b) {
        return a.centroid[axis] != b.centroid[axis] ? a.centroid[axis] < b.centroid[axis]
                                                    : a.triangle < b.triangle;
      });
  return count / 2;
}

/// The smallest box around both; a NaN, "unbounded", stays.
void merge(const Kdop16& a, const Kdop16& b, Kdop16& out) {
  for (int q = 0; q < 4; ++q) {
    const Float4 x = quad(a, q), y = quad(b, q);
    const Float4 most = ((x > y) | (x != x)) ? x : y;
    __builtin_memcpy(out.half + 4 * q, &most, sizeof(most));
  }
}

void merge(const MovingKdop& a, const MovingKdop& b, MovingKdop& out) {
  merge(a.t0, b.t0, out.t0);
  merge(a.t1, b.t1, out.t1);
}

/// Box of a point.
void fitPoint(const double (&point)[3], const double (&origin)[3], float pad,
              Kdop16& out) {
  const double p[3] = {point[0] - origin[0], point[1] - origin[1], point[2] - origin[2]};
  double d[8];
  kdopCoordinates(p, d);
  for (int j = 0; j < 8; ++j) {
    out.half[j] = roundUp(-d[j], pad);
    out.half[j + 8] = roundUp(d[j], pad);
  }
}

}  // namespace

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

  struct Range {
    std::size_t first, count;
    std::int32_t node;
    int depth;
  };
  links_.assign(1, 0);
  links_.reserve(2 * triangles.size());
  std::vector<Range> open{{0, items.size(), 0, 0}};
  while (!open.empty()) {
    const Range r = open.back();
    open.pop_back();
    auto& link = links_[static_cast<std::size_t>(r.node)];
    if (r.count == 1) {
      link = ~static_cast<std::int32_t>(items[r.first].triangle);
      continue;
    }
    const std::size_t n = split(&items[r.first], r.count, r.depth < kMaxSahDepth);
    const auto left = static_cast<std::int32_t>(links_.size());
    link = left;
    links_.resize(links_.size() + 2);
    open.push_back({r.first + n, r.count - n, left + 1, r.depth + 1});
    open.push_back({r.first, n, left, r.depth + 1});
  }
  boxes_.resize(links_.size());
}

void MovingKdopTree::setLinks(std::vector<std::int32_t> links) {
  links_ = std::move(links);
  boxes_.resize(links_.size());
}

void MovingKdopTree::refit(const std::vector<MeshTriangle>& triangles,
                           const VertexFrames& frames) {
  double lo[3], hi[3];
  std::fill(lo, lo + 3, std::numeric_limits<double>::infinity());
  std::fill(hi, hi + 3, -std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const VertexPath path = frames[i];
    for (int k = 0; k < 3; ++k) {
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

  vertex_boxes_.resize(frames.size());
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const VertexPath path = frames[i];
    fitPoint(path.t0, origin_, pad, vertex_boxes_[i].t0);
    fitPoint(path.t1, origin_, pad, vertex_boxes_[i].t1);
  }
  for (std::size_t i = links_.size(); i-- > 0;) {
    if (links_[i] < 0) {
      const MeshTriangle& t = triangles[static_cast<std::size_t>(~links_[i])];
      merge(vertex_boxes_[t.v[0]], vertex_boxes_[t.v[1]], boxes_[i]);
      merge(boxes_[i], vertex_boxes_[t.v[2]], boxes_[i]);
    } else {
      const auto left = static_cast<std::size_t>(links_[i]);
      merge(boxes_[left], boxes_[left + 1], boxes_[i]);
    }
  }
}

std::size_t MovingKdopTree::memUsage() const {
  return links_.capacity() * sizeof(links_[0]) + boxes_.capacity() * sizeof(boxes_[0]) +
         vertex_boxes_.capacity() * sizeof(vertex_boxes_[0]);
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
