// SPDX-License-Identifier: BSD-3-Clause
#include "elementary/in_plane.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "elementary/pair_table.h"
#include "numerics/error_bounds.h"
#include "numerics/illinois.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

/// The difference of two points, projected along the axis, at t = 0 and t = 1.
struct PlanarDifference {
  double x[2], y[2];

  PlanarDifference(const VertexPath& p, const VertexPath& q, int axis) {
    const int i = (axis + 1) % 3, j = (axis + 2) % 3;
    x[0] = p.t0[i] - q.t0[i];
    x[1] = p.t1[i] - q.t1[i];
    y[0] = p.t0[j] - q.t0[j];
    y[1] = p.t1[j] - q.t1[j];
  }
};

/// A number and a bound on its error.
struct Bounded {
  double value;
  double error;
};

/// A quadratic in t: a product of two differences, as Bernstein coefficients. Error
/// bounds are relative to the products that make a coefficient. So a coefficient with a
/// zero factor in each product is known to be zero.
class PlanarQuadratic {
 public:
  static PlanarQuadratic cross(const PlanarDifference& a, const PlanarDifference& b) {
    PlanarQuadratic q;
    for (const auto& [k, i, j] : kTerms) {
      q.add(k, a.x[i] * b.y[j], a.x[i] != 0 && b.y[j] != 0);
      q.add(k, -a.y[i] * b.x[j], a.y[i] != 0 && b.x[j] != 0);
    }
    q.finish();
    return q;
  }
  static PlanarQuadratic dot(const PlanarDifference& a, const PlanarDifference& b) {
    PlanarQuadratic q;
    for (const auto& [k, i, j] : kTerms) {
      q.add(k, a.x[i] * b.x[j], a.x[i] != 0 && b.x[j] != 0);
      q.add(k, a.y[i] * b.y[j], a.y[i] != 0 && b.y[j] != 0);
    }
    q.finish();
    return q;
  }

  double at(double t) const { return blossom(t, t).value; }

  /// Signs over [lo, hi]. The Bernstein coefficients are the blossom's values at (lo,
  /// lo), (lo, hi), (hi, hi).
  bool isNegative(double lo, double hi) const {
    return forEachCoefficient(lo, hi, [](Bounded b) { return b.value < -b.error; });
  }
  bool isPositive(double lo, double hi) const {
    return forEachCoefficient(lo, hi, [](Bounded b) { return b.value > b.error; });
  }
  bool isNotNegative(double lo, double hi) const {
    return forEachCoefficient(lo, hi, [](Bounded b) { return b.value >= b.error; });
  }
  bool isZero() const {
    return is_reliable_ && size_[0] == 0 && size_[1] == 0 && size_[2] == 0;
  }
  bool changesSign(double lo, double hi) const {
    const Bounded a = blossom(lo, lo), b = blossom(hi, hi);
    return is_reliable_ && ((a.value < -a.error && b.value > b.error) ||
                            (a.value > a.error && b.value < -b.error));
  }

 private:
  /// The frames i and j whose product is a term of coefficient k.
  struct Term {
    int k, i, j;
  };
  static constexpr Term kTerms[4] = {{0, 0, 0}, {1, 0, 1}, {1, 1, 0}, {2, 1, 1}};

  template <typename Test>
  bool forEachCoefficient(double lo, double hi, Test&& test) const {
    return is_reliable_ && test(blossom(lo, lo)) && test(blossom(hi, hi)) &&
           test(blossom(lo, hi));
  }

  /// The terms of a coefficient are rounded three times (two differences, a product),
  /// their sum at most three times: 6 units of 2^-53 of their size. The weights are
  /// rounded up to four times, the products with them and the sum three times more: 13
  /// units. 16 units leave room for the rounding of the size and of the bound itself.
  /// Underflows of weights and terms are below the smallest normal number times the size.
  Bounded blossom(double s, double t) const {
    assert(0 <= s && s <= 1 && 0 <= t && t <= 1);
    const double w0 = (1 - s) * (1 - t), w1 = (1 - s) * t + s * (1 - t), w2 = s * t;
    return {w0 * c_[0] + w1 * c_[1] + w2 * c_[2],
            16 * kUnit * (w0 * size_[0] + w1 * size_[1] + w2 * size_[2]) + underflow_};
  }

