// SPDX-License-Identifier: BSD-3-Clause
#include "elementary/flat_passage.h"

#include <algorithm>
#include <cassert>
#include <cfloat>
#include <cmath>

#include "elementary/least_length.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

/// What two vectors span has a sign if it is more than this share of their norms. It is
/// far above the rounding, 192 u, of the three coefficients of a cross product.
constexpr double kLeastTurn = 0x1p-30;

/// What the surface may be off from a plane, as a share of what a gap may shrink by in a
/// step.
constexpr double kFlatShare = 0x1p-20;

StepSegment between(const VertexPath& to, const VertexPath& from, double lo, double hi) {
  return restrict(Difference(to, from), lo, hi);
}

bool holds(const StarTriangle& triangle, std::uint32_t vertex) {
  return triangle.ids[0] == vertex || triangle.ids[1] == vertex;
}

}  // namespace

FlatPassage::FlatPassage(const MovingPair& pair, const FeaturePoints& x,
                         const PairStars& stars, int flat, double toc_lo, double speed)
    : x_(x),
      stars_(stars),
      is_edge_(!pair.table.isTriangle()),
      first_(flat == 0 ? 0 : 2),
      other_(flat == 0 ? 1 + is_edge_ : 0),
      other_end_(flat == 0 ? 4 : 2),
      toc_lo_(toc_lo),
      speed_(speed),
      tolerance_(kFlatShare * speed) {
  assert(flat == 0 || (flat == 1 && is_edge_));
  assert(speed > 0);
  setNormal();
  setSide();
}

/// That of the largest triangle at the feature: a direction of length 1, up to rounding;
/// 0 if there is none.
void FlatPassage::setNormal() {
  double largest = 0;
  for (const StarTriangle& triangle : stars_.at[first_]) {
    if (is_edge_ && !holds(triangle, stars_.ids[first_ + 1])) continue;
    const Vec n = cross(between(triangle.x[0], x_[first_], toc_lo_, toc_lo_).l,
                        between(triangle.x[1], x_[first_], toc_lo_, toc_lo_).l);
    const double square = dot(n, n);
    if (!(square > largest)) continue;
    largest = square;
    normal_ = (1 / std::sqrt(square)) * n;
  }
  // Squares that are subnormal or infinite do not tell the length.
  assert(!(largest > kLeastSquare && largest <= DBL_MAX) ||
         std::abs(dot(normal_, normal_) - 1) < 0x1p-46);
}

/// That of the point furthest from the plane.
void FlatPassage::setSide() {
  double furthest = tolerance_;
  for (int i = other_; i < other_end_; ++i) {
    const Difference d(x_[i], x_[first_]);
    const double height = dot(normal_, d.at(toc_lo_));
    if (!(std::abs(height) - kSideBound * d.norm > furthest)) continue;
    furthest = std::abs(height);
    side_ = height > 0 ? 1 : -1;
  }
}

/// A height changes linearly, and so does what is allowed. What comes nearer to the plane
/// faster than the speed stays before it.
FlatPassage::Answer FlatPassage::besideOrAcross(double lo, double hi) const {
  assert(toc_lo_ <= lo && lo <= hi && hi <= 1);
  bool is_beside = side_ != 0, is_within = true;
  double highest[2] = {0, 0};
  for (int i = other_; i < other_end_; ++i) {
    const Difference d(x_[i], x_[first_]);
    const double bound = kSideBound * d.norm, rate = dot(normal_, d.t1 - d.t0),
                 at[2] = {dot(normal_, d.at(lo)), dot(normal_, d.at(hi))};
    is_beside &= side_ * at[1] - bound >= -tolerance_ || side_ * rate - bound >= -speed_;
    is_within &= std::abs(rate) + bound <= speed_;
    for (int k = 0; k < 2; ++k) {
      const double allowed = tolerance_ + speed_ * (k == 0 ? lo : hi),
                   least = side_ * at[k] - bound;
      is_beside &= least >= -allowed;
      is_within &= std::abs(at[k]) + bound <= allowed;
      highest[k] = std::max(highest[k], least);
    }
  }
  if (is_beside && std::min(highest[0], highest[1]) > tolerance_) return Answer::kBeside;
  return is_within ? Answer::kAcross : Answer::kUnknown;
}

bool FlatPassage::isInPlane(const StepSegment& from_first) const {
  const double most = tolerance_ - kSideBound * from_first.norm;
  return std::abs(dot(normal_, from_first.l)) <= most &&
         std::abs(dot(normal_, from_first.h)) <= most;
}

/// The sign of normal . (v x w) all the time; 0 if it is not certain.
int FlatPassage::turnOf(const StepSegment& v, const StepSegment& w) const {
  const MovingCross n = cross(v, w);
  const double least = kLeastTurn * (v.norm * w.norm);
  const double c[3] = {dot(normal_, n.c0), 0.5 * dot(normal_, n.c1), dot(normal_, n.c2)};
  if (c[0] > least && c[1] > least && c[2] > least) return 1;
  return c[0] < -least && c[1] < -least && c[2] < -least ? -1 : 0;
}

/// Whether the triangles at a vertex are in the plane, and go around it. Each then turns
/// from one spoke to the next one by less than half a circle. Where they begin at the
/// same spokes as they end, they form circles.
bool FlatPassage::isFlatAtVertex(int point, double lo, double hi) const {
  std::vector<std::uint32_t> begins, ends;
  for (const StarTriangle& triangle : stars_.at[point]) {
    for (const VertexPath& corner : triangle.x)
      if (!isInPlane(between(corner, x_[first_], lo, hi))) return false;
    const int turn = turnOf(between(triangle.x[0], x_[point], lo, hi),
                            between(triangle.x[1], x_[point], lo, hi));
    if (turn == 0) return false;
    begins.push_back(triangle.ids[turn > 0 ? 0 : 1]);
    ends.push_back(triangle.ids[turn > 0 ? 1 : 0]);
  }
  std::sort(begins.begin(), begins.end());
  std::sort(ends.begin(), ends.end());
  return !begins.empty() && begins == ends;
}

/// Whether the triangles at an edge are in the plane, on both sides of it.
bool FlatPassage::isFlatAtEdge(double lo, double hi) const {
  const StepSegment edge = between(x_[first_ + 1], x_[first_], lo, hi);
  if (!isInPlane(edge)) return false;
  bool is_left = false, is_right = false;
  const std::uint32_t end = stars_.ids[first_ + 1];
  for (const StarTriangle& triangle : stars_.at[first_]) {
    if (!holds(triangle, end)) continue;
    const int other = triangle.ids[0] == end ? 1 : 0;
    const StepSegment third = between(triangle.x[other], x_[first_], lo, hi);
    const int turn = isInPlane(third) ? turnOf(edge, third) : 0;
    if (turn == 0) return false;
    (turn > 0 ? is_left : is_right) = true;
  }
  return is_left && is_right;
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
