// SPDX-License-Identifier: BSD-3-Clause
#include "advance/feature_advance.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "advance/advancement.h"
#include "elementary/accurate_nearest.h"
#include "elementary/most_steps.h"
#include "mesh/feature_pairs.h"
#include "numerics/error_bounds.h"
#include "paths/posed_vector.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

/// Steps after which features that are still apart probably move along each other at
/// nearly the distance.
constexpr int kPlainSteps = 64;

/// An edge with its ends in the order of their ids.
BodyTriangle edgeOf(const BodyTriangle& triangle, unsigned first) {
  assert(first < 3);
  unsigned second = (first + 1) % 3;
  if (static_cast<std::uint32_t>(triangle.vertex[second]) <
      static_cast<std::uint32_t>(triangle.vertex[first]))
    std::swap(first, second);
  return featureOf(triangle, first, second);
}

/// A feature of one side of a pair.
BodyTriangle sideOf(const FeaturePair& pair, const BodyTriangle& triangle, bool is_a) {
  if (pair.kind == ContinuousContactKind::kEdgeEdge)
    return edgeOf(triangle, is_a ? pair.first : pair.second);
  const bool is_vertex =
      pair.first_on_a == is_a || pair.kind == ContinuousContactKind::kVertexVertex;
  if (is_vertex) return featureOf(triangle, pair.first, pair.first);
  return pair.kind == ContinuousContactKind::kVertexFace ? triangle : edgeOf(triangle, 0);
}

/// Where a point of FeaturePoints is: the body, and the corner of its feature.
struct PointPlace {
  int body, corner;
};

PointPlace placeOf(ContinuousContactKind kind, bool first_on_a, int point) {
  assert(0 <= point && point < 4);
  if (kind == ContinuousContactKind::kEdgeEdge) return {point / 2, point % 2};
  const bool on_a = (point == 0) == first_on_a;
  return {on_a ? 0 : 1, std::max(point - 1, 0)};
}

}  // namespace

BodyTriangle featureOf(const BodyTriangle& triangle, unsigned first, unsigned second) {
  assert(first < 3 && second < 3);
  BodyTriangle out = triangle;
  const unsigned corner[3] = {first, second, second};
  for (int k = 0; k < 3; ++k) {
    out.vertex[k] = triangle.vertex[corner[k]];
    for (auto frame : {0, 1}) out.corner[frame][k] = triangle.corner[frame][corner[k]];
  }
  return out;
}

struct FeatureAdvance::Moment {
  TriangleAdvance::State state;
  /// The differences of the points at this time.
  DifferencePolygon polygon;
  Vec corners[DifferencePolygon::kMaxCorners];
  Vec velocities[DifferencePolygon::kMaxCorners];
  NearestPoint near;

  Moment(const FeatureAdvance& pair, double t)
      : state(pair.motion_.at(t)), polygon(polygonOf(pair, state)) {
    const auto velocity = [&](int point) {
      const PointPlace at = placeOf(pair.pair_.kind, pair.pair_.first_on_a, point);
      return state.v[at.body][at.corner];
    };
    for (int k = 0; k < polygon.count(); ++k) {
      const CornerPoints points = DifferencePolygon::pointsOf(pair.pair_.kind, k);
      corners[k] = polygon.t0(k);
      velocities[k] = velocity(points.second) - velocity(points.first);
    }
    near = nearestPoint(polygon, corners);
  }

 private:
  static DifferencePolygon polygonOf(const FeatureAdvance& pair,
                                     const TriangleAdvance::State& state) {
    VertexPath x[4];
    for (int i = 0; i < 4; ++i) {
      const PointPlace at = placeOf(pair.pair_.kind, pair.pair_.first_on_a, i);
      const Vec& p = state.p[at.body][at.corner];
      x[i] = {{p.x, p.y, p.z}, {p.x, p.y, p.z}};
    }
    return DifferencePolygon(pair.pair_.kind, {{&x[0], &x[1], &x[2], &x[3]}});
  }
};

FeatureAdvance::FeatureAdvance(const MotionPath& path_a, const BodyTriangle& a,
                               const MotionPath& path_b, const BodyTriangle& b, int pair,
                               double t0, double t1, const BodyTolerance& tolerance)
    : pair_(featurePair(pair, a, b)),
      tolerance_(tolerance),
      a_(sideOf(pair_, a, true)),
      b_(sideOf(pair_, b, false)),
      motion_(path_a, a_, path_b, b_, t0, t1, tolerance_),
      t1_(t1) {
  assert(tolerance_.distance > 0);
}

// The position of the tolerance bounds what posed points are off along a unit direction.
// While a direction turns it is at most 1.5 long. The rest is that of straight paths: see
// AdvancingPair in distance_advance.cpp.
double FeatureAdvance::margin(double size) const {
  return 1.5 * tolerance_.position + 128 * kUnit * (tolerance_.distance + size);
}

// More than the margin, what a direction loses to rounding, and once more the position,
// so that a step has a gap to use. The true distance is within the position and 64 u size
// of the computed one.
double FeatureAdvance::touching(double size) const {
  return 3 * tolerance_.position +
         DistanceTolerance::kTouching * (tolerance_.distance + size);
}

