// SPDX-License-Identifier: BSD-3-Clause
#include "elementary/accurate_pair.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "numerics/error_bounds.h"
#include "numerics/illinois.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

/// More than the sum of all underflows in one of the numbers below.
constexpr double kUnderflow = 0x1p-1060;

/// In this range underflows are far below error bounds relative to the size.
bool isInAccurateRange(double size) { return size > 0x1p-600 && size < 0x1p600; }

using Vector = AccurateVector;

Vec rounded(const Vector& a) { return {a[0].hi, a[1].hi, a[2].hi}; }

// One step of a blossom. It is rounded three times (weight, products, sum), relative to p
// and q.
double mean(double t, double p, double q) { return (1 - t) * p + t * q; }
Vec mean(double t, const Vec& p, const Vec& q) { return (1 - t) * p + t * q; }

/// Two steps of a blossom are 6 units, and the rounding of the coefficients is one more.
MovingCross restrict(const MovingCross& f, double lo, double hi) {
  assert(0 <= lo && lo <= hi && hi <= 1 && !(f.error < 0));
  const Vec mid = 0.5 * f.c1;
  const Vec lo_0 = mean(lo, f.c0, mid), lo_1 = mean(lo, mid, f.c2);
  return {{mean(lo, lo_0, lo_1), 2 * mean(hi, lo_0, lo_1),
           mean(hi, mean(hi, f.c0, mid), mean(hi, mid, f.c2))},
          f.size,
          f.error + 8 * kUnit * f.size};
}

}  // namespace

AccurateDifference::AccurateDifference(const VertexPath& p, const VertexPath& q) {
  for (int k = 0; k < 3; ++k) {
    t0[k] = DoubleDouble::difference(p.t0[k], q.t0[k]);
    t1[k] = DoubleDouble::difference(p.t1[k], q.t1[k]);
    norm = std::max(norm, std::max(std::abs(t0[k].hi), std::abs(t1[k].hi)));
    is_double &= t0[k].lo == 0 && t1[k].lo == 0;
  }
}

void AccurateDifference::at(const DoubleDouble& t, Vector& out) const {
  const DoubleDouble rest = DoubleDouble{1, 0} - t;
  for (int k = 0; k < 3; ++k) out[k] = rest * t0[k] + t * t1[k];
}

/// A cross product before and after it is rounded to doubles. The error is that before
/// the rounding.
struct AccuratePair::Cross {
  Vector c0, c1, c2;
  MovingCross rounded;

  Cross(const AccurateDifference& a, const AccurateDifference& b) {
    Vector other;
    cross(a.t0, b.t0, c0);
    cross(a.t0, b.t1, c1);
    cross(a.t1, b.t0, other);
    cross(a.t1, b.t1, c2);
    double largest = 0;
    for (const Vector* c : {&c0, &c1, &other, &c2})
      largest = std::max(largest, maxNorm(deformable::rounded(*c)));
    for (int k = 0; k < 3; ++k) c1[k] = c1[k] + other[k];
    MovingCross& r = rounded;
    r.c0 = deformable::rounded(c0);
    r.c1 = deformable::rounded(c1);
    r.c2 = deformable::rounded(c2);
    r.size = std::max(std::max(maxNorm(r.c0), 0.5 * maxNorm(r.c1)), maxNorm(r.c2));
    // A component has two products of size AB. (c1 has four, and counts by its half.)
    // Products of plain doubles are exact. So if two vectors are parallel except for
    // rounding and their products cancel, all digits of the rest are right. Then there
    // are sums, of size `largest` or, in half of c1, twice that.
    const double norm = a.norm * b.norm;
    const double product_error =
        a.is_double && b.is_double ? 0 : 2 * kProductBound * norm;
    r.error = isInAccurateRange(norm)
                  ? product_error + 3 * kSumBound * largest + kUnderflow
                  : std::numeric_limits<double>::infinity();
  }
};

