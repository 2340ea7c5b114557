// SPDX-License-Identifier: BSD-3-Clause
//
// The last stage of the elementary test: the definition itself, evaluated with integers.
// Coordinates are doubles, hence integers times a common power of two; everything below
// is a polynomial in t with integer coefficients, and times of contact are its roots.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "exact_polynomial.h"
#include "fcl/narrowphase/detail/deformable/elementary_test.h"
#include "fcl/narrowphase/detail/deformable/instant_test.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

using MovingPoint = std::array<Polynomial, 3>;

MovingPoint operator-(const MovingPoint& a, const MovingPoint& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

MovingPoint cross(const MovingPoint& a, const MovingPoint& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
          a[0] * b[1] - a[1] * b[0]};
}

Polynomial dot(const MovingPoint& a, const MovingPoint& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// The four paths times 2^-exponent, for the largest exponent that makes them integers
/// without loss (all coordinates share it, so that no contact is lost or moved).
std::array<MovingPoint, 4> toIntegers(const FeaturePoints& x) {
  int lowest = std::numeric_limits<int>::max();
  const auto forEach = [&x](auto&& visit) {
    for (int i = 0; i < 4; ++i)
      for (int k = 0; k < 3; ++k) visit(i, k, x[i].t0[k], x[i].t1[k]);
  };
  const auto exponentOf = [](double value) {
    int exponent = 0;
    std::frexp(value, &exponent);
    return exponent;
  };
  forEach([&](int, int, double a, double b) {
    if (a != 0) lowest = std::min(lowest, exponentOf(a));
    if (b != 0) lowest = std::min(lowest, exponentOf(b));
  });
  const auto toInteger = [&](double value) -> Integer {
    if (value == 0) return 0;
    int exponent = 0;
    const double fraction = std::frexp(value, &exponent);
    const Integer digits = static_cast<std::int64_t>(std::ldexp(fraction, 53));
    return digits << static_cast<unsigned>(exponent - lowest);
  };
  std::array<MovingPoint, 4> points;
  forEach([&](int i, int k, double a, double b) {
    const Integer from = toInteger(a);
    points[static_cast<std::size_t>(i)][static_cast<std::size_t>(k)] =
        Polynomial{from, toInteger(b) - from};
  });
  return points;
}

/// Point p and segment qr: they touch when (p-q) x (r-q) = 0 and (p-q).(p-r) <= 0.
struct PointOnSegment {
  Polynomial off_line;  // square of the cross product
  Polynomial outside;

  PointOnSegment(const MovingPoint& p, const MovingPoint& q, const MovingPoint& r) {
    const MovingPoint n = cross(p - q, r - q);
    off_line = dot(n, n);
    outside = dot(p - q, p - r);
  }
  bool holdsAt(Root& t) const {
    return t.signOf(outside) <= 0 && t.signOf(off_line) == 0;
  }
};

/// The conditions of a contact, see insideness() in elementary_test.cpp for the formulas.
/// Each polynomial is made when it is first asked for: most pairs need few.
class ExactPair {
 public:
  ExactPair(FeatureKind kind, const FeaturePoints& x)
      : kind_(kind), p_(toIntegers(x)), inside_(isVertexFace() ? 3 : 4) {
    const auto& [a, b, c, d] = p_;
    u_ = isVertexFace() ? a - b : c - a;
    v_ = isVertexFace() ? c - b : b - a;
    w_ = isVertexFace() ? d - b : d - c;
    n_ = cross(v_, w_);
    volume_ = dot(u_, n_);
  }

  /// Whether the features touch at t.
  bool touchAt(Root& t) {
    if (t.signOf(volume_) != 0) return false;
    // At a root of the volume one negative condition settles it.
    bool is_outside = false;
    for (std::size_t i = 0; i < inside_.size() && !is_outside; ++i)
      is_outside = t.signOf(inside(i)) < 0;
    if (is_outside) return false;
    if (t.signOf(area()) != 0) return true;
    // No normal at t: a triangle without area is the union of its edges; two parallel
    // edges touch in an end of one of them.
    for (const PointOnSegment& c : degenerate())
      if (c.holdsAt(t)) return true;
    return false;
  }

  /// Times one of which is the first contact after 0, if there is any: those at which a
  /// condition begins to hold.
  std::vector<Root> candidates() {
    std::vector<Root> times;
    const auto addRootsOf = [&times](const Polynomial& p) {
      if (p.degree() < 1) return;
      for (Root& root : rootsInUnitInterval(p)) times.push_back(std::move(root));
    };
    if (!volume_.isZero()) {
      addRootsOf(volume_);
    } else {
      addRootsOf(area());
      if (area().isZero()) {
        for (const PointOnSegment& c : degenerate()) {
          addRootsOf(c.off_line);
          addRootsOf(c.outside);
        }
      } else {
        for (std::size_t i = 0; i < inside_.size(); ++i) addRootsOf(inside(i));
      }
    }
    return times;
  }

 private:
  bool isVertexFace() const { return kind_ == FeatureKind::kVertexFace; }

  const Polynomial& area() {
    if (!area_) area_ = dot(n_, n_);
    return *area_;
  }

  const Polynomial& inside(std::size_t i) {
    if (inside_[i]) return *inside_[i];
    const auto& [a, b, c, d] = p_;
    MovingPoint x;
    if (isVertexFace())
      x = i == 0 ? cross(u_, w_) : i == 1 ? cross(v_, u_) : cross(c - a, d - a);
    else
      x = i == 0   ? cross(u_, w_)
          : i == 1 ? cross(b - c, w_)
          : i == 2 ? cross(u_, v_)
                   : cross(v_, d - a);
    inside_[i] = dot(x, n_);
    return *inside_[i];
  }

  const std::vector<PointOnSegment>& degenerate() {
    if (!degenerate_.empty()) return degenerate_;
    const auto& [a, b, c, d] = p_;
    if (isVertexFace())
      degenerate_ = {{a, b, c}, {a, c, d}, {a, d, b}};
    else
      degenerate_ = {{a, c, d}, {b, c, d}, {c, a, b}, {d, a, b}};
    return degenerate_;
  }

  FeatureKind kind_;
  std::array<MovingPoint, 4> p_;
  MovingPoint u_, v_, w_, n_;
  Polynomial volume_;
  std::optional<Polynomial> area_;
  std::vector<std::optional<Polynomial>> inside_;
  std::vector<PointOnSegment> degenerate_;
};

}  // namespace

