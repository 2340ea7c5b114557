// SPDX-License-Identifier: BSD-3-Clause
#include "distance_methods.h"

#include <algorithm>
#include <cmath>
#include <queue>

#include "elementary/distance_advance.h"
#include "feature_distance.h"

namespace fcl {
namespace test {
namespace {

using V = Vector3<double>;
using Kind = ContinuousContactKind;

V at0(const detail::deformable::VertexPath& p) { return {p.t0[0], p.t0[1], p.t0[2]}; }
V at1(const detail::deformable::VertexPath& p) { return {p.t1[0], p.t1[1], p.t1[2]}; }

DistanceAnswer ours(const MovingPair& query, double distance, double toc_err) {
  detail::deformable::DistanceRequest request;
  request.distance = distance;
  request.toc_err = toc_err;
  const auto found =
      detail::deformable::advanceToDistance(query.kind, query.points(), request);
  return {found.is_contact, found.toc_lo};
}

/// A box of time and of the weights u and v. Each side is a binary fraction.
struct Cell {
  double low[3], width[3];
  bool operator<(const Cell& o) const { return low[0] > o.low[0]; }
};

/// The difference of the points of two features: VF v - (f0 + u (f1 - f0) + v (f2 - f0)),
/// EE (a0 + u (a1 - a0)) - (b0 + v (b1 - b0)).
class Difference {
 public:
  explicit Difference(const MovingPair& query)
      : is_face_(query.kind == Kind::kVertexFace) {
    for (std::size_t i = 0; i < 4; ++i) {
      from_[i] = at0(query.x[i]);
      to_[i] = at1(query.x[i]);
      for (const V& p : {from_[i], to_[i]})
        size_ = std::max(size_, (p - from_[0]).cwiseAbs().maxCoeff());
    }
  }

  double size() const { return size_; }
  bool isFace() const { return is_face_; }

  V at(double t, double u, double v) const {
    V x[4];
    for (int i = 0; i < 4; ++i) x[i] = (1 - t) * from_[i] + t * to_[i];
    if (is_face_) return x[0] - (x[1] + u * (x[2] - x[1]) + v * (x[3] - x[1]));
    return (x[0] + u * (x[1] - x[0])) - (x[2] + v * (x[3] - x[2]));
  }

  /// It is linear in each argument, so its extremes are at the corners of the cell.
  void range(const Cell& cell, V& low, V& high) const {
    low.setConstant(HUGE_VAL);
    high.setConstant(-HUGE_VAL);
    for (int corner = 0; corner < 8; ++corner) {
      const V value = at(cell.low[0] + (corner & 1) * cell.width[0],
                         cell.low[1] + (corner >> 1 & 1) * cell.width[1],
                         cell.low[2] + (corner >> 2 & 1) * cell.width[2]);
      low = low.cwiseMin(value);
      high = high.cwiseMax(value);
    }
  }

  /// How far the difference moves along a side of the cell, at most.
  double reach(const Cell& cell, int side) const {
    double most = 0;
    for (int corner = 0; corner < 8; ++corner) {
      if (corner >> side & 1) continue;
      double p[3], q[3];
      for (int k = 0; k < 3; ++k)
        p[k] = q[k] = cell.low[k] + (corner >> k & 1) * cell.width[k];
      q[side] += cell.width[side];
      most = std::max(
          most, (at(q[0], q[1], q[2]) - at(p[0], p[1], p[2])).cwiseAbs().maxCoeff());
    }
    return most;
  }

 private:
  bool is_face_;
  V from_[4], to_[4];
  double size_{0};
};

DistanceAnswer inclusion(const MovingPair& query, double distance, double tolerance) {
  constexpr int kMostCells = 100000;
  const Difference difference(query);
  const double small = tolerance * (difference.size() + distance);
  std::priority_queue<Cell> open;
  open.push({{0, 0, 0}, {1, 1, 1}});
  for (int count = 0; !open.empty(); ++count) {
    const Cell cell = open.top();
    open.pop();
    V low, high;
    difference.range(cell, low, high);
    if ((low.array() > distance).any() || (high.array() < -distance).any()) continue;
    if (count == kMostCells || (high - low).maxCoeff() <= small)
      return {true, cell.low[0]};
    int side = 0;
    for (int k = 1; k < 3; ++k)
      if (difference.reach(cell, k) > difference.reach(cell, side)) side = k;
    Cell half = cell;
    half.width[side] *= 0.5;
    open.push(half);
    half.low[side] += half.width[side];
    if (!difference.isFace() || half.low[1] + half.low[2] <= 1) open.push(half);
  }
  return {false, 1};
}

DistanceAnswer additive(const MovingPair& query, double distance, double share) {
  constexpr int kMostSteps = 100000;
  V x[4], way[4], mean = V::Zero();
  for (std::size_t i = 0; i < 4; ++i) {
    x[i] = at0(query.x[i]);
    way[i] = at1(query.x[i]) - x[i];
    mean += 0.25 * way[i];
  }
  double length[4];
  for (int i = 0; i < 4; ++i) {
    way[i] -= mean;
    length[i] = way[i].norm();
  }
  const bool is_face = query.kind == Kind::kVertexFace;
  const double speed =
      is_face ? length[0] + std::max(std::max(length[1], length[2]), length[3])
              : std::max(length[0], length[1]) + std::max(length[2], length[3]);
  const auto gapAt = [&](double t) {
    const V p[4] = {x[0] + t * way[0], x[1] + t * way[1], x[2] + t * way[2],
                    x[3] + t * way[3]};
    return (is_face ? distanceToFace(p[0], p[1], p[2], p[3])
                    : distanceOfEdges(p[0], p[1], p[2], p[3])) -
           distance;
  };
  const double first = gapAt(0), left = (1 - share) * first;
  if (!(first > 0)) return {true, 0};
  if (!(speed > 0)) return {false, 1};
  double t = 0;
  for (int step = 0; step < kMostSteps; ++step) {
    const double gap = gapAt(t);
    if (t > 0 && gap < left) return {true, t};
    const double next = t + share * gap / speed;
    if (next > 1) return {false, 1};
    if (!(next > t)) return {true, t};
    t = next;
  }
  return {true, t};
}

}  // namespace

std::vector<DistanceMethod> distanceMethods() {
  return {
      {"ours", "1e-3", 1e-3, ours},           {"ours", "1e-6", 1e-6, ours},
      {"inclusion", "1e-3", 1e-3, inclusion}, {"inclusion", "1e-6", 1e-6, inclusion},
      {"additive", "0.9", 0.9, additive},     {"additive", "0.9999", 0.9999, additive}};
}

}  // namespace test
}  // namespace fcl