// N is the size of n, E its error. A coefficient of the volume is u0.n0 or u1.n0 + u0.n1,
// where n1 counts twice. It has the errors of n, 9 UE; products, 9 UN; sums of 2, 3, 4, 6
// and 9 UN: (9 * 2 + 24) 2^-104 UN < 2^-98 UN.
AccuratePair::AccuratePair(ContinuousContactKind kind, const FeaturePoints& x)
    : table_(pairTable(kind)), x_(x) {
  u_ = difference(kU);
  v_ = difference(kV);
  w_ = difference(kW);
  const Cross n(v_, w_);
  normal_ = n.rounded;
  volume_[0] = dot(u_.t0, n.c0);
  volume_[1] = dot(u_.t1, n.c0) + dot(u_.t0, n.c1);
  volume_[2] = dot(u_.t1, n.c1) + dot(u_.t0, n.c2);
  volume_[3] = dot(u_.t1, n.c2);
  for (const DoubleDouble& c : volume_)
    volume_size_ = std::max(volume_size_, std::abs(c.hi));
  volume_error_ = isInAccurateRange(u_.norm * (v_.norm * w_.norm))
                      ? 9.5 * u_.norm * normal_.error +
                            0x1p-97 * (u_.norm * normal_.size) + kUnderflow
                      : std::numeric_limits<double>::infinity();
}

AccurateDifference AccuratePair::difference(PairDifference i) const {
  const auto [to, from] = table_.difference[i];
  return {x_[to], x_[from]};
}

AccuratePair::Factors AccuratePair::factors(int i) const {
  const auto& [x, y] = table_.inside[i];
  return {difference(x), difference(y)};
}

bool AccuratePair::volume(double lo, double hi, double (&b)[4], double& error) const {
  const double v[4] = {volume_[0].hi, volume_[1].hi / 3, volume_[2].hi / 3,
                       volume_[3].hi};
  assert(!(volume_error_ < 0));
  // Three steps of a blossom are 9 units. The rounding of the coefficients is two more,
  // and later factors of 3 are another two.
  error = volume_error_ + 16 * kUnit * volume_size_;
  const auto blossom = [&](double r, double s, double t) {
    const double c[3] = {mean(r, v[0], v[1]), mean(r, v[1], v[2]), mean(r, v[2], v[3])};
    return mean(t, mean(s, c[0], c[1]), mean(s, c[1], c[2]));
  };
  b[0] = blossom(lo, lo, lo);
  b[1] = blossom(lo, lo, hi);
  b[2] = blossom(lo, hi, hi);
  b[3] = blossom(hi, hi, hi);
  return std::isfinite(error) && (volume_size_ == 0 || volume_size_ > kTiny);
}

bool AccuratePair::hasNoRoot(double lo, double hi) const {
  double b[4] = {volume_[0].hi, volume_[1].hi, volume_[2].hi, volume_[3].hi};
  double error = volume_error_;
  if ((lo > 0 || hi < 1) && !volume(lo, hi, b, error)) return false;
  return (b[0] > error && b[1] > error && b[2] > error && b[3] > error) ||
         (b[0] < -error && b[1] < -error && b[2] < -error && b[3] < -error);
}

MovingCross AccuratePair::normal(double lo, double hi) const {
  return restrict(normal_, lo, hi);
}

MovingCross AccuratePair::side(int i, double lo, double hi) {
  assert(i >= 0 && i < table_.num_inside);
  std::optional<MovingCross>& side = side_[i];
  if (!side) {
    const auto [x, y] = factors(i);
    side = Cross(x, y).rounded;
  }
  return restrict(*side, lo, hi);
}

DoubleDouble AccuratePair::volumeAt(const DoubleDouble& t) const {
  const DoubleDouble r = DoubleDouble{1, 0} - t, t2 = t * t;
  return ((volume_[0] * r + volume_[1] * t) * r + volume_[2] * t2) * r +
         volume_[3] * (t2 * t);
}

