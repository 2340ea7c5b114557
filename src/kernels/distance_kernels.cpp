// SPDX-License-Identifier: BSD-3-Clause
//
// The distance filter of eight pairs: a direction that separates them at both ends of
// their windows.
#include <cassert>
#include <cfloat>

#if defined(FCL_CCD_USE_HIGHWAY)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "kernels/distance_kernels.cpp"
#include "hwy/foreach_target.h"
#endif

#include "elementary/distance_advance.h"
#include "kernels/eight_features.h"
#include "kernels/kernel_functions.h"
#include "kernels/lanes.h"
#include "kernels/vectors.h"

HWY_BEFORE_NAMESPACE();
namespace fcl {
namespace detail {
namespace deformable {
namespace HWY_NAMESPACE {

/// The shortest of some vectors so far.
struct Shortest {
  Vectors vector;
  Doubles square;

  FCL_CCD_INLINE void take(const Vectors& v, const DoubleMask& is_valid) {
    const Doubles other = dot(v, v);
    const DoubleMask is_shorter = is_valid & (other < square);
    vector = select(is_shorter, v, vector);
    square = select(is_shorter, other, square);
  }
};

/// Takes the point of the side pq that is nearest to the origin.
FCL_CCD_INLINE void takeSide(const Vectors& p, const Vectors& q, Shortest& best) {
  const Doubles zero = broadcast<kEight>(0.), one = broadcast<kEight>(1.);
  const Vectors way = q - p;
  const Doubles length = dot(way, way), along = zero - dot(p, way);
  // A NaN of a side without length becomes 0.
  const Doubles s = min(one, max(along / length, zero));
  best.take(p + s * way, zero <= zero);
}

/// The vector from the origin to about the nearest point of a polygon of three or four
/// corners, as nearestPoint() has it. It may be imprecise for slivers.
struct Nearest {
  Vectors vector;
  /// The square of the distance of a point of the polygon, near that point.
  Doubles reached;

  FCL_CCD_INLINE Nearest(const Vectors* corner, int count) {
    const Doubles zero = broadcast<kEight>(0.);
    Shortest best{corner[0], dot(corner[0], corner[0])};
    for (int k = 0; k < count; ++k)
      takeSide(corner[k], corner[k + 1 < count ? k + 1 : 0], best);
    const Vectors v = corner[1] - corner[0], w = corner[count - 1] - corner[0],
                  n = cross(v, w);
    const Doubles square = dot(n, n), along = dot(cross(w, corner[0]), n),
                  across = dot(cross(corner[0], v), n);
    const DoubleMask is_inside =
        (along > zero) & (across > zero) &
        (count == 3 ? (along + across < square) : (along < square) & (across < square));
    const Vectors inside = corner[0] + (along / square) * v + (across / square) * w;
    reached = select(is_inside, dot(inside, inside), best.square);
    best.take((dot(corner[0], n) / square) * n, is_inside);
    vector = best.vector;
  }
};

/// The bends of the points of eight pairs of features.
class PointBends {
 public:
  /// @param codes  of the pairs of features
  FCL_CCD_INLINE PointBends(const PairBends& bends, ContinuousContactKind kind,
                            const std::uint32_t* codes)
      : bends_(bends) {
    // The vertices 0 to 2 belong to a, the others to b.
    constexpr unsigned kVerticesOfA = 3;
    double first_on_a[kEight];
    for (std::size_t lane = 0; lane < kEight; ++lane)
      first_on_a[lane] =
          kind == ContinuousContactKind::kEdgeEdge || codeBit(codes[lane]) < kVerticesOfA;
    first_on_a_ = load<kEight>(first_on_a) > broadcast<kEight>(0.);
  }

  /// The difference of the bends of a point of the second feature and one of the first.
  FCL_CCD_INLINE Vectors between(const Points& x, const CornerPoints& p) const {
    const Vectors first = x.t0[p.first] + x.t1[p.first],
                  second = x.t0[p.second] + x.t1[p.second];
    const Vectors of_a = bendOf(bends_.of[0], select(first_on_a_, first, second)),
                  of_b = bendOf(bends_.of[1], select(first_on_a_, second, first));
    return select(first_on_a_, of_b - of_a, of_a - of_b);
  }

 private:
  static FCL_CCD_INLINE Vectors bendOf(const Bend* bend, const Vectors& twice) {
    const Doubles zero = broadcast<kEight>(0.);
    if (!bend) return {zero, zero, zero};
    return broadcast<kEight>(0.5) * product(bend->matrix, twice) + allOf(bend->offset);
  }

  const PairBends& bends_;
  DoubleMask first_on_a_;
};

/// Differences of the points of two features, at both ends of the window, in the order of
/// DifferencePolygon, and a bound on their coordinates.
struct MovingPolygons {
  Vectors l[4], h[4];
  /// By how much corners deviate from straight lines during the window, in its middle.
  Vectors bend[4];
  Doubles norm;
  int count;

  FCL_CCD_INLINE MovingPolygons(ContinuousContactKind kind, const Points& x,
                                const Doubles& lo, const Doubles& hi)
      : norm(broadcast<kEight>(0.)),
        count(kind == ContinuousContactKind::kVertexFace ? 3 : 4) {
    for (int k = 0; k < count; ++k) {
      const CornerPoints p = DifferencePolygon::pointsOf(kind, k);
      const Vectors t0 = x.t0[p.second] - x.t0[p.first],
                    t1 = x.t1[p.second] - x.t1[p.first];
      norm = max(max(maxNorm(t0), maxNorm(t1)), norm);
      l[k] = at(t0, t1, lo);
      h[k] = at(t0, t1, hi);
    }
  }

