// SPDX-License-Identifier: BSD-3-Clause
#include "proximity.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace fcl {
namespace test {
namespace {

using Cell = std::array<std::int64_t, 3>;

/// Vertices sorted by the hash of their grid cell, by a counting sort, so that the order
/// is fixed. Different cells may have the same hash; the distance test that follows
/// separates them.
class VertexGrid {
 public:
  VertexGrid(const std::vector<Vector3<double>>& vertices, double cell_size)
      : cell_size_(cell_size) {
    while (bucket_count_ < vertices.size()) bucket_count_ *= 2;
    first_.assign(bucket_count_ + 1, 0);
    for (const auto& p : vertices) ++first_[bucketOf(cellOf(p)) + 1];
    for (std::size_t b = 0; b < bucket_count_; ++b) first_[b + 1] += first_[b];
    ids_.resize(vertices.size());
    std::vector<int> next(first_.begin(), first_.end() - 1);
    for (std::size_t v = 0; v < vertices.size(); ++v)
      ids_[next[bucketOf(cellOf(vertices[v]))]++] = static_cast<int>(v);
  }

  Cell cellOf(const Vector3<double>& p) const {
    Cell cell;
    for (int k = 0; k < 3; ++k)
      cell[k] = static_cast<std::int64_t>(std::floor(p[k] / cell_size_));
    return cell;
  }

  /// Calls visit(id) for every vertex in the cells from lo to hi, and for some others. A
  /// vertex may come more than once, if its bucket belongs to several of the cells.
  template <typename Visit>
  void forEach(const Cell& lo, const Cell& hi, Visit visit) const {
    for (std::int64_t z = lo[2]; z <= hi[2]; ++z)
      for (std::int64_t y = lo[1]; y <= hi[1]; ++y)
        for (std::int64_t x = lo[0]; x <= hi[0]; ++x) {
          const std::size_t b = bucketOf({{x, y, z}});
          for (int i = first_[b]; i < first_[b + 1]; ++i) visit(ids_[i]);
        }
  }

 private:
  std::size_t bucketOf(const Cell& cell) const {
    const std::uint64_t hash = static_cast<std::uint64_t>(cell[0]) * 73856093u ^
                               static_cast<std::uint64_t>(cell[1]) * 19349663u ^
                               static_cast<std::uint64_t>(cell[2]) * 83492791u;
    return (hash ^ (hash >> 17)) & (bucket_count_ - 1);
  }

  double cell_size_;
  std::size_t bucket_count_{1};
  std::vector<int> first_;
  std::vector<int> ids_;
};

/// Weights of the point of segment ab closest to p.
double closestOnSegment(const Vector3<double>& p, const Vector3<double>& a,
                        const Vector3<double>& b) {
  const Vector3<double> ab = b - a;
  const double length2 = ab.squaredNorm();
  if (length2 == 0) return 0;
  return std::min(1.0, std::max(0.0, (p - a).dot(ab) / length2));
}

}  // namespace

Vector3<double> closestWeights(const Vector3<double>& p, const Vector3<double>& a,
                               const Vector3<double>& b, const Vector3<double>& c) {
  const Vector3<double> normal = (b - a).cross(c - a);
  const double area2 = normal.squaredNorm();
  if (area2 > 0) {
    const Vector3<double> inside((c - b).cross(p - b).dot(normal) / area2,
                                 (a - c).cross(p - c).dot(normal) / area2,
                                 (b - a).cross(p - a).dot(normal) / area2);
    if (inside.minCoeff() >= 0) return inside;
  }
  const double s[3] = {closestOnSegment(p, a, b), closestOnSegment(p, b, c),
                       closestOnSegment(p, c, a)};
  const Vector3<double> on_edge[3] = {
      {1 - s[0], s[0], 0}, {0, 1 - s[1], s[1]}, {s[2], 0, 1 - s[2]}};
  const auto distance2 = [&](const Vector3<double>& w) {
    return (w[0] * a + w[1] * b + w[2] * c - p).squaredNorm();
  };
  int best = 0;
  for (int k = 1; k < 3; ++k)
    if (distance2(on_edge[k]) < distance2(on_edge[best])) best = k;
  return on_edge[best];
}

std::vector<NearPair> findNearPairs(const std::vector<Vector3<double>>& vertices,
                                    const std::vector<Triangle>& triangles,
                                    const std::vector<char>& is_movable, double distance,
                                    double cell_size) {
  const VertexGrid grid(vertices, cell_size);
  const Vector3<double> margin = Vector3<double>::Constant(distance);
  std::vector<NearPair> pairs;
  std::vector<int> candidates;
  for (std::size_t f = 0; f < triangles.size(); ++f) {
    const Triangle& t = triangles[f];
    const Vector3<double>& a = vertices[t[0]];
    const Vector3<double>& b = vertices[t[1]];
    const Vector3<double>& c = vertices[t[2]];
    const Vector3<double> lo = a.cwiseMin(b).cwiseMin(c) - margin;
    const Vector3<double> hi = a.cwiseMax(b).cwiseMax(c) + margin;
    candidates.clear();
    grid.forEach(grid.cellOf(lo), grid.cellOf(hi), [&](int v) {
      const Vector3<double>& p = vertices[v];
      if ((p.array() < lo.array()).any() || (p.array() > hi.array()).any()) return;
      const auto id = static_cast<std::size_t>(v);
      if (id == t[0] || id == t[1] || id == t[2]) return;
      if (is_movable[v] || is_movable[t[0]]) candidates.push_back(v);
    });
    std::sort(candidates.begin(), candidates.end());
    candidates.erase(std::unique(candidates.begin(), candidates.end()), candidates.end());
    for (const int v : candidates) {
      const Vector3<double> w = closestWeights(vertices[v], a, b, c);
      const double d = (w[0] * a + w[1] * b + w[2] * c - vertices[v]).norm();
      if (d < distance) pairs.push_back({v, static_cast<int>(f), w, d});
    }
  }
  return pairs;
}

}  // namespace test
}  // namespace fcl
