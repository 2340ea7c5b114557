// SPDX-License-Identifier: BSD-3-Clause
#include "elementary/magnified_solve.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>

#include "elementary/interval_stack.h"
#include "elementary/pair_table.h"
#include "elementary/separating_direction.h"
#include "numerics/error_bounds.h"
#include "numerics/exact_polynomial.h"
#include "numerics/fixed_integer.h"
#include "numerics/illinois.h"
#include "numerics/moving_vector.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

// Error analysis, in units u = 2^-53 as in error_bounds.h. Each difference has been
// rounded once at each end of the interval. Bounds at an end are relative to the norms at
// this end. So if all differences shrink towards one end, the bounds shrink too. U0 is
// the norm of u at the beginning, U1 at the end, and so on.
//
// Volume. Outer coefficients: kVolumeBound. v0 x w1 + v1 x w0: each term has size 2 VW
// and an error of 8 u VW. The sum rounds by 2 u of V0 W1 + V1 W0 =: S. Its product with
// u0: three products (2 + 10 + 2) u U0 S, sums of sizes 4 and 6: 52 u U0 S. The sum with
// u1 . (v0 x w0), which has an error of 46 u, is below 6 (U1 V0 W0 + U0 S) in size: 58 u.
constexpr double kEndsVolumeBound = 64 * kUnit;
// Inside conditions. Components of a cross product have at most size 2 Q and an error of
// 10 u Q, with Q = X0 Y0, X0 Y1 + X1 Y0 or X1 Y1. A dot product of two such vectors:
// three products (20 + 20 + 4) u Q N, sums of sizes 8 and 12: 152 u Q N. Sums of three of
// these: 12 + 12 u.
constexpr double kEndsInsideBound = 192 * kUnit;

/// A vector that moves linearly, with its norms at both ends of an interval.
struct EndsSegment : Segment {
  double l_norm, h_norm;
};

EndsSegment segment(const Vec& l, const Vec& h) {
  return {{l, h}, maxNorm(l), maxNorm(h)};
}

/// A cross product with the size of each coefficient.
struct EndsCross : CrossCoefficients {
  double size[3];

  EndsCross(const EndsSegment& a, const EndsSegment& b)
      : CrossCoefficients(cross(a, b)),
        size{a.l_norm * b.l_norm, a.l_norm * b.h_norm + a.h_norm * b.l_norm,
             a.h_norm * b.h_norm} {}
};

/// The volume over the interval with a bound on the error of each coefficient, from the
/// norms at both ends. See StepVolume in moving_pair.h, which has one bound for the
/// whole step, and is faster.
struct EndsVolume : VolumeCubic {
  double error[4];

  EndsVolume(const EndsSegment& u, const EndsCross& n)
      : VolumeCubic(of(u, n)),
        error{u.l_norm * n.size[0], u.h_norm * n.size[0] + u.l_norm * n.size[1],
              u.h_norm * n.size[1] + u.l_norm * n.size[2], u.h_norm * n.size[2]} {
    for (double& e : error) e *= kEndsVolumeBound;
  }

  int sign(int i) const { return b[i] > error[i] ? 1 : b[i] < -error[i] ? -1 : 0; }
  bool hasNoRoot() const {
    const int first = sign(0);
    return first != 0 && sign(1) == first && sign(2) == first && sign(3) == first;
  }
  bool changesSign() const { return sign(0) * sign(3) < 0; }
  /// Whether the derivative certainly has one sign.
  bool isMonotone() const {
    const double d[3] = {b[1] - 3 * b[0], b[2] - b[1], 3 * b[3] - b[2]};
    // The half is for the rounding of the differences.
    const double bound[3] = {1.5 * (error[1] + 3 * error[0]), 1.5 * (error[2] + error[1]),
                             1.5 * (3 * error[3] + error[2])};
    return (d[0] > bound[0] && d[1] > bound[1] && d[2] > bound[2]) ||
           (d[0] < -bound[0] && d[1] < -bound[1] && d[2] < -bound[2]);
  }
  /// Whether the only roots are at ends where the volume is known to be zero.
  bool hasNoRootBetween(bool zero_at_0, bool zero_at_1) const {
    const int inside = sign(1);
    return inside != 0 && sign(2) == inside && (zero_at_0 || sign(0) == inside) &&
           (zero_at_1 || sign(3) == inside);
  }

