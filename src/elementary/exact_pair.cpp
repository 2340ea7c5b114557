// SPDX-License-Identifier: BSD-3-Clause
#include "elementary/exact_pair.h"

#include <algorithm>
#include <cassert>
#include <utility>

#include "elementary/in_plane.h"
#include "elementary/predicates.h"
#include "numerics/integer_coordinates.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

using MovingPoint = ExactPair::MovingPoint;

MovingPoint operator-(const MovingPoint& a, const MovingPoint& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

ExactPolynomial crossComponent(const MovingPoint& a, const MovingPoint& b,
                               std::size_t k) {
  const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
  return a[i] * b[j] - a[j] * b[i];
}

MovingPoint cross(const MovingPoint& a, const MovingPoint& b) {
  return {crossComponent(a, b, 0), crossComponent(a, b, 1), crossComponent(a, b, 2)};
}

/// The four paths as integers.
std::array<MovingPoint, 4> integerPaths(const FeaturePoints& x,
                                        const FrameDigits& digits) {
  std::array<MovingPoint, 4> points;
  for (int i = 0; i < 4; ++i)
    for (int k = 0; k < 3; ++k) {
      const Integer from = toInteger<Integer>(x[i].t0[k], digits.lowest[0]);
      points[static_cast<std::size_t>(i)][static_cast<std::size_t>(k)] =
          ExactPolynomial{from, toInteger<Integer>(x[i].t1[k], digits.lowest[1]) - from};
    }
  return points;
}

[[maybe_unused]] bool areLinear(const std::array<MovingPoint, 4>& paths) {
  for (const MovingPoint& path : paths)
    for (const ExactPolynomial& x : path)
      if (x.degree() > 1) return false;
  return true;
}

}  // namespace

ExactPair::ExactPair(ContinuousContactKind kind, const FeaturePoints& x,
                     const FrameDigits& digits)
    : ExactPair(kind, integerPaths(x, digits), axisOfCommonPlane(x)) {}

ExactPair::ExactPair(ContinuousContactKind kind, const std::array<MovingPoint, 4>& paths)
    : ExactPair(kind, paths, -1) {}

ExactPair::ExactPair(ContinuousContactKind kind, const std::array<MovingPoint, 4>& paths,
                     int common_axis)
    : table_(pairTable(kind)),
      is_edge_edge_(kind == ContinuousContactKind::kEdgeEdge),
      p_(paths) {
  assert(areLinear(paths));
  for (std::size_t i = 0; i < differences_.size(); ++i) {
    const auto [to, from] = table_.difference[i];
    differences_[i] = p_[to] - p_[from];
  }
  const auto& [u, v, w, r, q] = differences_;
  if (common_axis >= 0) {
    const auto k = static_cast<std::size_t>(common_axis);
    assert(u[k].isZero() && v[k].isZero() && w[k].isZero());
    n_[k] = crossComponent(v, w, k);
    return;
  }
  for (std::size_t k = 0; k < 3; ++k) {
    n_[k] = crossComponent(v, w, k);
    volume_ += u[k] * n_[k];
  }
}

std::vector<Root> ExactPair::candidates() const {
  std::vector<Root> times;
  const auto addRootsOf = [&times](const ExactPolynomial& p) {
    if (p.degree() < 1) return;
    for (Root& root : rootsInUnitInterval(p)) times.push_back(std::move(root));
  };
  if (!volume_.isZero()) {
    addRootsOf(volume_);
    return times;
  }
  // The points are always coplanar: contacts begin where a weight changes its sign.
  for (std::size_t k = 0; k < 3; ++k)
    if (!n_[k].isZero()) {
      addRootsOf(n_[k]);
      for (int i = 0; i < table_.num_inside; ++i) addRootsOf(weight(i, k));
      return times;
    }
  // Always parallel, or without area. Parallel edges touch only while a is on the line
  // of cd, or c is d.
  if (is_edge_edge_)
    for (const ExactPolynomial& off : cross(differences_[kU], differences_[kW]))
      if (!off.isZero()) {
        addRootsOf(off);
        return times;
      }
  for (const auto& [p, q, r] : pointsOnSegments()) {
    const MovingPoint off = cross(p - q, r - q);
    const auto not_zero =
        std::find_if(off.begin(), off.end(), [](const auto& o) { return !o.isZero(); });
    if (not_zero != off.end()) {
      addRootsOf(*not_zero);
      continue;
    }
    for (std::size_t k = 0; k < 3; ++k) {
      addRootsOf(p[k] - q[k]);
      addRootsOf(p[k] - r[k]);
    }
  }
  return times;
}

bool ExactPair::touchAt(Root& t) const {
  // Of a copy: a sign may narrow the interval, on which brackets depend.
  assert(Root(t).signOf(volume_) == 0);
  for (std::size_t k = 0; k < 3; ++k) {
    const int sign = t.signOf(n_[k]);
    if (sign == 0) continue;
    for (int i = 0; i < table_.num_inside; ++i)
      if (sign * t.signOf(weight(i, k)) < 0) return false;
    return true;
  }
  for (const auto& [p, q, r] : pointsOnSegments())
    if (isOnSegmentAt(t, p, q, r)) return true;
  return false;
}

/// Component k of the cross product that gives weight i.
ExactPolynomial ExactPair::weight(int i, std::size_t k) const {
  const auto& [x, y] = table_.inside[i];
  return crossComponent(differences_[x], differences_[y], k);
}

std::vector<ExactPair::PointAndSegment> ExactPair::pointsOnSegments() const {
  std::vector<PointAndSegment> all;
  for (int i = 0; i < table_.num_inside; ++i) {
    const auto [p, q, r] = table_.meeting[i];
    all.push_back({p_[p], p_[q], p_[r]});
  }
  return all;
}

bool ExactPair::isOnSegmentAt(Root& t, const MovingPoint& p, const MovingPoint& q,
                              const MovingPoint& r) {
  for (std::size_t k = 0; k < 3; ++k)
    if (t.signOf(p[k] - q[k]) * t.signOf(p[k] - r[k]) > 0) return false;
  const MovingPoint off = cross(p - q, r - q);
  return std::all_of(off.begin(), off.end(),
                     [&t](const ExactPolynomial& o) { return t.signOf(o) == 0; });
}

bool ExactQuery::touchInFrame(int t) const {
  assert(t == 0 || t == 1);
  const auto at = [&](int i) -> const double(&)[3] {
    return t == 0 ? x_[i].t0 : x_[i].t1;
  };
  return kind_ == ContinuousContactKind::kVertexFace
             ? isOnTriangle(at(0), at(1), at(2), at(3))
             : doSegmentsTouch(at(0), at(1), at(2), at(3));
}

bool ExactQuery::isCoplanarInFrame(int t) const {
  assert(t == 0 || t == 1);
  const auto at = [&](int i) -> const double(&)[3] {
    return t == 0 ? x_[i].t0 : x_[i].t1;
  };
  return orientation(at(0), at(1), at(2), at(3)) == 0;
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
