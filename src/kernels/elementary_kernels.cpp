// SPDX-License-Identifier: BSD-3-Clause
//
// The elementary test of eight pairs: coplanarity filter, solve, division of windows; and
// the crossings of eight edges and faces at t = 0.
#include <algorithm>
#include <cassert>
#include <cfloat>

#if defined(FCL_CCD_USE_HIGHWAY)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "kernels/elementary_kernels.cpp"
#include "hwy/foreach_target.h"
#endif

#include "elementary/pair_table.h"
#include "kernels/eight_features.h"
#include "kernels/kernel_functions.h"
#include "kernels/lanes.h"
#include "kernels/vectors.h"
#include "numerics/error_bounds.h"

HWY_BEFORE_NAMESPACE();
namespace fcl {
namespace detail {
namespace deformable {
namespace HWY_NAMESPACE {

/// Eight differences of points: at both ends of an interval, and their norms over the
/// whole step.
struct Segments {
  Vectors l, h;
  Doubles norm;
};

/// Eight differences of points over the whole step, and their norms.
struct Differences {
  Vectors t0, t1;
  Doubles norm;
};

FCL_CCD_INLINE Differences differences(const Points& x, const PairTable::Ends& ends) {
  const Vectors t0 = x.t0[ends.to] - x.t0[ends.from],
                t1 = x.t1[ends.to] - x.t1[ends.from];
  return {t0, t1, max(max(maxNorm(t0), maxNorm(t1)), broadcast<kEight>(kLeastNorm))};
}

FCL_CCD_INLINE Segments restrict(const Differences& d, const Doubles& lo,
                                 const Doubles& hi) {
  return {at(d.t0, d.t1, lo), at(d.t0, d.t1, hi), d.norm};
}

/// Volume and normal over a part of the step, as in solveCoplanarity().
struct MovingCrosses {
  Vectors c0, c1, c2;
  Doubles norm;
};

FCL_CCD_INLINE MovingCrosses cross(const Segments& a, const Segments& b) {
  return {cross(a.l, b.l), cross(a.l, b.h) + cross(a.h, b.l), cross(a.h, b.h),
          a.norm * b.norm};
}

struct Cubics {
  Doubles b0, b1, b2, b3, outer, inner;
  DoubleMask has_bounds;

  FCL_CCD_INLINE DoubleMask hasNoRoot() const {
    const Doubles zero = broadcast<kEight>(0.), outer_n = zero - outer,
                  inner_n = zero - inner;
    return has_bounds &
           (((b0 > outer) & (b1 > inner) & (b2 > inner) & (b3 > outer)) |
            ((b0 < outer_n) & (b1 < inner_n) & (b2 < inner_n) & (b3 < outer_n)));
  }
  FCL_CCD_INLINE DoubleMask changesSign() const {
    const Doubles outer_n = broadcast<kEight>(0.) - outer;
    return has_bounds &
           (((b0 > outer) & (b3 < outer_n)) | ((b0 < outer_n) & (b3 > outer)));
  }
};

FCL_CCD_INLINE Cubics spannedVolume(const Segments& u, const MovingCrosses& n) {
  const Doubles size = u.norm * n.norm;
  return {dot(u.l, n.c0),
          dot(u.h, n.c0) + dot(u.l, n.c1),
          dot(u.h, n.c1) + dot(u.l, n.c2),
          dot(u.h, n.c2),
          broadcast<kEight>(kOuterBound) * size,
          broadcast<kEight>(kInnerBound) * size,
          isInRange(size) & isInRange(n.norm)};
}

EightCoplanarities coplanarity(ContinuousContactKind kind, const TrianglePair* pairs,
                               const std::uint32_t* codes, const TimeWindow* windows,
                               std::size_t count, double latest) {
  assert(1 <= count && count <= kEight);
  // If there are fewer than eight pairs, the last one is repeated.
  std::uint32_t eight_codes[kEight];
  TimeWindow eight_windows[kEight];
  if (count < kEight) {
    for (std::size_t lane = 0; lane < kEight; ++lane) {
      eight_codes[lane] = codes[lane < count ? lane : count - 1];
      eight_windows[lane] = windows[lane < count ? lane : count - 1];
    }
    codes = eight_codes;
    windows = eight_windows;
  }
  const PairTable& table = pairTable(kind);
  const Points x(EightFeatures(pairs, codes));
  Doubles starts, ends;
  static_assert(sizeof(TimeWindow) == 2 * sizeof(float), "two floats each");
  loadTwoEach(&windows->lo, starts, ends);
  // As windowLo() and windowHi().
  const Doubles margin = broadcast<kEight>(kWindowMargin);
  const Doubles lo = max(broadcast<kEight>(0.), starts - margin),
                hi = min(broadcast<kEight>(latest),
                         min(broadcast<kEight>(1.), ends + margin));
  const Segments u = restrict(differences(x, table.difference[kU]), lo, hi),
                 v = restrict(differences(x, table.difference[kV]), lo, hi),
                 w = restrict(differences(x, table.difference[kW]), lo, hi);
  const Cubics f = spannedVolume(u, cross(v, w));
  // If one number is a NaN, min() and max() return the second argument. The order of
  // arguments is that of the scalar filter.
  const Doubles scale = broadcast<kEight>(kInnerScale);
  const Doubles b1 = scale * f.b1, b2 = scale * f.b2;
  const Doubles least = min(min(f.b0, b1), min(f.b3, b2)),
                most = max(max(f.b0, b1), max(f.b3, b2));
  const Doubles norm = max(max(u.norm, v.norm), w.norm), zero = broadcast<kEight>(0.),
                bound = broadcast<kEight>(kOuterBound) * (norm * norm * norm);
  const unsigned signs_agree = bits(((least > zero) | (most < zero)) &
                                    (norm > broadcast<kEight>(kLeastFilterNorm)) &
                                    (norm < broadcast<kEight>(kMostFilterNorm)));
  const unsigned clear = bits((least > bound) | (most < zero - bound));
  const unsigned used = (1U << count) - 1;
  return {used & ~signs_agree, used & signs_agree & ~clear};
}

/// The differences of which the volumes and the inside conditions are products.
struct Pairs {
  const PairTable& table;
  Differences difference[kQ + 1];