  /// Whether the sign at s seems to be certain.
  bool seemsKnownAt(double s) const { return std::abs(mix(b, s)) > 2 * mix(error, s); }
  /// f times (1 - x + ratio x)^3, as a function of x with s / (1 - s) = ratio x / (1 -
  /// x).
  EndsVolume withRatio(double ratio) const {
    EndsVolume f = *this;
    double factor = 1;
    for (int i = 1; i < 4; ++i) {
      factor *= ratio;
      f.b[i] *= factor;
      f.error[i] *= factor;
    }
    return f;
  }
  /// Whether all coefficients are rounding only.
  bool isLost() const {
    return sign(0) == 0 && sign(1) == 0 && sign(2) == 0 && sign(3) == 0;
  }
  /// The place of the volume's extremum, if it has exactly one.
  void findTurn(double& s) const {
    const double d[3] = {b[1] - 3 * b[0], b[2] - b[1], 3 * b[3] - b[2]};
    if (d[0] == 0 || d[2] == 0 || (d[0] < 0) == (d[2] < 0)) return;
    s = illinois(
        [&d](double x) {
          const double r = 1 - x;
          return r * (d[0] * r + 2 * d[1] * x) + d[2] * x * x;
        },
        0, 1, d[0], d[2], 0x1p-40, 40);
  }
};

/// An interval from lo / 2^m to hi / 2^m.
struct Interval {
  DoubleWord lo, hi;
  unsigned m;
};

/// Whether an interval is in the step.
[[maybe_unused]] bool isInStep(const Interval& i) {
  return i.lo <= i.hi && i.hi <= DoubleWord{1} << i.m;
}

/// Whether an interval begins in the one before it, or where that ends.
[[maybe_unused]] bool isContinued(const Interval& before, const Interval& i) {
  const unsigned m = std::max(before.m, i.m);
  const DoubleWord lo = i.lo << (m - i.m);
  return before.lo << (m - before.m) <= lo && lo <= before.hi << (m - before.m);
}

/// The differences of the pair's points as integers, and what of them is in an interval.
/// Letters as in pair_table.h.
template <std::size_t kWords>
class MagnifiedPair {
 public:
  using Integer = FixedInteger<kWords>;
  /// The largest m of times with denominator 2^m.
  static constexpr int kMaxTimeBits = 124;

  MagnifiedPair(ContinuousContactKind kind, const FeaturePoints& x,
                const FrameDigits& digits)
      : kind_(kind) {
    // A difference of differences, and a sign.
    time_bits_ = std::min(kMaxTimeBits, Integer::kBits - digits.num_digits - 4);
    if (!fits()) return;
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t k = 0; k < 3; ++k) {
        // clang 14 captures no structured bindings.
        const int to = table().difference[i].to, from = table().difference[i].from;
        const auto difference = [&](int frame) {
          const auto at = [&](int p) {
            const BinaryDigits d((frame == 0 ? x[p].t0 : x[p].t1)[k]);
            const int shift = d.digits == 0 ? 0 : d.exponent - digits.lowest[frame];
            return Integer(d.digits, static_cast<unsigned>(shift));
          };
          return at(to) - at(from);
        };
        start_[i][k] = difference(0);
        change_[i][k] = difference(1) - start_[i][k];
      }
  }

  /// Whether the integers are long enough for a useful interval.
  bool fits() const { return time_bits_ >= kLeastTimeBits; }
  unsigned timeBits() const { return static_cast<unsigned>(time_bits_); }
  const PairTable& table() const { return pairTable(kind_); }

  void moveTo(const Interval& i) {
    assert(isInStep(i) && i.m <= timeBits());
    double largest = 0;
    for (std::size_t j = 0; j < 3; ++j) {
      for (std::size_t k = 0; k < 3; ++k) {
        at_lo_[j][k] = (start_[j][k] << i.m) + change_[j][k] * i.lo;
        at_hi_[j][k] = at_lo_[j][k] + change_[j][k] * (i.hi - i.lo);
      }
      scale_ = 1;
      uvw_[j] = rounded(at_lo_[j], at_hi_[j]);
      largest = std::max(largest, std::max(uvw_[j].l_norm, uvw_[j].h_norm));
    }
    // A power of two rounds nothing. It keeps products of four in range.
    if (largest == 0) return;
    scale_ = Integer::powerOfTwo(-std::ilogb(largest));
    for (EndsSegment& s : uvw_) {
      s.l = scale_ * s.l;
      s.h = scale_ * s.h;
      s.l_norm *= scale_;
      s.h_norm *= scale_;
    }
  }

  const EndsSegment& u() const { return uvw_[0]; }
  const EndsSegment& v() const { return uvw_[1]; }
  const EndsSegment& w() const { return uvw_[2]; }
  EndsSegment difference(PairDifference i) const {
    return i <= kW ? uvw_[i] : sumOf(table().sum[i - kR]);
  }

 private:
  using Point = Integer[3];
  static constexpr int kLeastTimeBits = 60;

  EndsSegment rounded(const Point& lo, const Point& hi) const {
    const auto vec = [this](const Point& p) {
      return scale_ * Vec{p[0].toDouble(), p[1].toDouble(), p[2].toDouble()};
    };
    return segment(vec(lo), vec(hi));
  }
  /// These multiples of u, v and w, added up before they are rounded. The last one that
  /// is not 0 is 1.
  EndsSegment sumOf(const signed char (&multiple)[3]) const {
    std::size_t last = 2;
    while (multiple[last] == 0) --last;
    assert(multiple[last] == 1);
    Point lo, hi;
    for (std::size_t k = 0; k < 3; ++k) {
      lo[k] = at_lo_[last][k];
      hi[k] = at_hi_[last][k];
    }
    for (std::size_t j = 0; j < last; ++j) {
      if (multiple[j] == 0) continue;
      for (std::size_t k = 0; k < 3; ++k) {
        lo[k] = multiple[j] > 0 ? lo[k] + at_lo_[j][k] : lo[k] - at_lo_[j][k];
        hi[k] = multiple[j] > 0 ? hi[k] + at_hi_[j][k] : hi[k] - at_hi_[j][k];
      }
    }
    return rounded(lo, hi);
  }

  ContinuousContactKind kind_;
  int time_bits_;
  Point start_[3], change_[3];
  Point at_lo_[3], at_hi_[3];
  double scale_{1};
  EndsSegment uvw_[3];
};