  /// Adds a product. The result is reliable if no product that is not zero can underflow,
  /// and none is near an overflow.
  void add(int k, double product, bool is_not_zero) {
    c_[k] += product;
    size_[k] += std::abs(product);
    is_reliable_ &= std::abs(product) < kHuge;
    is_reliable_ &= !is_not_zero || std::abs(product) > kTiny;
  }
  void finish() {
    c_[1] *= 0.5;
    size_[1] *= 0.5;
    if (!isZero())
      underflow_ =
          std::numeric_limits<double>::min() * (1 + size_[0] + size_[1] + size_[2]);
  }

  double c_[3]{0, 0, 0};
  double size_[3]{0, 0, 0};
  double underflow_{0};
  bool is_reliable_{true};
};

constexpr PlanarQuadratic::Term PlanarQuadratic::kTerms[4];

/// What is known about the first contact: it is not earlier than lo. If there is a proof
/// of a contact, it is not later than hi.
struct FirstContact {
  double lo{2};
  double hi{2};

  bool hasContact() const { return hi <= 1; }
  void addUnsure(double from) { lo = std::min(lo, from); }
  void addContact(double from, double to) {
    assert(from <= to);
    lo = std::min(lo, from);
    hi = std::min(hi, to);
    assert(lo <= hi);
  }
};

/// Point p and segment qr, in the plane.
class PointAndSegment {
 public:
  /// @param qp, qr, rp, rq  from the first point to the second
  /// @param area  the cross product of qp and qr
  PointAndSegment(const PlanarDifference& qp, const PlanarDifference& qr,
                  const PlanarDifference& rp, const PlanarDifference& rq,
                  const PlanarQuadratic& area)
      : area_(area),
        from_q_(PlanarQuadratic::dot(qp, qr)),
        from_r_(PlanarQuadratic::dot(rp, rq)),
        length_(PlanarQuadratic::dot(qr, qr)),
        on_line_(area.isZero()) {}

  bool isApart(double a, double b) const {
    return area_.isPositive(a, b) || area_.isNegative(a, b) || from_q_.isNegative(a, b) ||
           from_r_.isNegative(a, b);
  }
  /// Whether they touch in [a, b]: either p changes sides between the segment's ends, or
  /// it comes along the line from beyond one of them.
  bool touchIn(double a, double b) const {
    if (on_line_) a = b;  // touching at b is enough
    return (on_line_ || area_.changesSign(a, b)) && length_.isPositive(a, b) &&
           from_q_.isNotNegative(a, b) && from_r_.isNotNegative(a, b);
  }
  /// Estimates where one of the signs changes.
  /// @return whether one does
  bool findChange(double lo, double hi, double tol, double& t) const {
    for (const PlanarQuadratic* f : {&area_, &from_q_, &from_r_})
      if (f->changesSign(lo, hi)) {
        t = illinois([f](double s) { return f->at(s); }, lo, hi, f->at(lo), f->at(hi),
                     tol, 24);
        return true;
      }
    return false;
  }

 private:
  PlanarQuadratic area_, from_q_, from_r_, length_;
  bool on_line_;
};

/// Finds times in [lo, hi] at which the point meets the segment.
void findContact(const PointAndSegment& pair, double lo, double hi, double toc_err,
                 FirstContact& found) {
  // The ends of the intervals that are still to be examined, the earliest on top.
  constexpr int kMaxLooks = 32;
  double end[2 * kMaxLooks + 1];
  int open = 0;
  assert(lo <= hi && toc_err > 0);
  end[open++] = hi;
  const auto goOn = [&] { lo = end[--open]; };
  for (int look = 0; open > 0; ++look) {
    hi = end[open - 1];
    assert(lo <= hi);
    const double width = hi - lo;
    if (pair.isApart(lo, hi)) {
      goOn();
      continue;
    }
    if (width <= toc_err && pair.touchIn(lo, hi)) return found.addContact(lo, hi);
    if (width <= 0.25 * toc_err || look >= kMaxLooks) {
      found.addUnsure(lo);
      goOn();
      continue;
    }
    // A wide interval is cut close around a change of sign, or in the middle.
    double cut[2] = {lo + 0.5 * width, hi}, change;
    if (width > toc_err && pair.findChange(lo, hi, 0.0625 * toc_err, change)) {
      cut[0] = change - 0.125 * toc_err;
      cut[1] = change + 0.125 * toc_err;
    }
    for (const double t : {cut[1], cut[0]})
      if (t > lo && t < end[open - 1]) {
        assert(open < 2 * kMaxLooks + 1);
        end[open++] = t;
      }
    if (end[open - 1] == hi) {
      found.addUnsure(lo);
      goOn();
    }
  }
}