AccuratePair::RootContact AccuratePair::contactAtRoot(double lo, double hi) const {
  const RootContact unsure = {Answer::kUnsure, lo, hi};
  double b[4], error;
  if (!volume(lo, hi, b, error)) return unsure;
  if (!((b[0] > error && b[3] < -error) || (b[0] < -error && b[3] > error)))
    return unsure;
  // The Bernstein coefficients of the volume's derivative are three times the differences
  // of the coefficients. If all differences have one sign, there is one root, and they
  // bound the slope. Half a unit of error covers the rounding of a difference.
  const double sign = b[3] > b[0] ? 1 : -1, width = hi - lo;
  const double least = std::min(std::min(sign * (b[1] - b[0]), sign * (b[2] - b[1])),
                                sign * (b[3] - b[2])) -
                       2.5 * error;
  const double slope = 2.5 * (least / width);
  if (!(least > 0 && slope < kHuge)) return unsure;

  const double s = illinois(
      [&b](double x) {
        const double y = 1 - x;
        return y * y * (b[0] * y + 3 * b[1] * x) + x * x * (3 * b[2] * y + b[3] * x);
      },
      0, 1, b[0], b[3], 0x1p-30, 24);
  const double r = 1 - s;
  const double tangent =
      3 / width *
      (r * r * (b[1] - b[0]) + 2 * r * s * (b[2] - b[1]) + s * s * (b[3] - b[2]));
  // Each step of Newton's method doubles the 30 bits.
  DoubleDouble t = {lo + s * width, 0}, value = volumeAt(t);
  for (int step = 0; step < 2; ++step) {
    t = t - DoubleDouble{value.hi / tangent, 0};
    value = volumeAt(t);
  }
  if (!(t.hi > lo && t.hi < hi)) return unsure;
  // The weights of the four terms sum up to less than 1. Each term is rounded at most 12
  // times by 2^-103 of its size.
  const double value_error = volume_error_ + 0x1p-97 * volume_size_;
  const double t_error = (std::abs(value.hi) + value_error) / slope;
  // One unit for t.lo, and one for the rounding of the bracket.
  const double margin =
      2 * t_error + 4 * kUnit * t.hi + std::numeric_limits<double>::min();
  const double from = std::max(lo, t.hi - margin), to = std::min(hi, t.hi + margin);
  // The root is between them.
  assert(sign * volumeAt({from, 0}).hi <= value_error);
  assert(sign * volumeAt({to, 0}).hi >= -value_error);
  return {touchAt(t, t_error), from, to};
}

Answer AccuratePair::touchAt(const DoubleDouble& t, double t_error) const {
  // The error of a difference at t: weight, product and sum, together less than 4
  // products' errors. The difference also moves by less than 2 norms in the step. A
  // component of a cross product has four factors with such errors, their squares, and 3
  // products' errors of its own. An underflow in a difference is multiplied by the other
  // factor.
  assert(t_error >= 0);
  const double difference_error = 4 * kProductBound + 2 * t_error;
  if (!(difference_error < 0x1p-10)) return Answer::kUnsure;
  const auto crossError = [difference_error](double a_norm, double b_norm) {
    return 5 * difference_error * (a_norm * b_norm) + kUnderflow * (1 + a_norm + b_norm);
  };
  Vector a, b, c;
  v_.at(t, a);
  w_.at(t, b);
  cross(a, b, c);
  const Vec n = rounded(c);
  const double n_size = maxNorm(n), n_error = crossError(v_.norm, w_.norm);
  Answer answer = Answer::kYes;
  for (int i = 0; i < table_.num_inside; ++i) {
    const auto [x, y] = factors(i);
    x.at(t, a);
    y.at(t, b);
    cross(a, b, c);
    const Vec q = rounded(c);
    const double q_size = maxNorm(q), q_error = crossError(x.norm, y.norm);
    // Three products of factors with errors. Three units for the rounding of each factor
    // and of the product, and sums of size 2 and 3: 14 units.
    const double bound = 3 * (q_size * n_error + q_error * (n_size + n_error)) +
                         16 * kUnit * (q_size * n_size) + kUnderflow;
    const double value = deformable::dot(q, n);
    if (value < -bound) return Answer::kNo;
    if (!(value > bound)) answer = Answer::kUnsure;
  }
  return answer;
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