/// Sign of the quartic q . n over the whole interval, kMixed if it is not certain. Not
/// the same as sideOver() in elementary.cpp: each coefficient has its own bound, and the
/// sum of three is added in another order.
Side sideOver(const EndsCross& q, const EndsCross& n) {
  const double c[5] = {dot(q.c0, n.c0), dot(q.c0, n.c1) + dot(q.c1, n.c0),
                       dot(q.c0, n.c2) + dot(q.c1, n.c1) + dot(q.c2, n.c0),
                       dot(q.c1, n.c2) + dot(q.c2, n.c1), dot(q.c2, n.c2)};
  const double size[5] = {
      q.size[0] * n.size[0], q.size[0] * n.size[1] + q.size[1] * n.size[0],
      q.size[0] * n.size[2] + q.size[1] * n.size[1] + q.size[2] * n.size[0],
      q.size[1] * n.size[2] + q.size[2] * n.size[1], q.size[2] * n.size[2]};
  bool positive = true, negative = true;
  for (int i = 0; i < 5; ++i) {
    // For larger sizes underflows are far below the bounds.
    if (size[i] < kTiny) return Side::kMixed;
    positive &= c[i] > kEndsInsideBound * size[i];
    negative &= c[i] < -kEndsInsideBound * size[i];
  }
  return positive ? Side::kPositive : negative ? Side::kNegative : Side::kMixed;
}

/// Whether a plane keeps the features apart over the interval. See areSeparated() in
/// elementary.cpp.
template <typename Pair>
bool areSeparated(const Pair& pair) {
  const PairTable& table = pair.table();
  EndsSegment corner[4];
  Vec middle[4];
  for (int i = 0; i < table.num_corners; ++i) {
    EndsSegment& at = corner[i] = pair.difference(table.corner[i].difference);
    at.l = table.corner[i].sign * at.l;
    at.h = table.corner[i].sign * at.h;
    middle[i] = 0.5 * (at.l + at.h);
  }
  const Vec d = separatingDirection(middle, table.isTriangle());
  const double bound = kSideBound * maxNorm(d);
  if (!(bound > kTiny)) return false;
  for (int i = 0; i < table.num_corners; ++i)
    if (!(dot(d, corner[i].l) > bound * corner[i].l_norm &&
          dot(d, corner[i].h) > bound * corner[i].h_norm))
      return false;
  return true;
}