  FCL_CCD_INLINE explicit Pairs(const EightPairs& pairs) : table(pairTable(pairs.kind)) {
    const Points x(pairs);
    for (std::size_t i = 0; i <= kQ; ++i)
      difference[i] = differences(x, table.difference[i]);
  }
};

/// Lanes in which the inside conditions are certain: all are positive, or one of them is
/// negative.
struct Sides {
  DoubleMask positive, negative;

  FCL_CCD_INLINE void require(const MovingCrosses& q, const MovingCrosses& n) {
    const Doubles size = q.norm * n.norm;
    const DoubleMask valid = isInRange(size) & isInRange(q.norm) & isInRange(n.norm);
    const Doubles bound = broadcast<kEight>(kInsideBound) * size,
                  minus = broadcast<kEight>(0.) - bound;
    const Doubles c[5] = {dot(q.c0, n.c0), dot(q.c0, n.c1) + dot(q.c1, n.c0),
                          dot(q.c0, n.c2) + dot(q.c2, n.c0) + dot(q.c1, n.c1),
                          dot(q.c1, n.c2) + dot(q.c2, n.c1), dot(q.c2, n.c2)};
    DoubleMask above = valid, below = valid;
    for (const Doubles& ck : c) {
      above = above & (ck > bound);
      below = below & (ck < minus);
    }
    positive = positive & above;
    negative = negative | below;
  }
};

FCL_CCD_INLINE Sides insideness(const Pairs& pairs, const Doubles& lo, const Doubles& hi,
                                const Segments& u, const Segments& v, const Segments& w,
                                const MovingCrosses& n) {
  const Segments r = restrict(pairs.difference[kR], lo, hi),
                 q = restrict(pairs.difference[kQ], lo, hi);
  const Segments* const segments[] = {&u, &v, &w, &r, &q};
  const Doubles zero = broadcast<kEight>(0.);
  Sides sides = {zero <= zero, zero < zero};
  for (int i = 0; i < pairs.table.num_inside; ++i) {
    const auto& [a, b] = pairs.table.inside[i];
    sides.require(cross(*segments[a], *segments[b]), n);
  }
  return sides;
}

/// Roots of cubics that change sign. The first step is false position, the others are
/// Halley's method, whose error is the third power of the one before. If a step leaves
/// the bracket, the bracket is halved. Each lane stops when the square of its step is
/// within its tolerance, so that no lane depends on the others. The caller has to prove
/// what it concludes from the result.
/// @param open  the lanes that are computed, a bit each
FCL_CCD_INLINE Doubles root(const Cubics& f, unsigned open, const Doubles& tolerance) {
  constexpr int kMaxSteps = 24;
  const Doubles zero = broadcast<kEight>(0.), one = broadcast<kEight>(1.),
                half = broadcast<kEight>(0.5), two = broadcast<kEight>(2.),
                three = broadcast<kEight>(3.);
  // c0 + c1 x + c2 x^2 + c3 x^3, scaled so that it falls by 1 from 0 to 1.
  const Doubles scale = one / (f.b0 - f.b3);
  const Doubles c0 = f.b0 * scale, b1 = f.b1 * scale, b2 = f.b2 * scale,
                b3 = f.b3 * scale;
  const Doubles c1 = b1 - three * c0, c2 = b2 - two * b1 + three * c0,
                c3 = (b3 - b2) + (b1 - c0);
  const Doubles twice_c2 = two * c2, thrice_c3 = three * c3;
  Doubles a = zero, b = one, x = c0;
  DoubleMask arrived = zero > zero;
  for (int i = 0; i < kMaxSteps && (open & ~bits(arrived)) != 0; ++i) {
    const Doubles value = ((c3 * x + c2) * x + c1) * x + c0,
                  slope = (thrice_c3 * x + twice_c2) * x + c1,
                  half_bend = thrice_c3 * x + c2;
    const Doubles step = value * slope / (slope * slope - value * half_bend);
    const DoubleMask is_before = value > zero;
    a = select(is_before, x, a);
    b = select(is_before, b, x);
    const Doubles next = x - step;
    const DoubleMask is_inside = (next >= a) & (next <= b);
    x = select(arrived, x, select(is_inside, next, half * (a + b)));
    arrived = arrived | (is_inside & (step * step <= tolerance));
  }
  return x;
}

#ifndef NDEBUG
/// Whether the brackets of proved contacts are in their windows, and as narrow as wanted.
bool areBrackets(const EightAnswers& answers, const EightPairs& x, double toc_err) {
  for (unsigned yes = answers.yes; yes != 0; yes &= yes - 1) {
    const int lane = lowestBit(yes);
    const double lo = answers.toc_lo[lane], hi = answers.toc_hi[lane];
    if (!(x.lo[lane] <= lo && lo <= hi && hi <= x.hi[lane] && hi - lo <= toc_err))
      return false;
  }
  return true;
}

/// Whether each window is divided where it begins, ends, or in between.
bool areInWindows(const double (&times)[8], const EightPairs& x) {
  for (std::size_t lane = 0; lane < kEight; ++lane)
    if (!(x.lo[lane] <= times[lane] && times[lane] <= x.hi[lane])) return false;
  return true;
}
#endif

EightAnswers solve(const EightPairs& x, double toc_err) {
  assert(toc_err > 0);
  const Pairs pairs(x);
  const Doubles lo = load<kEight>(x.lo), hi = load<kEight>(x.hi), width = hi - lo;
  const Segments u = restrict(pairs.difference[kU], lo, hi),
                 v = restrict(pairs.difference[kV], lo, hi),
                 w = restrict(pairs.difference[kW], lo, hi);
  const Cubics f = spannedVolume(u, cross(v, w));
  EightAnswers answers;
  answers.yes = 0;
  answers.no = bits(f.hasNoRoot());
  const unsigned open = bits(f.changesSign());
  if (open == 0) return answers;

  // [a, b] is around the root; outside of it there is no other. A step d leaves an error
  // of about d^3, and many times that if other roots are near. So d^2 must be far below
  // the width.
  const Doubles half = broadcast<kEight>(0.25 * toc_err);
  const Doubles t = lo + root(f, open, broadcast<kEight>(0x1p-10) * half / width) * width;
  const Doubles a = max(lo, t - half), b = min(hi, t + half);
  const Segments ua = restrict(pairs.difference[kU], a, b),
                 va = restrict(pairs.difference[kV], a, b),
                 wa = restrict(pairs.difference[kW], a, b);
  const MovingCrosses na = cross(va, wa);
  const Sides sides = insideness(pairs, a, b, ua, va, wa, na);
  const unsigned crosses = bits(spannedVolume(ua, na).changesSign());
  const auto isFree = [&](const Doubles& from, const Doubles& to) HWY_ATTR {
    const Segments us = restrict(pairs.difference[kU], from, to),
                   vs = restrict(pairs.difference[kV], from, to),
                   ws = restrict(pairs.difference[kW], from, to);
    return bits(spannedVolume(us, cross(vs, ws)).hasNoRoot() | (from >= to));
  };
  const unsigned first = open & isFree(lo, a);
  answers.yes = first & crosses & bits(sides.positive);
  const unsigned outside = first & bits(sides.negative);
  if (outside != 0) answers.no |= outside & isFree(b, hi);
  store(a, answers.toc_lo);
  store(b, answers.toc_hi);
  assert((answers.yes & answers.no) == 0 && areBrackets(answers, x, toc_err));
  return answers;
}

/// Lanes in which the sign of a volume is certain, as in orientation().
struct Orientations {
  DoubleMask positive, negative;

