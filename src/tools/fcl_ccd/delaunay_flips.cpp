// SPDX-License-Identifier: BSD-3-Clause
#include "delaunay_flips.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>

namespace fcl_ccd {
namespace {

using Vector = std::array<double, 3>;

Vector difference(const CornerPoint& a, const CornerPoint& b) {
  return {a.x[0] - b.x[0], a.x[1] - b.x[1], a.x[2] - b.x[2]};
}

double dot(const Vector& a, const Vector& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

double crossNorm(const Vector& a, const Vector& b) {
  const Vector n{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
                 a[0] * b[1] - a[1] * b[0]};
  return std::sqrt(dot(n, n));
}

class Flips {
 public:
  Flips(const PolygonRings& rings, std::vector<PolygonTriangle>& triangles)
      : rings_(rings), triangles_(triangles) {}

  void run() {
    connect();
    // The sweep leaves edges that need 1 to 3 flips a triangle in stars, combs and random
    // polygons. The limit only ends a series that rounding could make endless.
    std::size_t left = 32 * triangles_.size();
    std::vector<std::size_t> waiting(across_.size());
    for (std::size_t i = 0; i < waiting.size(); ++i) waiting[i] = waiting.size() - 1 - i;
    while (!waiting.empty() && left > 0) {
      const std::size_t side = waiting.back();
      waiting.pop_back();
      if (!shouldFlip(side)) continue;
      for (const std::size_t changed : flip(side)) waiting.push_back(changed);
      --left;
    }
  }

 private:
  static constexpr std::size_t kNone = ~std::size_t{0};

  // Side 3 t + k is the edge of triangle t from its corner k to the next one.
  static std::size_t nextSide(std::size_t side) {
    return side % 3 == 2 ? side - 2 : side + 1;
  }
  int from(std::size_t side) const { return triangles_[side / 3][side % 3]; }

  /// Finds the side of another triangle that is the same edge.
  void connect() {
    struct Edge {
      int low, high;
      std::size_t side;
    };
    std::vector<Edge> edges;
    edges.reserve(3 * triangles_.size());
    for (std::size_t side = 0; side < 3 * triangles_.size(); ++side) {
      const int a = from(side), b = from(nextSide(side));
      edges.push_back({std::min(a, b), std::max(a, b), side});
    }
    std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
      if (a.low != b.low) return a.low < b.low;
      return a.high != b.high ? a.high < b.high : a.side < b.side;
    });
    across_.assign(edges.size(), kNone);
    for (std::size_t i = 0; i + 1 < edges.size(); ++i) {
      if (edges[i].low != edges[i + 1].low || edges[i].high != edges[i + 1].high ||
          from(edges[i].side) == from(edges[i + 1].side))
        continue;
      across_[edges[i].side] = edges[i + 1].side;
      across_[edges[i + 1].side] = edges[i].side;
      ++i;
    }
  }

  /// The corners of the two triangles at a side: a and b are its ends, c and d across.
  std::array<int, 4> cornersAt(std::size_t side) const {
    return {from(side), from(nextSide(side)), from(nextSide(nextSide(side))),
            from(nextSide(nextSide(across_[side])))};
  }

  bool shouldFlip(std::size_t side) const {
    if (across_[side] == kNone) return false;
    const auto [a, b, c, d] = cornersAt(side);
    const auto edge = [this](int p, int q) {
      return difference(rings_.point(p), rings_.point(q));
    };
    const Vector ca = edge(a, c), cb = edge(b, c), da = edge(a, d), db = edge(b, d);
    const double cos_c = dot(ca, cb), cos_d = dot(da, db);
    const double sin_c = crossNorm(ca, cb), sin_d = crossNorm(da, db);
    const double scale = std::sqrt(dot(ca, ca)) * std::sqrt(dot(cb, cb)) *
                         std::sqrt(dot(da, da)) * std::sqrt(dot(db, db));
    // The sine of the sum of both angles. Rounding is less than a few 1e-16.
    if (!(sin_c * cos_d + cos_c * sin_d < -1e-12 * scale)) return false;
    return rings_.turn(a, d, c) > 0 && rings_.turn(d, b, c) > 0;
  }

  /// Returns the four sides around both triangles.
  std::array<std::size_t, 4> flip(std::size_t side) {
    const std::size_t other = across_[side];
    assert(across_[other] == side && from(other) == from(nextSide(side)));
    const auto [a, b, c, d] = cornersAt(side);
    const std::size_t bc = across_[nextSide(side)],
                      ca = across_[nextSide(nextSide(side))];
    const std::size_t ad = across_[nextSide(other)],
                      db = across_[nextSide(nextSide(other))];
    const std::size_t t = side / 3, s = other / 3;
    triangles_[t] = {a, d, c};
    triangles_[s] = {d, b, c};
    join(3 * t, ad);
    join(3 * t + 1, 3 * s + 2);
    join(3 * t + 2, ca);
    join(3 * s, db);
    join(3 * s + 1, bc);
    return {3 * t, 3 * t + 2, 3 * s, 3 * s + 1};
  }

  void join(std::size_t side, std::size_t other) {
    across_[side] = other;
    if (other != kNone) across_[other] = side;
  }

  const PolygonRings& rings_;
  std::vector<PolygonTriangle>& triangles_;
  std::vector<std::size_t> across_;
};

}  // namespace

void flipTowardsDelaunay(const PolygonRings& rings,
                         std::vector<PolygonTriangle>& triangles) {
  Flips(rings, triangles).run();
}

}  // namespace fcl_ccd