/// A part [a, b] of the interval that is to be examined next, 0 <= a <= b <= 1. If a = b,
/// a place at which to cut the interval.
struct Place {
  double a, b;
  bool isUseful() const { return a > 0 || b < 1; }
};

/// A little more than the rounding of a place in the interval.
constexpr double kLeastPart = 0x1p-48;

/// The place where u, v and w together are shortest, if they nearly vanish there.
template <typename Pair>
std::optional<Place> meetingPlace(const Pair& pair) {
  // At both ends of the place the vectors are about this many times as long as where they
  // are shortest. The points nearly meet if the place is a small part of the interval.
  constexpr double kFar = 8;
  const EndsSegment &u = pair.u(), &v = pair.v(), &w = pair.w();
  const auto [s, duration] = ClosestApproach({u.l, v.l, w.l}, {u.h, v.h, w.h});
  if (!(s > 0 && s < 1)) return std::nullopt;
  const double half = std::max(kLeastPart, kFar * duration);
  if (half > 1 / kFar) return std::nullopt;
  return Place{std::max(0., s - half), std::min(1., s + half)};
}

/// The length of u, v and w at the beginning divided by that at the end.
template <typename Pair>
double ratioOfEnds(const Pair& pair) {
  double l = 0, h = 0;
  for (const EndsSegment* x : {&pair.u(), &pair.v(), &pair.w()}) {
    l = std::max(l, x->l_norm);
    h = std::max(h, x->h_norm);
  }
  return l > 0 && h > 0 ? l / h : 1;
}

/// A part around a root or an extremum of f that seems to have certain signs on both
/// sides.
Place placeOfRoot(const EndsVolume& f) {
  // The part is made wider by this factor, so that signs of derivatives are certain as
  // well.
  constexpr double kWider = 8, kMostPart = 0x1p-7;
  double s = 0.5;
  if (f.sign(0) == 0)
    s = 0;
  else if (f.sign(3) == 0)
    s = 1;
  else if (f.changesSign())
    s = illinois(f, 0, 1, f.b[0], f.b[3], 0x1p-50, 60);
  else
    f.findTurn(s);
  if (s > 0 && s < 1 && f.seemsKnownAt(s)) return {s, s};
  for (double half = kLeastPart; half < kMostPart; half *= 8)
    if ((s <= half || f.seemsKnownAt(s - half)) &&
        (s >= 1 - half || f.seemsKnownAt(s + half)))
      return {std::max(0., s - kWider * half), std::min(1., s + kWider * half)};
  return {0, 1};
}

template <typename Pair>
Place placeToLook(const Pair& pair, const EndsVolume& f) {
  if (const std::optional<Place> place = meetingPlace(pair)) return *place;
  if (f.isLost()) return {0, 1};
  // As a function of x with s / (1 - s) = ratio x / (1 - x), the volume has the same
  // scale near both ends.
  const double ratio = ratioOfEnds(pair);
  const auto back = [ratio](double x) { return ratio * x / (1 - x + ratio * x); };
  const Place place = placeOfRoot(f.withRatio(ratio));
  assert(0 <= place.a && place.a <= place.b && place.b <= 1);
  return {back(place.a), back(place.b)};
}

/// About eight looks are usual.
using Intervals = IntervalStack<Interval, 48>;

/// Cuts an interval at both ends of the place.
/// @return false if times have too few bits for this
bool cut(const Interval& i, const Place& place, unsigned time_bits, Intervals& open) {
  constexpr unsigned kCutBits = 52;
  DoubleWord width = i.hi - i.lo;
  unsigned bits = 0;
  while (bits < kCutBits && (width >> (kCutBits - bits)) == 0) ++bits;
  bits = std::min(bits, time_bits - i.m);
  width <<= bits;
  const DoubleWord lo = i.lo << bits, hi = i.hi << bits;
  const auto size = static_cast<double>(width);
  if (width < 2) return false;
  DoubleWord a = lo + static_cast<DoubleWord>(place.a * size), b = hi;
  if (place.b < 1) b = std::min(hi, lo + static_cast<DoubleWord>(place.b * size) + 1);
  if (place.a == place.b) a = b = std::min(hi - 1, std::max(lo + 1, a));
  if (a == lo && b == hi) return false;
  assert(lo <= a && a <= hi && lo <= b && b <= hi);
  const unsigned m = i.m + bits;
  if (b < hi) open.push({b, hi, m});
  if (a < b) open.push({a, b, m});
  if (lo < a) open.push({lo, a, m});
  return true;
}