  /// @param normal  v x w; the volume is u . normal
  /// @param norms  the product of the norms of v and w
  FCL_CCD_INLINE Orientations(const Vectors& u, const Vectors& normal,
                              const Doubles& norms)
      : Orientations(dot(u, normal), maxNorm(u) * norms, norms) {}

 private:
  FCL_CCD_INLINE Orientations(const Doubles& volume, const Doubles& size,
                              const Doubles& norms) {
    const DoubleMask valid = isInRange(size) & isInRange(norms);
    const Doubles bound = broadcast<kEight>(kVolumeBound) * size;
    positive = valid & (volume > bound);
    negative = valid & (volume < broadcast<kEight>(0.) - bound);
  }
};

FCL_CCD_INLINE Orientations turnsOf(const Vectors& along, const Vectors& v,
                                    const Vectors& w) {
  return {along, cross(v, w), maxNorm(v) * maxNorm(w)};
}

/// The points of eight triangle pairs in one frame, relative to the first point.
struct TrianglePoints {
  Vectors x[6];
  /// The first point.
  Vectors origin;
  /// The fourth numbers of the vertices: at t = 0 their displacements.
  Doubles fourth[6];
  Doubles norm;

  /// @param frame  TreeVertex::t0 or t1
  FCL_CCD_INLINE TrianglePoints(const TrianglePair* pairs, std::size_t count,
                                double (TreeVertex::*frame)[4])
      : norm(broadcast<kEight>(0.)) {
    for (std::size_t i = 0; i < 6; ++i) {
      // If there are fewer than eight pairs, the last one is repeated.
      const auto row = [=](std::size_t lane) HWY_ATTR -> const double(&)[4] {
        return pairs[lane < count ? lane : count - 1].x[i]->*frame;
      };
      loadColumns(row, x[i].x, x[i].y, x[i].z, fourth[i]);
    }
    origin = x[0];
    for (std::size_t i = 6; i-- > 0;) {
      x[i] = x[i] - x[0];
      norm = max(norm, maxNorm(x[i]));
    }
  }

