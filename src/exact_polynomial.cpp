// SPDX-License-Identifier: BSD-3-Clause
#include "exact_polynomial.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace fcl {
namespace detail {
namespace deformable {
namespace {

/// Remainder of a by b, times a positive constant.
Polynomial pseudoRemainder(const Polynomial& a, const Polynomial& b) {
  Polynomial rest = a;
  const int sign = b[b.degree()] < 0 ? -1 : 1;
  while (!rest.isZero() && rest.degree() >= b.degree()) {
    const int shift = rest.degree() - b.degree();
    std::vector<Integer> factor(static_cast<std::size_t>(shift) + 1);
    factor.back() = sign * rest[rest.degree()];
    const Integer lead = sign * b[b.degree()];
    rest = rest * Polynomial({lead}) - b * Polynomial(std::move(factor));
  }
  return rest;
}

/// k / 2^m rounded to a double below (direction -1) or above (1), or equal.
double toDouble(const Integer& k, unsigned m, int direction) {
  if (k == 0) return 0;
  const auto bits = static_cast<unsigned>(boost::multiprecision::msb(k)) + 1;
  const unsigned drop = bits > 53 ? bits - 53 : 0;
  Integer head = k >> drop;
  if ((head << drop) != k && direction > 0) ++head;
  const double value =
      std::ldexp(head.convert_to<double>(), static_cast<int>(drop) - static_cast<int>(m));
  // A subnormal has fewer bits, to which ldexp() rounds either way.
  if (value >= std::numeric_limits<double>::min()) return value;
  return direction < 0 ? std::nextafter(value, 0.) : std::nextafter(value, 1.);
}

/// p divided by (2^m t - k), a root of it.
Polynomial withoutRoot(const Polynomial& p, const Integer& k, unsigned m) {
  return p.quotient(Polynomial({-k, Integer(1) << m})).primitive();
}

}  // namespace

Polynomial::Polynomial(std::vector<Integer> coefficients) : c_(std::move(coefficients)) {
  while (!c_.empty() && c_.back() == 0) c_.pop_back();
}

Polynomial Polynomial::operator+(const Polynomial& other) const {
  std::vector<Integer> sum(std::max(c_.size(), other.c_.size()));
  for (std::size_t i = 0; i < c_.size(); ++i) sum[i] += c_[i];
  for (std::size_t i = 0; i < other.c_.size(); ++i) sum[i] += other.c_[i];
  return Polynomial(std::move(sum));
}

Polynomial Polynomial::operator-(const Polynomial& other) const {
  std::vector<Integer> difference(std::max(c_.size(), other.c_.size()));
  for (std::size_t i = 0; i < c_.size(); ++i) difference[i] += c_[i];
  for (std::size_t i = 0; i < other.c_.size(); ++i) difference[i] -= other.c_[i];
  return Polynomial(std::move(difference));
}

Polynomial Polynomial::operator*(const Polynomial& other) const {
  if (isZero() || other.isZero()) return {};
  std::vector<Integer> product(c_.size() + other.c_.size() - 1);
  for (std::size_t i = 0; i < c_.size(); ++i)
    for (std::size_t j = 0; j < other.c_.size(); ++j)
      product[i + j] += c_[i] * other.c_[j];
  return Polynomial(std::move(product));
}

Polynomial Polynomial::derivative() const {
  std::vector<Integer> d;
  for (std::size_t i = 1; i < c_.size(); ++i) d.push_back(c_[i] * i);
  return Polynomial(std::move(d));
}

Polynomial Polynomial::primitive() const {
  Integer content = 0;
  for (const Integer& c : c_) content = boost::multiprecision::gcd(content, c);
  if (content <= 1) return *this;
  Polynomial p = *this;
  for (Integer& c : p.c_) c /= content;
  return p;
}

Polynomial Polynomial::quotient(const Polynomial& divisor) const {
  Polynomial rest = *this;
  const Integer& lead = divisor[divisor.degree()];
  std::vector<Integer> q(static_cast<std::size_t>(degree() - divisor.degree()) + 1);
  while (!rest.isZero() && rest.degree() >= divisor.degree()) {
    const int shift = rest.degree() - divisor.degree();
    std::vector<Integer> factor(static_cast<std::size_t>(shift) + 1);
    factor.back() = rest[rest.degree()];
    for (Integer& c : q) c *= lead;
    q[static_cast<std::size_t>(shift)] += factor.back();
    rest = rest * Polynomial({lead}) - divisor * Polynomial(std::move(factor));
  }
  return Polynomial(std::move(q));
}

int Polynomial::signAt(const Integer& k, unsigned m) const {
  if (isZero()) return 0;
  // 2^(m degree) p(k / 2^m) by Horner's rule.
  Integer value = c_.back();
  for (int i = degree() - 1; i >= 0; --i)
    value = value * k + ((*this)[i] << (m * static_cast<unsigned>(degree() - i)));
  return value.sign();
}

int Polynomial::signChanges(const Integer& k, unsigned m) const {
  const std::size_t n = c_.size();
  if (n == 0) return 0;
  // q(s) = 2^(m degree) p((k + s) / 2^m) by repeated synthetic division.
  std::vector<Integer> q(n);
  for (std::size_t i = 0; i < n; ++i)
    q[i] = c_[i] << (m * static_cast<unsigned>(n - 1 - i));
  if (k != 0)
    for (std::size_t i = 0; i + 1 < n; ++i)
      for (std::size_t j = n - 1; j-- > i;) q[j] += q[j + 1] * k;
  // Bernstein coefficients times binomials: those of (1 + x)^degree q(1 / (1 + x)),
  // reversed; the sign changes are the same.
  std::reverse(q.begin(), q.end());
  for (std::size_t i = 0; i + 1 < n; ++i)
    for (std::size_t j = n - 1; j-- > i;) q[j] += q[j + 1];
  int changes = 0, last = 0;
  for (const Integer& b : q) {
    const int sign = b.sign();
    if (sign == 0) continue;
    if (last != 0 && sign != last) ++changes;
    last = sign;
  }
  return changes;
}

Polynomial gcd(Polynomial a, Polynomial b) {
  while (!b.isZero()) {
    Polynomial rest = pseudoRemainder(a, b).primitive();
    a = std::move(b);
    b = std::move(rest);
  }
  return a.primitive();
}

std::vector<Root> rootsInUnitInterval(const Polynomial& polynomial) {
  Polynomial p = polynomial.primitive();
  const Polynomial repeated = p.degree() > 1 ? gcd(p, p.derivative()) : Polynomial();
  if (repeated.degree() > 0) p = p.quotient(repeated).primitive();

  std::vector<Root> roots;
  // Roots found on the way at dyadic points are divided out, so that ends of intervals
  // are never roots; the search then starts again.
  const auto takeDyadic = [&](const Integer& k, unsigned m) {
    if (p.degree() < 1 || p.signAt(k, m) != 0) return false;
    roots.emplace_back(k, m, true, Polynomial());
    p = withoutRoot(p, k, m);
    return true;
  };
  takeDyadic(0, 0);
  takeDyadic(1, 0);
  for (bool again = true; again;) {
    again = false;
    std::vector<std::pair<Integer, unsigned>> open{{0, 0}};
    std::vector<Root> isolated;
    while (!open.empty() && !again) {
      const auto [k, m] = open.back();
      open.pop_back();
      const int changes = p.signChanges(k, m);
      if (changes == 1) isolated.emplace_back(k, m, false, p);
      if (changes <= 1) continue;
      const Integer mid = 2 * k + 1;
      again = takeDyadic(mid, m + 1);
      open.emplace_back(mid, m + 1);
      open.emplace_back(mid - 1, m + 1);
    }
    if (!again) roots.insert(roots.end(), isolated.begin(), isolated.end());
  }
  return roots;
}

void Root::halve() {
  const Integer mid = 2 * k_ + 1;
  const int at_mid = polynomial_.signAt(mid, m_ + 1);
  if (at_mid == 0) {
    k_ = mid;
    is_dyadic_ = true;
  } else {
    k_ = at_mid == polynomial_.signAt(k_, m_) ? mid : Integer(mid - 1);
  }
  ++m_;
}

int Root::signOf(const Polynomial& g) {
  if (g.isZero()) return 0;
  if (g.degree() == 0) return g[0].sign();
  if (!is_dyadic_) {
    if (g.signChanges(k_, m_) > 0) {
      // A common root in the interval is this root: the only one of the square-free
      // polynomial there, at which the divisor changes sign.
      const Polynomial common = gcd(polynomial_, g);
      if (common.degree() > 0 && common.signAt(k_, m_) != common.signAt(k_ + 1, m_))
        return 0;
    }
    while (!is_dyadic_ && g.signChanges(k_, m_) > 0) halve();
  }
  if (is_dyadic_) return g.signAt(k_, m_);
  // No root of g inside; the sign is that of any inner point.
  return g.signAt(2 * k_ + 1, m_ + 1);
}

std::pair<double, double> Root::bracket(double width) {
  // With more bits than a double has, an interval closer than doubles would not show. A
  // root below 2^-1074 has none.
  const auto hasBitsOfDouble = [this] {
    return k_ != 0 && boost::multiprecision::msb(k_) > 54;
  };
  while (!is_dyadic_ && m_ < 1100 && !hasBitsOfDouble() &&
         std::ldexp(1., -static_cast<int>(m_)) > width)
    halve();
  return {toDouble(k_, m_, -1), toDouble(is_dyadic_ ? k_ : Integer(k_ + 1), m_, 1)};
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
