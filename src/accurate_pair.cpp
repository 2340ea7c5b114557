// SPDX-License-Identifier: BSD-3-Clause
#include "accurate_cubic.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace fcl {
namespace detail {
namespace deformable {
namespace {

/// A number as the unevaluated sum of two doubles (Dekker 1971). Products and sums have
/// an error of at most 2^-102 of the result, sums of terms of different sign of at most
/// 2^-102 of the larger term.
struct Double2 {
  double hi, lo;

  /// s + rest for |s| >= |rest|.
  static Double2 normalized(double s, double rest) {
    const double hi = s + rest;
    return {hi, rest - (hi - s)};
  }
  static Double2 difference(double p, double q) {  // exact, Knuth's TwoSum
    const double d = p - q;
    const double q_virtual = p - d, p_virtual = d + q_virtual;
    return {d, (p - p_virtual) + (q_virtual - q)};
  }
};

Double2 operator*(const Double2& a, const Double2& b) {
  const double p = a.hi * b.hi;
  return Double2::normalized(p, std::fma(a.hi, b.hi, -p) + (a.hi * b.lo + a.lo * b.hi));
}

Double2 operator+(const Double2& a, const Double2& b) {
  const double s = a.hi + b.hi;
  const double b_virtual = s - a.hi, a_virtual = s - b_virtual;
  const double rest = (a.hi - a_virtual) + (b.hi - b_virtual);
  return Double2::normalized(s, rest + (a.lo + b.lo));
}

Double2 operator-(const Double2& a, const Double2& b) {
  return a + Double2{-b.hi, -b.lo};
}

using Vector = Double2[3];

struct Difference {
  Vector t0, t1;
  double norm{0};

  Difference(const VertexPath& p, const VertexPath& q) {
    for (int k = 0; k < 3; ++k) {
      t0[k] = Double2::difference(p.t0[k], q.t0[k]);
      t1[k] = Double2::difference(p.t1[k], q.t1[k]);
      norm = std::max(norm, std::max(std::abs(t0[k].hi), std::abs(t1[k].hi)));
    }
  }
};

void addCross(const Vector& a, const Vector& b, Vector& n) {
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    n[k] = n[k] + (a[i] * b[j] - a[j] * b[i]);
  }
}

Double2 dot(const Vector& a, const Vector& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

}  // namespace

// A coefficient of f = u . (v x w) is made of 6 (outer) or 18 (inner) products of three
// differences of size UVW at most, each within 2^-101 of it; at most 7 sums on top of
// each other have terms of at most 18 UVW. 18 * 2^-101 + 7 * 18 * 2^-102 < 2^-94, and
// what underflows is far below 2^-94 UVW in the range below.
AccurateCubic::AccurateCubic(FeatureKind kind, const FeaturePoints& x) {
  const bool vf = kind == FeatureKind::kVertexFace;
  const Difference u(x[vf ? 0 : 2], x[vf ? 1 : 0]), v(x[vf ? 2 : 1], x[vf ? 1 : 0]),
      w(x[3], x[vf ? 1 : 2]);
  const double normal_size = v.norm * w.norm, size = u.norm * normal_size;
  const auto isInRange = [](double value) { return value > 0x1p-600 && value < 0x1p600; };
  error_ = isInRange(size) && isInRange(normal_size)
               ? 0x1p-94 * size
               : std::numeric_limits<double>::infinity();

  Vector n0{}, n1{}, n2{};
  addCross(v.t0, w.t0, n0);
  addCross(v.t0, w.t1, n1);
  addCross(v.t1, w.t0, n1);
  addCross(v.t1, w.t1, n2);
  b_[0] = dot(u.t0, n0).hi;
  b_[1] = (dot(u.t1, n0) + dot(u.t0, n1)).hi / 3;
  b_[2] = (dot(u.t1, n1) + dot(u.t0, n2)).hi / 3;
  b_[3] = dot(u.t1, n2).hi;
}

bool AccurateCubic::restrict(double lo, double hi, double (&b)[4], double& error) const {
  double size = 0;
  for (const double c : b_) size = std::max(size, std::abs(c));
  // The blossom, whose steps are weighted means of what they start from: rounded four
  // times each (weight, products, sum), after two roundings of b_.
  error = error_ + 16 * 0x1p-53 * size;
  const auto mean = [](double t, double p, double q) { return (1 - t) * p + t * q; };
  const auto blossom = [&](double r, double s, double t) {
    const double c[3] = {mean(r, b_[0], b_[1]), mean(r, b_[1], b_[2]),
                         mean(r, b_[2], b_[3])};
    return mean(t, mean(s, c[0], c[1]), mean(s, c[1], c[2]));
  };
  b[0] = blossom(lo, lo, lo);
  b[1] = blossom(lo, lo, hi);
  b[2] = blossom(lo, hi, hi);
  b[3] = blossom(hi, hi, hi);
  return std::isfinite(error) && (size == 0 || size > 0x1p-900);
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