  /// The most by which two vertices of the triangles can approach each other along a
  /// coordinate axis during the step.
  FCL_CCD_INLINE Doubles approach() const {
    return max(max(fourth[0], fourth[1]), fourth[2]) +
           max(max(fourth[3], fourth[4]), fourth[5]);
  }
};

/// How far the second triangles lie above the first ones, along a direction, and below
/// them. They are apart where this is valid and more than `least`.
struct PlaneGaps {
  Doubles above, below, least;
  DoubleMask is_valid;
};

/// The gaps along the direction d. The least one is enough even if vertices approach each
/// other by `approach` along each axis; with a distance, they stay further apart than
/// this. The factor of the distance has more than the rounding of the length of d, a few
/// units.
FCL_CCD_INLINE PlaneGaps planeGaps(const TrianglePoints& p, const Vectors& d,
                                   const Doubles& approach, double distance) {
  const Doubles a[3] = {dot(d, p.x[0]), dot(d, p.x[1]), dot(d, p.x[2])},
                b[3] = {dot(d, p.x[3]), dot(d, p.x[4]), dot(d, p.x[5])};
  const Doubles size = maxNorm(d), volume = size * p.norm;
  PlaneGaps out{min(min(b[0], b[1]), b[2]) - max(max(a[0], a[1]), a[2]),
                min(min(a[0], a[1]), a[2]) - max(max(b[0], b[1]), b[2]),
                broadcast<kEight>(kPlaneBound) * volume +
                    broadcast<kEight>(kPlaneApproach) * size * approach,
                isInRange(volume)};
  if (distance > 0) {
    const Doubles square = dot(d, d);
    out.is_valid = out.is_valid & isInRange(square);
    out.least = out.least + squareRoot(square) * broadcast<kEight>(distance * kUpward);
  }
  return out;
}

FCL_CCD_INLINE DoubleMask areSeparated(const TrianglePoints& p, const Vectors& d,
                                       const Doubles& approach, double distance) {
  const PlaneGaps gaps = planeGaps(p, d, approach, distance);
  return gaps.is_valid & ((gaps.above > gaps.least) | (gaps.below > gaps.least));
}

unsigned areApart(const TrianglePair* pairs, std::size_t count, double share,
                  double distance, float (&gaps)[8]) {
  assert(1 <= count && count <= kEight && share >= 0 && distance >= 0);
  const TrianglePoints p(pairs, count, &TreeVertex::t0);
  const Doubles bridged = broadcast<kEight>(share) * p.approach();
  store(roundedUp(bridged + bridged, broadcast<kEight>(FLT_MIN)), gaps);
  assert(*std::min_element(gaps, gaps + kEight) >= 0);
  const DoubleMask apart =
      areSeparated(p, cross(p.x[1], p.x[2]), bridged, distance) |
      areSeparated(p, cross(p.x[4] - p.x[3], p.x[5] - p.x[3]), bridged, distance);
  return bits(apart) & ((1U << count) - 1);
}

/// How far along a direction the bends of a body's three vertices go, at least and at
/// most.
struct BendRange {
  Doubles least{broadcast<kEight>(0.)}, most{least};

