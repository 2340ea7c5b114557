// SPDX-License-Identifier: BSD-3-Clause
//
// A pair of features in doubles: its differences over the step, and over a part of it
// with bounds on their rounding.
#ifndef FCL_CCD_ELEMENTARY_MOVING_PAIR_H
#define FCL_CCD_ELEMENTARY_MOVING_PAIR_H

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "elementary/feature_points.h"
#include "elementary/pair_table.h"
#include "elementary/separating_direction.h"
#include "numerics/error_bounds.h"
#include "numerics/moving_vector.h"

namespace fcl {
namespace detail {
namespace deformable {

/// The difference of two vertices over the step.
struct Difference {
  Vec t0, t1;
  double norm;

  Difference() = default;
  Difference(const VertexPath& p, const VertexPath& q)
      : t0{p.t0[0] - q.t0[0], p.t0[1] - q.t0[1], p.t0[2] - q.t0[2]},
        t1{p.t1[0] - q.t1[0], p.t1[1] - q.t1[1], p.t1[2] - q.t1[2]},
        norm(std::max(std::max(maxNorm(t0), maxNorm(t1)), kLeastNorm)) {}

  Vec at(double t) const {
    assert(0 <= t && t <= 1);
    if (t == 0) return t0;
    if (t == 1) return t1;
    return (1 - t) * t0 + t * t1;
  }
};

/// A vector that moves linearly, with its norm bound over the whole step.
struct StepSegment : Segment {
  double norm;
};

inline StepSegment restrict(const Difference& d, double lo, double hi) {
  assert(0 <= lo && lo <= hi && hi <= 1);
  const StepSegment out{{d.at(lo), d.at(hi)}, d.norm};
  // Up to the rounding of three operations.
  assert(!(maxNorm(out.l) > d.norm * (1 + 8 * kUnit)));
  assert(!(maxNorm(out.h) > d.norm * (1 + 8 * kUnit)));
  return out;
}

/// Whether no coefficient is larger than its size, and its error, allow.
[[maybe_unused]] inline bool isSizeBound(const MovingCross& n) {
  const double most = n.size + n.error;
  return !(maxNorm(n.c0) > most) && !(0.5 * maxNorm(n.c1) > most) &&
         !(maxNorm(n.c2) > most);
}

inline MovingCross cross(const StepSegment& a, const StepSegment& b) {
  const double norm = a.norm * b.norm;
  const Segment &of_a = a, &of_b = b;
  const MovingCross out{cross(of_a, of_b), 2 * norm, kCrossBound * norm};
  assert(!isInRange(norm) || isSizeBound(out));
  return out;
}

/// The volume spanned by u, v, w over an interval, with bounds that follow from norms
/// over the whole step. See EndsVolume in magnified_solve.cpp.
struct StepVolume : VolumeCubic {
  // Error bounds of the outer and inner coefficients; infinite if there is no bound.
  double outer, inner;

  bool hasBounds() const { return std::isfinite(outer); }
  /// All coefficients certainly have one sign, so there is no root.
  bool hasNoRoot() const {
    return (b[0] > outer && b[1] > inner && b[2] > inner && b[3] > outer) ||
           (b[0] < -outer && b[1] < -inner && b[2] < -inner && b[3] < -outer);
  }
  /// The ends certainly have opposite signs, so there is a root.
  bool changesSign() const {
    return (b[0] > outer && b[3] < -outer) || (b[0] < -outer && b[3] > outer);
  }
  /// The coefficients are rounding only: a subdivision will not show a sign.
  bool isLost() const {
    return std::abs(b[0]) <= outer && std::abs(b[1]) <= inner &&
           std::abs(b[2]) <= inner && std::abs(b[3]) <= outer;
  }
};

inline StepVolume spannedVolume(const StepSegment& u, const MovingCross& n) {
  const double size = u.norm * (0.5 * n.size);
  const double bound = isInRange(size) && isInRange(n.size)
                           ? size
                           : std::numeric_limits<double>::infinity();
  return {VolumeCubic::of(u, n), kOuterBound * bound, kInnerBound * bound};
}

/// Sign of the quartic q . n over the whole segment. Not the same as sideOver() in
/// magnified_solve.cpp: the sum of three is added in another order, and rounds otherwise.
inline Side sideOver(const MovingCross& q, const MovingCross& n) {
  const double size = q.size * n.size;
  if (!isInRange(size) || !isInRange(q.size) || !isInRange(n.size)) return Side::kLost;
  const double c[5] = {dot(q.c0, n.c0), dot(q.c0, n.c1) + dot(q.c1, n.c0),
                       dot(q.c0, n.c2) + dot(q.c2, n.c0) + dot(q.c1, n.c1),
                       dot(q.c1, n.c2) + dot(q.c2, n.c1), dot(q.c2, n.c2)};
  const double bound = kInsideTerms * (q.size * n.error + q.error * (n.size + n.error)) +
                       kInsideRounding * size;
  bool positive = true, negative = true;
  for (const double ck : c) {
    positive &= ck > bound;
    negative &= ck < -bound;
  }
  if (positive) return Side::kPositive;
  if (negative) return Side::kNegative;
  for (const double ck : c)
    if (std::abs(ck) > bound) return Side::kMixed;
  return Side::kLost;
}

/// The pair as differences, see pair_table.h.
struct MovingPair {
  const PairTable& table;
  Difference difference[kNumPairDifferences];

  MovingPair(ContinuousContactKind k, const FeaturePoints& x) : table(pairTable(k)) {
    for (int i = 0; i < table.num_differences; ++i) {
      const auto [to, from] = table.difference[i];
      difference[i] = {x[to], x[from]};
    }
  }

  /// The direction from one feature to the nearest point of the other.
  Vec directionAt(double t) const {
    Vec at_t[4] = {};
    for (int i = 0; i < table.num_corners; ++i)
      at_t[i] = table.corner[i].sign * difference[table.corner[i].difference].at(t);
    return separatingDirection(at_t, table.isTriangle());
  }
};

/// Whether a plane through the origin keeps all differences of the features' vertices on
/// one side at lo and hi, and so in between. Its normal is the direction from one feature
/// to the nearest point of the other in the middle of [lo, hi]. No other test decides
/// pairs without a normal (parallel edges, triangles without area).
inline bool areSeparated(const MovingPair& pair, double lo, double hi) {
  assert(lo <= hi);
  const Vec d = pair.directionAt(lo + 0.5 * (hi - lo));
  const double size = maxNorm(d);
  for (int i = 0; i < pair.table.num_corners; ++i) {
    const auto [place, sign] = pair.table.corner[i];
    const Difference& corner = pair.difference[place];
    const double scale = size * corner.norm;
    if (!isInRange(scale)) return false;
    if (!(sign * dot(d, corner.at(lo)) > kSideBound * scale) ||
        !(sign * dot(d, corner.at(hi)) > kSideBound * scale))
      return false;
  }
  return true;
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