ElementaryResult decideExactly(FeatureKind kind, const FeaturePoints& x, double toc_err) {
  const bool touch_at_start = kind == FeatureKind::kVertexFace
                                  ? isOnTriangle(x[0].t0, x[1].t0, x[2].t0, x[3].t0)
                                  : doSegmentsTouch(x[0].t0, x[1].t0, x[2].t0, x[3].t0);
  if (touch_at_start) return {Answer::kYes, 0, 0, DecidedBy::kExact};
  ExactPair pair(kind, x);
  std::vector<Root> times = pair.candidates();
  std::sort(times.begin(), times.end(),
            [](const Root& a, const Root& b) { return a.lowerBound() < b.lowerBound(); });
  bool touch = false;
  double lo = 1, hi = 1;
  for (Root& t : times) {
    if (touch && t.lowerBound() > hi) break;
    if (!pair.touchAt(t)) continue;
    const auto [t_lo, t_hi] = t.bracket(toc_err);
    lo = touch ? std::min(lo, t_lo) : t_lo;
    hi = touch ? std::min(hi, t_hi) : t_hi;
    touch = true;
  }
  if (!touch) return {Answer::kNo, 0, 0, DecidedBy::kExact};
  return {Answer::kYes, lo, hi, DecidedBy::kExact};
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