void FeatureAdvance::ignoreInitiallyCloser() {
  const Moment start(*this, 0);
  const double size = start.polygon.size(), most = touching(size),
               error = DistanceTolerance(tolerance_.distance, size).distance_error;
  const NearestPoint near = sureNearest(start.polygon, start.corners, start.near, error);
  if (near.distance > tolerance_.distance * (1 + DistanceTolerance::kShare) + most)
    return;
  const double own = near.distance * (1 - 2 * DistanceTolerance::kShare) - 2 * most;
  assert(!(own > tolerance_.distance));
  if (own > 0) tolerance_.distance = own;
}

FeatureAdvance::Answer FeatureAdvance::advance(double& t, AdvanceCounts& counts) const {
  int left = kMostSteps;
  const Answer answer = deformable::advance(
      t, t1_, HUGE_VAL, left, counts, [this](double time) { return Moment(*this, time); },
      [this, &left](const Moment& moment) {
        const double d = tolerance_.distance, share = kMostSteps - left < kPlainSteps
                                                          ? 0
                                                          : DistanceTolerance::kShare;
        return moment.near.distance <= d + (share * d + touching(moment.polygon.size()));
      },
      [this](double time, const Moment& moment) { return longestStep(time, moment); });
  return answer == Answer::kOpen ? Answer::kGivenUp : answer;
}

double FeatureAdvance::longestStep(double t, const Moment& moment) const {
  for (int attempt = 0; attempt < kDirectionAttempts; ++attempt) {
    const Vec n = directionApart(moment.polygon, moment.corners, moment.near, attempt);
    const double step = longerStep(t, moment, moment.near, n);
    if (step > 0) return step;
  }
  const AccurateNearest nearest = accurateNearest(moment.polygon, moment.corners);
  return longerStep(t, moment, nearest.near, nearest.direction);
}

/// The longer one of the steps that a direction proves, fixed or while it turns.
double FeatureAdvance::longerStep(double t, const Moment& moment,
                                  const NearestPoint& near, const Vec& n) const {
  const double longest = t1_ - t,
               fixed = motion_.step(t, moment.state, pair_.first_on_a ? n : -1. * n);
  if (fixed >= longest) return fixed;
  const Vec turn = turnApart(moment.polygon, moment.corners, moment.velocities, near, n);
  return std::max(fixed, turningStep(moment, n, turn, longest));
}

// A direction n + h m that turns, for h |m| <= 1/2. For each corner c with the velocity
// c'
//   (n + h m) . c(t + h) >= (n + h m) . (c + h c') - |n + h m| M h^2 / 2,
// and it proves a distance above d while this is more than
// d |n + h m| <= d (1 + h n . m + h^2 m^2 / 2), since the root of 1 + x is at most 1 + x
// / 2. |n + h m| is at most 1.5. Products with n and with h m round by less than 8 u L
// and 4 u d, and the root by 8 u of each term: less than 128 u (d + L) together, except
// for the parts with c', which are below twice the rate.
double FeatureAdvance::turningStep(const Moment& moment, const Vec& n, const Vec& turn,
                                   double longest) const {
  constexpr double kMostTurn = 0.5, kMostLength = 1.5;
  const double d = tolerance_.distance, square = dot(turn, turn);
  double h = std::min(longest, kMostTurn / std::sqrt(square));
  if (!(h > 0)) return -1;
  const double least = d + margin(moment.polygon.size());
  for (int k = 0; k < moment.polygon.count(); ++k) {
    const Vec &c = moment.corners[k], &change = moment.velocities[k];
    const double gap = dot(n, c) - least,
                 rate = dot(n, change) + dot(turn, c) - d * dot(n, turn) -
                        2 * tolerance_.rate,
                 bend = dot(turn, change) - 0.5 * d * square -
                        0.5 * kMostLength * motion_.acceleration();
    if (!(gap > 0)) return -1;
    h = std::min(h, firstRoot(gap, rate, bend));
  }
  // A longer direction would prove too much.
  assert(isUnit(n) && !(h < 0 || h > longest) && !(h * h * square > 0.251));
  return h;
}

DistanceContact FeatureAdvance::contactAt(double t, double width) const {
  constexpr int kNumber[] = {0, 1, 2, 3};
  const Moment moment(*this, t);
  DistanceContact out;
  out.is_contact = true;
  setNearest(pair_.kind, moment.near, kNumber, out);
  out.toc_lo = out.toc_hi = t;
  // A contact at the beginning has exactly the time 0.
  if (t > 0) out.toc_hi = proveWithin(t, width);
  assert(0 <= out.toc_lo && out.toc_lo <= out.toc_hi && out.toc_hi <= 1);
  return out;
}

/// A time in (t, t + width] at which the features provably are within d; t if none is
/// found.
double FeatureAdvance::proveWithin(double t, double width) const {
  const Moment moment(*this, t);
  double speed = 0;
  for (int k = 0; k < moment.polygon.count(); ++k)
    speed = std::max(speed, norm(moment.velocities[k]));
  return provedTimeAfter(t, width, tolerance_.position, speed, 0, [this](double time) {
    const Moment later(*this, time);
    const double error =
        DistanceTolerance(tolerance_.distance, later.polygon.size()).distance_error;
    return later.near.distance + error + tolerance_.position <= tolerance_.distance;
  });
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
