// SPDX-License-Identifier: BSD-3-Clause
#include "query/safe_displacement.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "elementary/distance_advance.h"
#include "query/deformable_query.h"

namespace fcl {
namespace detail {
namespace deformable {

// A product of a direction with a corner is off by 5 u L, the corner by u L, and the
// direction is at most 1 + 5 u long: 16 u L and 8 u of the gap are more.
double leastDistance(ContinuousContactKind kind, const FeaturePoints& x) {
  constexpr double kUnit = 0x1p-53, kEnough = 1 - 0x1p-40;
  const DifferencePolygon polygon(kind, x);
  Vec corners[DifferencePolygon::kMaxCorners];
  for (int k = 0; k < polygon.count(); ++k) corners[k] = polygon.t0(k);
  const NearestPoint near = nearestPoint(polygon, corners);
  double best = 0;
  for (int attempt = 0; attempt < kDirectionAttempts; ++attempt) {
    const Vec n = directionApart(polygon, corners, near, attempt);
    double gap = dot(n, corners[0]);
    for (int k = 1; k < polygon.count(); ++k) gap = std::min(gap, dot(n, corners[k]));
    best = std::max(best, gap);
    if (best > kEnough * near.distance) break;
  }
  const double least = best * (1 - 8 * kUnit) - 16 * kUnit * polygon.size();
  return least > 0 ? least : 0;
}

namespace {

class SafeBounds {
 public:
  SafeBounds(const MeshInstance& a, const MeshInstance& b, double min_distance,
             double most, std::vector<double>& bounds_a, std::vector<double>& bounds_b)
      : mesh_{&a, &b},
        min_distance_(min_distance),
        most_(most),
        bounds_{&bounds_a, &bounds_b} {}

  void lower(const FeatureCandidate& pair) {
    // Boxes that are apart at the end keep more than the needed distance.
    if (pair.window_hi < 1) return;
    const int num_first = pair.kind == ContinuousContactKind::kEdgeEdge ? 2 : 1,
              count = static_cast<int>(numVertices(pair.kind));
    VertexPath x[4];
    double* bound[4];
    double size = most_;
    for (int i = 0; i < count; ++i) {
      const int side = (i < num_first) == pair.first_on_a ? 0 : 1;
      mesh_[side]->frames.at(1, pair.vertices[i], x[i].t0);
      std::copy(x[i].t0, x[i].t0 + 3, x[i].t1);
      for (const double coordinate : x[i].t0) size = std::max(size, std::abs(coordinate));
      bound[i] = &(*bounds_[side])[pair.vertices[i]];
    }
    FeaturePoints points{{&x[0], &x[1], &x[2], &x[3]}};
    // The two edges are put in order, so that rounding does not depend on the order of
    // the meshes.
    if (num_first == 2 && isBefore(x[2], x[3], x[0], x[1]))
      points = {{&x[2], &x[3], &x[0], &x[1]}};
    const double least = leastDistance(pair.kind, points);
    const double safe = halfOf(least - min_distance_, size);
    for (int i = 0; i < count; ++i) *bound[i] = std::min(*bound[i], safe);
  }

 private:
  /// Whether an edge p0 p1 comes before q0 q1 in an order of points.
  static bool isBefore(const VertexPath& p0, const VertexPath& p1, const VertexPath& q0,
                       const VertexPath& q1) {
    const auto key = [](const VertexPath& p, const VertexPath& q) {
      return std::make_tuple(p.t0[0], p.t0[1], p.t0[2], q.t0[0], q.t0[1], q.t0[2]);
    };
    return key(p0, p1) < key(q0, q1);
  }

  /// Both features may move towards each other, each by less than a half. A new
  /// coordinate, of at most 2 size, rounds by 2 u size, and a vertex by sqrt(3) of that.
  static double halfOf(double way, double size) {
    constexpr double kUnit = 0x1p-53;
    return std::max(0., 0.5 * way * (1 - 8 * kUnit) - 4 * kUnit * size);
  }

  const MeshInstance* mesh_[2];
  double min_distance_;
  double most_;
  std::vector<double>* bounds_[2];
};

}  // namespace

void lowerToSafe(const MeshInstance& a, const MeshInstance& b, double min_distance,
                 double most, std::vector<double>& bounds_a,
                 std::vector<double>& bounds_b) {
  SafeBounds bounds(a, b, min_distance, most, bounds_a, bounds_b);
  const CandidateSink sink = [&bounds](const FeatureCandidate* pairs, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) bounds.lower(pairs[i]);
    return true;
  };
  // Pairs that are further apart do not lower a bound.
  const double reach = (min_distance + 2 * most) * (1 + 0x1p-50);
  if (&a == &b)
    candidatesSelf(a, sink, reach);
  else
    candidatesPair(a, b, sink, reach);
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