/// The only root of p, simple, between lo / 2^m and hi / 2^m.
Root rootBetween(const ExactPolynomial& p, DoubleWord lo, DoubleWord hi, unsigned m) {
  const int sign_lo = p.signAt(lo, m);
  assert(sign_lo != 0 && p.signAt(hi, m) == -sign_lo);
  for (;;) {
    const DoubleWord width = hi - lo;
    unsigned bits = 0;
    while (width >> bits > 1) ++bits;
    const DoubleWord unit = DoubleWord{1} << bits;
    if (width == unit && (lo & (unit - 1)) == 0) return Root(lo >> bits, m - bits, p);
    const DoubleWord cut = ((lo >> bits) + 1) << bits;
    const int sign = p.signAt(cut, m);
    if (sign == 0) return Root(cut, m);
    (sign == sign_lo ? lo : hi) = cut;
  }
}

/// What is known about contacts in an interval.
enum class Finding { kNoContact, kContact, kOpen };

template <std::size_t kWords>
class Solver {
 public:
  Solver(ExactQuery& query, double toc_err)
      : query_(query),
        toc_err_(toc_err),
        pair_(query.kind(), query.points(), query.digits()) {}

  /// The first contact in (0, t_end].
  ElementaryResult solve(double t_end);

 private:
  Finding look(const Interval& interval, const EndsCross& n, const EndsVolume& f);
  Finding lookAtEnds(const Interval& interval, const EndsVolume& f);
  Finding lookAtRoot(const Interval& interval);
  Finding contactIn(const Interval& interval);

  int clockExponent() const { return query_.digits().clock_exponent; }

  ExactQuery& query_;
  double toc_err_;
  MagnifiedPair<kWords> pair_;
  ElementaryResult contact_{};
};

/// The decision by doubles.
template <std::size_t kWords>
Finding Solver<kWords>::look(const Interval& interval, const EndsCross& n,
                             const EndsVolume& f) {
  if (f.hasNoRoot()) return Finding::kNoContact;
  const Side side = insideness(pair_.table(), [&](int i) {
    const auto& [x, y] = pair_.table().inside[i];
    return sideOver(EndsCross(pair_.difference(x), pair_.difference(y)), n);
  });
  if (side == Side::kNegative) return Finding::kNoContact;
  if (side == Side::kPositive && f.changesSign()) return contactIn(interval);
  return areSeparated(pair_) ? Finding::kNoContact : Finding::kOpen;
}

/// Records a contact that is somewhere in the interval, if the interval is short enough.
template <std::size_t kWords>
Finding Solver<kWords>::contactIn(const Interval& interval) {
  const double lo = timeOf(interval.lo, interval.m, clockExponent(), -1),
               hi = timeOf(interval.hi, interval.m, clockExponent(), 1);
  constexpr double kUlps = 4 * std::numeric_limits<double>::epsilon();
  assert(0 <= lo && lo <= hi && hi <= 1);
  if (hi - lo > std::max(toc_err_, kUlps * lo)) return Finding::kOpen;
  contact_ = {Answer::kYes, lo, hi, DecidedBy::kExact};
  return Finding::kContact;
}

/// Decides features that are coplanar at t = 0 or t = 1, and at no other time of the
/// interval.
template <std::size_t kWords>
Finding Solver<kWords>::lookAtEnds(const Interval& interval, const EndsVolume& f) {
  const bool zero_at_lo = f.sign(0) == 0 && interval.lo == 0,
             zero_at_hi = f.sign(3) == 0 && interval.hi == DoubleWord{1} << interval.m;
  if (!zero_at_lo && !zero_at_hi) return Finding::kOpen;
  if (!f.hasNoRootBetween(zero_at_lo, zero_at_hi)) return Finding::kOpen;
  if (zero_at_lo && !query_.isCoplanarInFrame(0)) return Finding::kOpen;
  if (!zero_at_hi) return Finding::kNoContact;
  if (!query_.isCoplanarInFrame(1)) return Finding::kOpen;
  contact_ = {Answer::kYes, 1, 1, DecidedBy::kExact};
  return query_.touchInFrame(1) ? Finding::kContact : Finding::kNoContact;
}