/// Finds times in [lo, hi] at which point p meets segment qr.
void findPointOnSegment(const VertexPath& p, const VertexPath& q, const VertexPath& r,
                        int axis, double lo, double hi, double toc_err,
                        FirstContact& found) {
  const PlanarDifference qp(p, q, axis), qr(r, q, axis);
  const PlanarQuadratic area = PlanarQuadratic::cross(qp, qr);
  // As a rule they are apart all the time, which the area alone shows.
  if (area.isPositive(lo, hi) || area.isNegative(lo, hi)) return;
  const PlanarDifference rp(p, r, axis), rq(q, r, axis);
  findContact(PointAndSegment(qp, qr, rp, rq, area), lo, hi, toc_err, found);
}

/// Whether a line of x, y, x + y or x - y = constant keeps the features apart at t.
bool areApartAt(double t, bool vf, const FeaturePoints& x, int axis) {
  assert(0 <= t && t <= 1);
  bool all_positive[4] = {true, true, true, true};
  bool all_negative[4] = {true, true, true, true};
  for (int i = 0; i < (vf ? 1 : 2); ++i)
    for (int j = vf ? 1 : 2; j < 4; ++j) {
      const PlanarDifference d(x[i], x[j], axis);
      const double s = 1 - t, a = s * d.x[0] + t * d.x[1], b = s * d.y[0] + t * d.y[1];
      // Four roundings of each term, and one more of the sums. Underflows are below the
      // smallest normal number.
      const double error = 8 * kUnit *
                               (s * (std::abs(d.x[0]) + std::abs(d.y[0])) +
                                t * (std::abs(d.x[1]) + std::abs(d.y[1]))) +
                           std::numeric_limits<double>::min();
      const double along[4] = {a, b, a + b, a - b};
      for (int k = 0; k < 4; ++k) {
        all_positive[k] &= along[k] > error;
        all_negative[k] &= along[k] < -error;
      }
    }
  for (int k = 0; k < 4; ++k)
    if (all_positive[k] || all_negative[k]) return true;
  return false;
}

}  // namespace

int axisOfCommonPlane(const FeaturePoints& x) {
  for (int k = 0; k < 3; ++k) {
    bool same = true;
    for (int i = 1; i < 4; ++i)
      same &= x[i].t0[k] == x[0].t0[k] && x[i].t1[k] == x[0].t1[k];
    if (same) return k;
  }
  return -1;
}

ElementaryResult solveInPlane(ContinuousContactKind kind, const FeaturePoints& x,
                              int axis, double window_lo, double window_hi,
                              double toc_err) {
  assert(axis >= 0 && axis < 3 && axisOfCommonPlane(x) >= 0);
  assert(0 <= window_lo && window_lo <= window_hi && window_hi <= 1 && toc_err > 0);
  const PairTable& table = pairTable(kind);
  const bool vf = kind == ContinuousContactKind::kVertexFace;
  if (window_lo > 0 && !areApartAt(window_lo, vf, x, axis))
    return {Answer::kUnsure, window_lo, window_hi, DecidedBy::kSolver};
  FirstContact found;
  for (int i = 0; i < table.num_inside; ++i) {
    const auto [p, q, r] = table.meeting[i];
    findPointOnSegment(x[p], x[q], x[r], axis, window_lo, std::min(window_hi, found.hi),
                       toc_err, found);
  }
  assert(window_lo <= found.lo && (!found.hasContact() || found.hi <= window_hi));
  if (found.hasContact() && found.hi - found.lo <= toc_err)
    return {Answer::kYes, found.lo, found.hi, DecidedBy::kSolver};
  if (found.lo <= 1) return {Answer::kUnsure, found.lo, window_hi, DecidedBy::kSolver};
  return {Answer::kNo, 0, 0, DecidedBy::kSolver};
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
