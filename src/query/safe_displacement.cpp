// SPDX-License-Identifier: BSD-3-Clause
#include "query/safe_displacement.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include "elementary/least_distance.h"
#include "kernels/kernels.h"
#include "numerics/error_bounds.h"
#include "query/contact_sink.h"
#include "query/deformable_query.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

class SafeBounds {
 public:
  SafeBounds(double min_distance, double most, std::vector<double>& bounds_a,
             std::vector<double>& bounds_b)
      : min_distance_(min_distance), most_(most), bounds_{&bounds_a, &bounds_b} {}

  /// Whether a bound of the vertices of two triangles can become less.
  bool isWanted(const TreeTriangle& a, const TreeTriangle& b) const {
    double most = 0;
    for (int k = 0; k < 3; ++k)
      most = std::max({most, (*bounds_[0])[a.id[k]], (*bounds_[1])[b.id[k]]});
    return most > 0;
  }

  /// Takes the pairs of a block.
  void lower(const FeatureCandidate* pairs, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      const FeatureCandidate& pair = pairs[i];
      // Boxes that are apart at the end keep more than the needed distance.
      if (pair.window_hi < 1) continue;
      if (isZero(pair)) continue;
      if (isPart(pair.kind)) {
        lower(pair, leastDistanceAlone(pair));
        continue;
      }
      if (!eight_.empty() && (eight_.size() == 8 || eight_.front()->kind != pair.kind))
        lowerEight();
      eight_.push_back(&pair);
    }
    if (!eight_.empty()) lowerEight();
  }

 private:
  /// The bound of a vertex of a pair.
  double& boundOf(const FeatureCandidate& pair, unsigned i) {
    const int side = isPointOfA(pair.kind, pair.first_on_a, i) ? 0 : 1;
    return (*bounds_[side])[pair.vertices[i]];
  }

  /// Whether no bound of a pair can become less.
  bool isZero(const FeatureCandidate& pair) {
    for (unsigned i = 0; i < numVertices(pair.kind); ++i)
      if (boundOf(pair, i) > 0) return false;
    return true;
  }

  /// The points of a pair. Two edges are put in order, so that rounding does not depend
  /// on the order of the meshes.
  struct EndPoints {
    const TreeVertex* x[4];

    explicit EndPoints(const FeatureCandidate& pair) {
      std::copy(pair.x, pair.x + 4, x);
      if (pair.kind != ContinuousContactKind::kEdgeEdge) return;
      if (!isBefore(*x[2], *x[3], *x[0], *x[1])) return;
      std::swap(x[0], x[2]);
      std::swap(x[1], x[3]);
    }
  };

  void lowerEight() {
    assert(!eight_.empty() && eight_.size() <= 8);
    EightPoints points;
    points.kind = eight_.front()->kind;
    for (std::size_t lane = 0; lane < 8; ++lane)
      points.set(lane, EndPoints(*eight_[std::min(lane, eight_.size() - 1)]).x);
    double least[8];
    const unsigned known = kernels_.leastDistances(points, least);
    for (std::size_t i = 0; i < eight_.size(); ++i)
      lower(*eight_[i], known >> i & 1U ? least[i] : leastDistanceAlone(*eight_[i]));
    eight_.clear();
  }

  static double leastDistanceAlone(const FeatureCandidate& pair) {
    const EndPoints ordered(pair);
    VertexPath x[4];
    for (int i = 0; i < 4; ++i)
      for (int k = 0; k < 3; ++k) x[i].t0[k] = x[i].t1[k] = ordered.x[i]->t1[k];
    return leastDistance(pair.kind, {{&x[0], &x[1], &x[2], &x[3]}});
  }

  void lower(const FeatureCandidate& pair, double least) {
    const int count = static_cast<int>(numVertices(pair.kind));
    double size = most_;
    for (int i = 0; i < count; ++i)
      for (int k = 0; k < 3; ++k) size = std::max(size, std::abs(pair.x[i]->t1[k]));
    const double safe = halfOf(least - min_distance_, size);
    // Both features may move by it, and then keep the distance.
    assert(safe == 0 || (safe > 0 && 2 * safe <= least - min_distance_));
    for (int i = 0; i < count; ++i) {
      double& bound = boundOf(pair, i);
      assert(0 <= bound && bound <= most_);
      bound = std::min(bound, safe);
    }
  }

  /// Whether an edge p0 p1 comes before q0 q1 in an order of points.
  static bool isBefore(const TreeVertex& p0, const TreeVertex& p1, const TreeVertex& q0,
                       const TreeVertex& q1) {
    const auto key = [](const TreeVertex& p, const TreeVertex& q) {
      return std::make_tuple(p.t1[0], p.t1[1], p.t1[2], q.t1[0], q.t1[1], q.t1[2]);
    };
    return key(p0, p1) < key(q0, q1);
  }

  /// Both features may move towards each other, each by less than a half. A new
  /// coordinate, of at most 2 size, rounds by 2 u size, and a vertex by sqrt(3) of that.
  /// Subnormal numbers round by half of the least one here, in each of three operations.
  static double halfOf(double way, double size) {
    constexpr double kLeast = std::numeric_limits<double>::denorm_min();
    return std::max(0., 0.5 * way * (1 - 8 * kUnit) - 4 * kUnit * size - 2 * kLeast);
  }

  const Kernels& kernels_{kernels()};
  double min_distance_;
  double most_;
  std::vector<double>* bounds_[2];
  /// Up to eight pairs of one kind.
  std::vector<const FeatureCandidate*> eight_;
};

}  // namespace

void lowerToSafe(const MeshInstance& a, const MeshInstance& b, double min_distance,
                 double most, std::vector<double>& bounds_a,
                 std::vector<double>& bounds_b) {
  assert(min_distance >= 0 && 0 < most && most < std::numeric_limits<double>::infinity());
  assert(bounds_a.size() == a.frames.size() && bounds_b.size() == b.frames.size());
  assert((&a == &b) == (&bounds_a == &bounds_b));
  SafeBounds bounds(min_distance, most, bounds_a, bounds_b);
  const FeatureCandidateSink sink = [&bounds](const FeatureCandidate* pairs,
                                              std::size_t count) {
    bounds.lower(pairs, count);
    return true;
  };
  // Pairs that are further apart do not lower a bound.
  const double cull_distance = (min_distance + 2 * most) * (1 + 0x1p-50);
  const TrianglePairTest isWanted = [&bounds](const auto& in_a, const auto& in_b) {
    return bounds.isWanted(in_a, in_b);
  };
  candidatesAtEnd(a, b, sink, cull_distance, isWanted);
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