  /// @param twice  twice the places of the vertices in the middle of the step, relative
  /// to `origin`
  FCL_CCD_INLINE BendRange(const Bend* bend, const Vectors& origin,
                           const Vectors (&twice)[3], const Vectors& d) {
    if (!bend) return;
    const Vectors half = broadcast<kEight>(0.5) * product(bend->matrix, d);
    const Doubles along[3] = {dot(half, twice[0]), dot(half, twice[1]),
                              dot(half, twice[2])},
                  offset = dot(half, origin) + dot(d, allOf(bend->offset));
    least = min(min(along[0], along[1]), along[2]) + offset;
    most = max(max(along[0], along[1]), along[2]) + offset;
  }
};

/// The gap along a direction is at least (1 - t) g0 + t g1 + 4 t (1 - t) s, with g0 and
/// g1 those at both ends of the step and s the least difference of the bends along it.
unsigned stayApart(const TrianglePair* pairs, std::size_t count, double distance,
                   const PairBends& bends) {
  assert(1 <= count && count <= kEight);
  assert(distance > 0 || (distance == 0 && !bends.isAny()));
  const TrianglePoints begin(pairs, count, &TreeVertex::t0),
      end(pairs, count, &TreeVertex::t1);
  const Doubles zero = broadcast<kEight>(0.);
  const Vectors origin = begin.origin + end.origin;
  Vectors twice[2][3];
  for (std::size_t k = 0; k < 2; ++k)
    for (std::size_t i = 0; i < 3; ++i)
      twice[k][i] = begin.x[3 * k + i] + end.x[3 * k + i];
  DoubleMask apart = zero > zero;
  for (const auto& corner : twice) {
    const Vectors d = cross(corner[1] - corner[0], corner[2] - corner[0]);
    const PlaneGaps from = planeGaps(begin, d, zero, distance),
                    to = planeGaps(end, d, zero, distance);
    const DoubleMask is_valid = from.is_valid & to.is_valid;
    if (bends.isAny()) {
      const BendRange a(bends.of[0], origin, twice[0], d),
          b(bends.of[1], origin, twice[1], d);
      apart =
          apart |
          (is_valid &
           (staysAbove(from.above - from.least, to.above - to.least, b.least - a.most) |
            staysAbove(from.below - from.least, to.below - to.least, a.least - b.most)));
    } else {
      apart = apart | (is_valid & (((from.above > from.least) & (to.above > to.least)) |
                                   ((from.below > from.least) & (to.below > to.least))));
    }
  }
  return bits(apart) & ((1U << count) - 1);
}

unsigned mayCross(const TrianglePair* pairs, const std::uint32_t* codes,
                  std::size_t count) {
  assert(1 <= count && count <= kEight);
  const TreeVertex* points[kEight][5];
  for (std::size_t lane = 0; lane < kEight; ++lane)
    // If there are fewer than eight, the last one is repeated.
    crossingPoints(pairs, codes[lane < count ? lane : count - 1], points[lane]);
  Vectors x[5];
  for (std::size_t i = 0; i < 5; ++i) {
    const auto row = [&points, i](std::size_t lane)
                         HWY_ATTR { return points[lane][i]->t0; };
    loadColumns(row, x[i].x, x[i].y, x[i].z);
  }
  const auto& [p, q, a, b, c] = x;
  const Vectors v = b - a, w = c - a, normal = cross(v, w);
  const Doubles norms = maxNorm(v) * maxNorm(w);
  const Orientations from(p - a, normal, norms), to(q - a, normal, norms);
  const unsigned on_one_side =
      bits((from.positive & to.positive) | (from.negative & to.negative));
  const unsigned open = ((1U << count) - 1) & ~on_one_side;
  if (open == 0) return 0;
  // Outside of the face, the line through p and q passes one edge clockwise and another
  // one counter-clockwise.
  const Vectors along = q - p, pa = a - p, pb = b - p, pc = c - p;
  const Orientations ab = turnsOf(along, pa, pb), bc = turnsOf(along, pb, pc),
                     ca = turnsOf(along, pc, pa);
  const unsigned beside = bits((ab.positive | bc.positive | ca.positive) &
                               (ab.negative | bc.negative | ca.negative));
  return open & ~beside;
}

/// For cubics with the same sign at 0 and at 1, the time in between at which the cubic is
/// nearest to zero or passes furthest beyond it, computed in doubles. 1/2 if there is
/// none.
FCL_CCD_INLINE Doubles nearestToZero(const Cubics& f) {
  const Doubles zero = broadcast<kEight>(0.), three = broadcast<kEight>(3.),
                half = broadcast<kEight>(0.5);
  // The slope has Bernstein coefficients e0, e1, e2; it rises through zero at s / (1 - s)
  // = (q - e1) / e2 = -e0 / (q + e1), q^2 = e1^2 - e0 e2.
  const DoubleMask below = f.b0 < zero;
  const auto turned = [&](const Doubles& e)
                          HWY_ATTR { return select(below, zero - e, e); };
  const Doubles e0 = turned(f.b1 - three * f.b0), e1 = turned(f.b2 - f.b1),
                e2 = turned(three * f.b3 - f.b2);
  const Doubles q = squareRoot(e1 * e1 - e0 * e2);
  const DoubleMask is_late = e1 < zero;
  const Doubles part = select(is_late, q - e1, zero - e0),
                rest = select(is_late, e2, q + e1);
  const Doubles s = part / (part + rest);
  return select((s > zero) & (s < broadcast<kEight>(1.)), s, half);
}

EightDivisions divide(const EightPairs& x) {
  const Pairs pairs(x);
  const Doubles lo = load<kEight>(x.lo), hi = load<kEight>(x.hi);
  const Segments u = restrict(pairs.difference[kU], lo, hi),
                 v = restrict(pairs.difference[kV], lo, hi),
                 w = restrict(pairs.difference[kW], lo, hi);
  const MovingCrosses n = cross(v, w);
  EightDivisions out;
  out.never_inside = bits(insideness(pairs, lo, hi, u, v, w, n).negative);
  const Cubics f = spannedVolume(u, n);
  out.divisible = bits(f.has_bounds & (abs(f.b0) > f.outer) & (abs(f.b3) > f.outer));
  const Doubles s = nearestToZero(f);
  store(min(hi, lo + s * (hi - lo)), out.at);
  assert(areInWindows(out.at, x));
  return out;
}

}  // namespace HWY_NAMESPACE
}  // namespace deformable
}  // namespace detail
}  // namespace fcl
HWY_AFTER_NAMESPACE();