  /// On a part of the step of the length h the path of a corner is bent by h^2 of what it
  /// is during the whole step.
  FCL_CCD_INLINE void setBends(ContinuousContactKind kind, const Points& x,
                               const PointBends& bends, const Doubles& lo,
                               const Doubles& hi) {
    const Doubles one = broadcast<kEight>(1.), four = broadcast<kEight>(4.),
                  at_lo = four * (lo * (one - lo)), at_hi = four * (hi * (one - hi)),
                  within = (hi - lo) * (hi - lo);
    for (int k = 0; k < count; ++k) {
      const Vectors whole = bends.between(x, DifferencePolygon::pointsOf(kind, k));
      l[k] = l[k] + at_lo * whole;
      h[k] = h[k] + at_hi * whole;
      bend[k] = within * whole;
    }
  }
};

/// Numbers with squares and fourth powers in the range of double.
FCL_CCD_INLINE DoubleMask isMiddling(const Doubles& size) {
  return (size >= broadcast<kEight>(0x1p-200)) & (size <= broadcast<kEight>(0x1p200));
}

/// The tolerances that the filter leaves to advanceToDistance(), which reports what comes
/// within d (1 + kShare) + kTouching (d + 2 N), with N the norm. u = 2^-53. A corner is
/// off by 8 u of its length, which is below 2 N, a product with it by 3 u more: 22 u N
/// times the length of the direction, which rounds by 3 u. Twice these tolerances are
/// more than all of it.
constexpr double kTouchingTwice = 2 * DistanceTolerance::kTouching;

/// The distance from which on pairs may be left out. Of a pair that is nearer than the
/// wanted distance at t = 0, if it is ignored then: that of a point at t = 0, less a
/// share of 1e-9. advanceToDistance() takes off 2e-9 and two tolerances of a distance
/// that differs by less than half of one. Pairs that almost touch are left to it,
/// relative to N: rounding may hide their distance.
/// @param reached  the square of the distance of this point
FCL_CCD_INLINE Doubles leastApart(const Doubles& lo, const Doubles& norm,
                                  const Doubles& reached, double distance, bool ignores) {
  const Doubles usual =
      broadcast<kEight>(distance * (1 + 2 * DistanceTolerance::kShare + kTouchingTwice)) +
      broadcast<kEight>(2 * kTouchingTwice) * norm;
  if (!ignores) return usual;
  const Doubles initial = squareRoot(reached);
  const DoubleMask is_nearer = (lo <= broadcast<kEight>(0.)) &
                               (initial <= broadcast<kEight>(distance)) &
                               (initial > broadcast<kEight>(DistanceTolerance::kAlmost) *
                                              max(norm, broadcast<kEight>(distance)));
  return select(is_nearer, initial * broadcast<kEight>(1 - DistanceTolerance::kShare),
                usual);
}

/// The direction is that of the nearest points in the middle of the window; at its
/// beginning, where pairs are compared with their distance at t = 0. This pays if the
/// window is short.
unsigned mayComeWithin(ContinuousContactKind kind, const TrianglePair* pairs,
                       const std::uint32_t* codes, const TimeWindow* windows,
                       std::size_t count, const DistanceRequest& request,
                       const PairBends& bends) {
  assert(1 <= count && count <= kEight && request.distance >= 0);
  // Copies of the last pair fill the empty lanes.
  std::uint32_t eight_codes[kEight];
  TimeWindow eight_windows[kEight];
  for (std::size_t lane = 0; lane < kEight; ++lane) {
    eight_codes[lane] = codes[lane < count ? lane : count - 1];
    eight_windows[lane] = windows[lane < count ? lane : count - 1];
  }
  Doubles starts, ends;
  loadTwoEach(&eight_windows->lo, starts, ends);
  // windowLo() and windowHi().
  const Doubles margin = broadcast<kEight>(kWindowMargin);
  const Doubles lo = max(broadcast<kEight>(0.), starts - margin),
                hi = min(broadcast<kEight>(request.t_stop),
                         min(broadcast<kEight>(1.), ends + margin));
  const Points points{EightFeatures(pairs, eight_codes)};
  MovingPolygons x(kind, points, lo, hi);
  if (bends.isAny())
    x.setBends(kind, points, PointBends(bends, kind, eight_codes), lo, hi);
  const bool ignores = request.ignores_initially_closer && isEarly(request.t_stop);
  Vectors middle[4];
  for (int k = 0; k < x.count; ++k)
    middle[k] = ignores ? x.l[k] : broadcast<kEight>(0.5) * (x.l[k] + x.h[k]);
  const Nearest near(middle, x.count);
  const Vectors& n = near.vector;
  const Doubles square = dot(n, n);
  const Doubles least = squareRoot(square) *
                        leastApart(lo, x.norm, near.reached, request.distance, ignores);
  DoubleMask apart = isMiddling(x.norm) & isMiddling(square) &
                     isMiddling(broadcast<kEight>(request.distance));
  for (int k = 0; k < x.count; ++k) {
    const Doubles from = dot(n, x.l[k]), to = dot(n, x.h[k]);
    if (bends.isAny())
      apart = apart & staysAbove(from - least, to - least, dot(n, x.bend[k]));
    else
      apart = apart & (from > least) & (to > least);
  }
  return ((1U << count) - 1) & ~bits(apart);
}

}  // namespace HWY_NAMESPACE
}  // namespace deformable
}  // namespace detail
}  // namespace fcl
HWY_AFTER_NAMESPACE();
