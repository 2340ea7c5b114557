// SPDX-License-Identifier: BSD-3-Clause
#include "elementary/following_direction.h"

#include <cassert>
#include <cmath>

#include "numerics/double_double.h"
#include "numerics/error_bounds.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

/// A polynomial of degree 6 or less.
struct Polynomial6 {
  static constexpr int kDegree = 6;
  double c[kDegree + 1]{};

  /// Adds factor times the product of two polynomials.
  template <int kM, int kN>
  void addProduct(double factor, const double (&p)[kM], const double (&q)[kN]) {
    static_assert(kM + kN - 2 <= kDegree, "the degree of the product");
    for (int i = 0; i < kM; ++i)
      for (int j = 0; j < kN; ++j) c[i + j] += factor * (p[i] * q[j]);
  }

  /// Whether all coefficients of Bernstein for [0, h] are positive.
  bool isPositive(double h) const {
    // Binomial coefficients of i over j, divided by those of 6 over j.
    constexpr double kInverse[] = {1, 1 / 6., 1 / 15., 1 / 20., 1 / 15., 1 / 6., 1};
    double scaled[kDegree + 1], power = 1;
    for (int j = 0; j <= kDegree; ++j, power *= h) scaled[j] = c[j] * power * kInverse[j];
    for (int i = 0; i <= kDegree; ++i) {
      double sum = 0, choose = 1;
      for (int j = 0; j <= i; ++j) {
        sum += choose * scaled[j];
        choose = choose * (i - j) / (j + 1);
      }
      if (!(sum > 0)) return false;
    }
    return true;
  }
};

struct AccurateMoving {
  AccurateVector x, change;

  AccurateMoving(const Vec& at, const Vec& velocity) {
    const double p[] = {at.x, at.y, at.z}, v[] = {velocity.x, velocity.y, velocity.z};
    for (int k = 0; k < 3; ++k) {
      x[k] = {p[k], 0};
      change[k] = {v[k], 0};
    }
  }
  /// From one to another one.
  AccurateMoving(const AccurateMoving& from, const AccurateMoving& to) {
    for (int k = 0; k < 3; ++k) {
      x[k] = to.x[k] - from.x[k];
      change[k] = to.change[k] - from.change[k];
    }
  }
};

/// A vector that is a polynomial of degree 3 or less in time.
struct MovingDirection {
  static constexpr int kDegree = 3;
  Vec coefficient[kDegree + 1]{};

  void set(int i, const AccurateVector& v) {
    coefficient[i] = {v[0].hi, v[1].hi, v[2].hi};
  }

  /// Makes its length at the beginning 1, and turns it to the other side if that is
  /// where the corner is.
  /// @return whether it has a length
  bool normalize(const Vec& corner) {
    const double size = maxNorm(coefficient[0]);
    if (!(size > 0 && std::isfinite(size))) return false;
    for (Vec& v : coefficient) v = {v.x / size, v.y / size, v.z / size};
    const double length = std::sqrt(dot(coefficient[0], coefficient[0])),
                 sign = dot(coefficient[0], corner) < 0 ? -1 : 1;
    for (Vec& v : coefficient) v = (sign / length) * v;
    assert(isDirection(coefficient[0]));
    return true;
  }
};

void add(const AccurateVector& v, AccurateVector& sum) {
  for (int k = 0; k < 3; ++k) sum[k] = sum[k] + v[k];
}

/// The coefficients of the cross product of two that move linearly.
void crossMoving(const AccurateMoving& a, const AccurateMoving& b,
                 AccurateVector (&out)[3]) {
  AccurateVector other;
  cross(a.x, b.x, out[0]);
  cross(a.x, b.change, out[1]);
  cross(a.change, b.x, other);
  add(other, out[1]);
  cross(a.change, b.change, out[2]);
}

/// Follows one to three corners.
MovingDirection directionOf(const Vec* corners, const Vec* velocities,
                            const int (&some)[3]) {
  MovingDirection n;
  const auto moving = [&](int i) { return AccurateMoving(corners[i], velocities[i]); };
  const AccurateMoving c = moving(some[0]);
  if (some[1] < 0) {
    n.set(0, c.x);
    n.set(1, c.change);
    return n;
  }
  const AccurateMoving s(c, moving(some[1]));
  AccurateVector product[3];
  if (some[2] >= 0) {
    crossMoving(s, AccurateMoving(c, moving(some[2])), product);
    for (int i = 0; i < 3; ++i) n.set(i, product[i]);
    return n;
  }
  crossMoving(c, s, product);
  for (int i = 0; i <= MovingDirection::kDegree; ++i) {
    AccurateVector sum{}, other;
    if (i < 3) cross(s.x, product[i], sum);
    if (i > 0) {
      cross(s.change, product[i - 1], other);
      add(other, sum);
    }
    n.set(i, sum);
  }
  return n;
}

}  // namespace

double followingStep(const DifferencePolygon& polygon, const Vec* corners,
                     const Vec* velocities, const AccurateNearest& nearest, double size,
                     double least, double longest) {
  assert(longest > 0 && size >= 0);
  assert(nearest.corners[0] >= 0 && nearest.corners[0] < polygon.count());
  constexpr int kDegree = MovingDirection::kDegree;
  constexpr double kRounding = 384 * kUnit;
  MovingDirection n = directionOf(corners, velocities, nearest.corners);
  if (!n.normalize(corners[nearest.corners[0]])) return 0;
  const Vec(&m)[kDegree + 1] = n.coefficient;
  // What all corners have in common: `least` and the rounding.
  Polynomial6 common;
  double lengths[kDegree + 1];
  for (int i = 0; i <= kDegree; ++i) lengths[i] = std::sqrt(dot(m[i], m[i]));
  const double q[2] = {1, dot(m[0], m[1])};
  for (int i = 0; i <= kDegree; ++i)
    for (int j = 0; j <= kDegree; ++j) common.c[i + j] -= least * dot(m[i], m[j]);
  common.addProduct(-least, q, q);
  common.addProduct(-kRounding * size, lengths, lengths);
  Polynomial6 above[DifferencePolygon::kMaxCorners];
  for (int k = 0; k < polygon.count(); ++k) {
    double height[kDegree + 2] = {};
    for (int i = 0; i <= kDegree; ++i) {
      height[i] += dot(m[i], corners[k]);
      height[i + 1] += dot(m[i], velocities[k]);
    }
    above[k] = common;
    above[k].addProduct(2, q, height);
  }
  // Halves are a loss of less than a half; a step that is shorter is of no use.
  constexpr int kMostHalvings = 60;
  double h = longest;
  for (int i = 0; i < kMostHalvings; ++i, h *= 0.5) {
    bool proves = q[0] + q[1] * h > 0;
    for (int k = 0; k < polygon.count() && proves; ++k) proves = above[k].isPositive(h);
    if (proves) return h;
  }
  return 0;
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
