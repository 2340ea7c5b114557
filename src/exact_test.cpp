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

#include "exact_polynomial.h"
#include "fcl/narrowphase/detail/deformable/elementary_test.h"

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
        Polynomial({from, toInteger(b) - from});
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
class ExactPair {
 public:
  ExactPair(FeatureKind kind, const FeaturePoints& x) {
    const auto [a, b, c, d] = toIntegers(x);
    if (kind == FeatureKind::kVertexFace) {
      const MovingPoint u = a - b, v = c - b, w = d - b;
      const MovingPoint n = cross(v, w);
      volume_ = dot(u, n);
      area_ = dot(n, n);
      inside_ = {dot(cross(u, w), n), dot(cross(v, u), n), dot(cross(c - a, d - a), n)};
      degenerate_ = {{a, b, c}, {a, c, d}, {a, d, b}};
    } else {
      const MovingPoint u = c - a, v = b - a, w = d - c;
      const MovingPoint n = cross(v, w);
      volume_ = dot(u, n);
      area_ = dot(n, n);
      inside_ = {dot(cross(u, w), n), dot(cross(b - c, w), n), dot(cross(u, v), n),
                 dot(cross(v, d - a), n)};
      degenerate_ = {{a, c, d}, {b, c, d}, {c, a, b}, {d, a, b}};
    }
  }

  /// Whether the features touch at t.
  bool touchAt(Root& t) const {
    if (t.signOf(volume_) != 0) return false;
    if (t.signOf(area_) != 0)
      return std::all_of(inside_.begin(), inside_.end(),
                         [&](const Polynomial& g) { return t.signOf(g) >= 0; });
    // No normal at t: a triangle without area is the union of its edges; two parallel
    // edges touch in an end of one of them.
    return std::any_of(degenerate_.begin(), degenerate_.end(),
                       [&](const PointOnSegment& c) { return c.holdsAt(t); });
  }

  /// Times one of which is the first contact, if there is any: 0, or a time at which a
  /// condition begins to hold.
  std::vector<Root> candidates() const {
    std::vector<Root> times{Root()};
    const auto addRootsOf = [&times](const Polynomial& p) {
      if (p.degree() < 1) return;
      for (Root& root : rootsInUnitInterval(p)) times.push_back(std::move(root));
    };
    if (!volume_.isZero()) {
      addRootsOf(volume_);
      return times;
    }
    addRootsOf(area_);
    if (!area_.isZero()) {
      for (const Polynomial& g : inside_) addRootsOf(g);
      return times;
    }
    for (const PointOnSegment& c : degenerate_) {
      addRootsOf(c.off_line);
      addRootsOf(c.outside);
    }
    return times;
  }

 private:
  Polynomial volume_;
  Polynomial area_;
  std::vector<Polynomial> inside_;
  std::vector<PointOnSegment> degenerate_;
};

}  // namespace

ElementaryResult decideExactly(FeatureKind kind, const FeaturePoints& x, double toc_err) {
  const ExactPair pair(kind, x);
  Root start;
  if (pair.touchAt(start)) return {Answer::kYes, 0, 0, DecidedBy::kExact};
  bool touch = false;
  double lo = 1, hi = 1;
  for (Root& t : pair.candidates()) {
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