/// Decides a single root at which a weight of the contact is zero or nearly zero.
template <std::size_t kWords>
Finding Solver<kWords>::lookAtRoot(const Interval& interval) {
  const ExactPair& pair = query_.pair();
  Root root = rootBetween(pair.volume(), interval.lo, interval.hi, interval.m);
  if (!pair.touchAt(root)) return Finding::kNoContact;
  const auto [lo, hi] = root.bracket(toc_err_, clockExponent());
  contact_ = {Answer::kYes, lo, hi, DecidedBy::kExact};
  return Finding::kContact;
}

template <std::size_t kWords>
ElementaryResult Solver<kWords>::solve(double t_end) {
  const ElementaryResult unsure = {Answer::kUnsure, 0, t_end, DecidedBy::kExact};
  assert(0 < t_end && t_end <= 1);
  const BinaryDigits end(t_end);
  const auto end_bits = static_cast<unsigned>(-end.exponent);
  if (!pair_.fits() || end_bits > pair_.timeBits()) return unsure;
  Intervals open;
  open.push({0, static_cast<DoubleWord>(end.digits), end_bits});
  [[maybe_unused]] Interval last{0, 0, 0};
  for (int looks = 0; !open.isEmpty(); ++looks) {
    const Interval interval = open.pop();
    // What was before is decided.
    assert(isContinued(last, interval));
    last = interval;
    if (looks == Intervals::kMaxLooks) return unsure;
    pair_.moveTo(interval);
    const EndsCross n(pair_.v(), pair_.w());
    const EndsVolume f(pair_.u(), n);
    Finding found = look(interval, n, f);
    if (found == Finding::kOpen) found = lookAtEnds(interval, f);
    if (found == Finding::kOpen) {
      const Place place = placeToLook(pair_, f);
      if (place.isUseful() && cut(interval, place, pair_.timeBits(), open)) continue;
      if (!f.changesSign() || !f.isMonotone()) return unsure;
      found = lookAtRoot(interval);
    }
    if (found == Finding::kContact) {
      contact_.toc_hi = std::min(contact_.toc_hi, t_end);
      assert(contact_.toc_lo <= contact_.toc_hi);
      return contact_;
    }
  }
  return {Answer::kNo, 0, 0, DecidedBy::kExact};
}

}  // namespace

ElementaryResult solveMagnified(ExactQuery& query, double toc_err, double t_stop,
                                double t_max) {
  assert(toc_err > 0 && 0 < t_max && t_max <= 1 && !query.touchInFrame(0));
  const int clock_exponent = query.digits().clock_exponent;
  // In units of another clock t_max is a fraction, which intervals cannot represent.
  if (t_max < 1 && clock_exponent != 0)
    return {Answer::kUnsure, 0, t_max, DecidedBy::kExact};
  Solver<4> solver(query, toc_err);
  // The bracket of a contact must not depend on t_stop.
  const ElementaryResult no = {Answer::kNo, 0, 0, DecidedBy::kExact};
  const bool stops = t_stop < t_max && clock_exponent == 0;
  if (stops && (t_stop == 0 || solver.solve(t_stop).answer == Answer::kNo)) return no;
  return solver.solve(t_max);
}

bool isWorthMagnifying(ContinuousContactKind kind, const FeaturePoints& x) {
  constexpr double kSmall = 0x1p-10, kLeastVolume = 0x1p-590, kMostVolume = 0x1p590;
  Vec l[3], h[3];
  double volume = 1, l_norm = 0, h_norm = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto [to, from] = pairTable(kind).difference[i];
    const auto &a = x[to], &b = x[from];
    l[i] = {a.t0[0] - b.t0[0], a.t0[1] - b.t0[1], a.t0[2] - b.t0[2]};
    h[i] = {a.t1[0] - b.t1[0], a.t1[1] - b.t1[1], a.t1[2] - b.t1[2]};
    volume *= std::max(maxNorm(l[i]), maxNorm(h[i]));
    l_norm = std::max(l_norm, maxNorm(l[i]));
    h_norm = std::max(h_norm, maxNorm(h[i]));
  }
  if (!(volume > kLeastVolume && volume < kMostVolume)) return true;
  if (l_norm < kSmall * h_norm || h_norm < kSmall * l_norm) return true;
  const ClosestApproach closest(l, h);
  return closest.s > 0 && closest.s < 1 && closest.duration < kSmall;
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
