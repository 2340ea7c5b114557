// SPDX-License-Identifier: BSD-3-Clause
#include "numerics/exact_polynomial.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <limits>

#include "numerics/illinois.h"
#include "numerics/integer_coordinates.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

/// Whether a double >= 0 is not above k / 2^m (direction -1), or not below it (1).
[[maybe_unused]] bool isBound(double value, const Integer& k, unsigned m, int direction) {
  const BinaryDigits x(value);
  // Both times 2^shift.
  const unsigned below = x.exponent < 0 ? static_cast<unsigned>(-x.exponent) : 0,
                 shift = std::max(below, m);
  const Integer scaled = Integer(x.digits)
                         << static_cast<unsigned>(static_cast<int>(shift) + x.exponent),
                exact = k << (shift - m);
  return direction < 0 ? scaled <= exact : scaled >= exact;
}

/// k / 2^m rounded to a double below (direction -1) or above (1), or equal.
double toDouble(const Integer& k, unsigned m, int direction) {
  assert(k >= 0 && (direction == 1 || direction == -1));
  if (k.is_zero()) return 0;
  const auto bits = static_cast<unsigned>(boost::multiprecision::msb(k)) + 1;
  const unsigned drop = bits > 53 ? bits - 53 : 0;
  Integer head = k >> drop;
  if (direction > 0 && (head << drop) != k) ++head;
  const double value = std::ldexp(static_cast<double>(head.convert_to<std::int64_t>()),
                                  static_cast<int>(drop) - static_cast<int>(m));
  // A subnormal has fewer bits, to which ldexp() rounds either way, up to the smallest
  // normal number.
  const double bound = value > std::numeric_limits<double>::min()
                           ? value
                           : std::nextafter(value, direction < 0 ? 0. : 1.);
  assert(isBound(bound, k, m, direction));
  return bound;
}

/// a / b <= 1, rounded in the same way.
double ratioToDouble(const Integer& a, const Integer& b, int direction) {
  assert(a >= 0 && b > 0 && a <= b);
  if (a.is_zero()) return 0;
  const auto bits = static_cast<unsigned>(msb(b) - msb(a)) + 64;
  Integer quotient, rest;
  divide_qr(Integer(a << bits), b, quotient, rest);
  if (direction > 0 && !rest.is_zero()) ++quotient;
  return toDouble(quotient, bits, direction);
}

/// p divided by (2^m t - k), a root of it.
ExactPolynomial withoutRoot(const ExactPolynomial& p, const Integer& k, unsigned m) {
  assert(p.signAt(k, m) == 0);
  return p.quotient(ExactPolynomial{-k, Integer(1) << m}).primitive();
}

}  // namespace

ExactPolynomial& ExactPolynomial::operator+=(const ExactPolynomial& other) {
  if (c_.size() < other.c_.size()) c_.resize(other.c_.size());
  for (std::size_t i = 0; i < other.c_.size(); ++i) c_[i] += other.c_[i];
  trim();
  return *this;
}

ExactPolynomial& ExactPolynomial::operator-=(const ExactPolynomial& other) {
  if (c_.size() < other.c_.size()) c_.resize(other.c_.size());
  for (std::size_t i = 0; i < other.c_.size(); ++i) c_[i] -= other.c_[i];
  trim();
  return *this;
}

ExactPolynomial operator*(const ExactPolynomial& a, const ExactPolynomial& b) {
  ExactPolynomial product;
  if (a.isZero() || b.isZero()) return product;
  assert(a.degree() + b.degree() <= ExactPolynomial::kMaxDegree);
  product.c_.resize(a.c_.size() + b.c_.size() - 1);
  for (std::size_t i = 0; i < a.c_.size(); ++i)
    for (std::size_t j = 0; j < b.c_.size(); ++j) product.c_[i + j] += a.c_[i] * b.c_[j];
  assert(!product.c_.back().is_zero());
  return product;
}

ExactPolynomial ExactPolynomial::derivative() const {
  ExactPolynomial d;
  for (std::size_t i = 1; i < c_.size(); ++i) d.c_.push_back(c_[i] * i);
  assert(d.degree() == std::max(degree() - 1, -1));
  return d;
}

ExactPolynomial ExactPolynomial::primitive() const {
  Integer content = 0;
  for (const Integer& c : c_) content = boost::multiprecision::gcd(content, c);
  if (content <= 1) return *this;
  ExactPolynomial p = *this;
  for (Integer& c : p.c_) c /= content;
  return p;
}

/// Remainder of a by b, times a constant.
ExactPolynomial remainder(const ExactPolynomial& a, const ExactPolynomial& b) {
  assert(!b.isZero());
  ExactPolynomial rest = a;
  const std::size_t n = b.c_.size();
  while (rest.c_.size() >= n) {
    const Integer top = rest.c_.back();
    const std::size_t shift = rest.c_.size() - n;
    for (std::size_t i = 0; i < rest.c_.size(); ++i) {
      rest.c_[i] *= b.c_.back();
      if (i >= shift) rest.c_[i] -= top * b.c_[i - shift];
    }
    assert(rest.c_.back().is_zero());
    rest.trim();
  }
  return rest;
}

ExactPolynomial ExactPolynomial::quotient(const ExactPolynomial& divisor) const {
  assert(!divisor.isZero() && degree() >= divisor.degree());
  ExactPolynomial rest = *this, q;
  const std::size_t n = divisor.c_.size();
  const Integer& lead = divisor.c_.back();
  q.c_.resize(c_.size() - n + 1);
  while (rest.c_.size() >= n) {
    const Integer top = rest.c_.back();
    const std::size_t shift = rest.c_.size() - n;
    for (Integer& c : q.c_) c *= lead;
    q.c_[shift] += top;
    for (std::size_t i = 0; i < rest.c_.size(); ++i) {
      rest.c_[i] *= lead;
      if (i >= shift) rest.c_[i] -= top * divisor.c_[i - shift];
    }
    assert(rest.c_.back().is_zero());
    rest.trim();
  }
  assert(rest.isZero());
  return q;
}

int ExactPolynomial::signAt(const Integer& k, unsigned m) const {
  return valueAt(k, m).sign();
}

Integer ExactPolynomial::valueAt(const Integer& k, unsigned m) const {
  if (isZero()) return 0;
  Integer value = c_.back();  // Horner's rule
  for (int i = degree() - 1; i >= 0; --i) {
    value *= k;
    value += (*this)[i] << (m * static_cast<unsigned>(degree() - i));
  }
  return value;
}

int ExactPolynomial::signAtFraction(const Integer& numerator,
                                    const Integer& denominator) const {
  assert(denominator > 0);
  if (isZero()) return 0;
  Integer value = c_.back(), power = 1;
  for (int i = degree() - 1; i >= 0; --i) {
    power *= denominator;
    value = value * numerator + (*this)[i] * power;
  }
  return value.sign();
}

ExactPolynomial::Coefficients ExactPolynomial::bernstein(const Integer& k,
                                                         unsigned m) const {
  assert(!isZero());
  const std::size_t n = c_.size();
  // q(s) = 2^(m degree) p((k + s) / 2^m) by repeated synthetic division.
  Coefficients q = c_;
  for (std::size_t i = 0; i < n; ++i) q[i] <<= m * static_cast<unsigned>(n - 1 - i);
  if (!k.is_zero())
    for (std::size_t i = 0; i + 1 < n; ++i)
      for (std::size_t j = n - 1; j-- > i;) q[j] += q[j + 1] * k;
  // The coefficients of (1 + x)^degree q(1 / (1 + x)), in reverse order.
  std::reverse(q.begin(), q.end());
  for (std::size_t i = 0; i + 1 < n; ++i)
    for (std::size_t j = n - 1; j-- > i;) q[j] += q[j + 1];
  std::reverse(q.begin(), q.end());
  assert(q.front() == valueAt(k, m) && q.back() == valueAt(k + 1, m));
  return q;
}

int ExactPolynomial::signChanges(const Integer& k, unsigned m) const {
  int changes = 0, last = 0;
  for (const Integer& b : bernstein(k, m)) {
    const int sign = b.sign();
    if (sign == 0) continue;
    if (last != 0 && sign != last) ++changes;
    last = sign;
  }
  return changes;
}

ExactPolynomial gcd(ExactPolynomial a, ExactPolynomial b) {
  while (!b.isZero()) {
    ExactPolynomial rest = remainder(a, b);
    a = std::move(b);
    b = std::move(rest);
  }
  assert(!a.isZero());
  return a.degree() > 0 ? a.primitive() : a;
}

/// An estimate of the root in (k, k + 1) / 2^m, from 0 to 1, of a polynomial with
/// different signs at the ends.
static double estimateRoot(const ExactPolynomial& p, const Integer& k, unsigned m) {
  const ExactPolynomial::Coefficients exact = p.bernstein(k, m);
  std::size_t bits = 0;
  for (const Integer& b : exact)
    if (!b.is_zero()) bits = std::max<std::size_t>(bits, msb(abs(b)));
  const std::size_t drop = bits > 60 ? bits - 60 : 0;
  double b[ExactPolynomial::kMaxDegree + 1];
  const std::size_t n = exact.size();
  for (std::size_t i = 0; i < n; ++i) {
    const Integer head = abs(exact[i]) >> drop;
    b[i] = static_cast<double>(head.convert_to<std::int64_t>()) * exact[i].sign();
  }
  const auto value = [&b, n](double s) {
    double sum = 0, power = 1;
    for (std::size_t j = 0; j < n; ++j) {
      sum = sum * (1 - s) + b[j] * power;
      power *= s;
    }
    return sum;
  };
  return illinois(value, 0, 1, b[0], b[n - 1], 0, 60);
}

namespace {

/// The search for the roots of a polynomial in [0, 1], by Descartes' rule of signs.
class RootSearch {
 public:
  explicit RootSearch(const ExactPolynomial& polynomial)
      : p_(polynomial), is_square_free_(polynomial.degree() <= 1) {}

  std::vector<Root> run() {
    takeDyadic(0, 0);
    takeDyadic(1, 0);
    while (!isolateAll()) continue;
    assert(roots_.size() <= std::size_t{ExactPolynomial::kMaxDegree});
    return std::move(roots_);
  }

 private:
  /// The interval (k, k + 1) / 2^m, and how it was reached.
  struct Interval {
    Integer k;
    unsigned m;
    int changes;
    int cuts;
    unsigned jump;
  };

  /// Divides out a root at a dyadic point, so that ends of intervals are never roots.
  /// @return whether there is one; then the search starts again
  bool takeDyadic(const Integer& k, unsigned m) {
    bool taken = false;
    while (p_.degree() >= 1 && p_.signAt(k, m) == 0) {
      if (!taken) roots_.emplace_back(k, m);
      p_ = withoutRoot(p_, k, m);
      taken = true;
    }
    return taken;
  }

  /// Finds an interval for each root.
  /// @return false if the polynomial was divided before all were found
  bool isolateAll() {
    // A root of higher multiplicity keeps two sign changes at every depth.
    constexpr int kMaxCuts = 12;
    open_.clear();
    open_.push_back({0, 0, p_.signChanges(0, 0), 0, 1});
    std::vector<Root> isolated;
    while (!open_.empty()) {
      const Interval i = std::move(open_.back());
      open_.pop_back();
      if (i.changes == 1) isolated.emplace_back(i.k, i.m, p_);
      if (i.changes <= 1) continue;
      if (i.jump > 1 && jump(i)) continue;
      if (i.cuts >= kMaxCuts && !is_square_free_ && takeRepeated()) return false;
      if (takeDyadic(2 * i.k + 1, i.m + 1)) return false;
      cut(i);
    }
    roots_.insert(roots_.end(), isolated.begin(), isolated.end());
    return true;
  }

  /// Makes roots of higher multiplicity simple.
  /// @return whether there are some
  bool takeRepeated() {
    const ExactPolynomial repeated = gcd(p_, p_.derivative());
    is_square_free_ = true;
    if (repeated.degree() <= 0) return false;
    p_ = p_.quotient(repeated).primitive();
    return true;
  }

  /// Cuts an interval in the middle.
  void cut(const Interval& i) {
    const Integer mid = 2 * i.k + 1;
    for (const Integer& k : {mid, Integer(mid - 1)}) {
      const int changes = p_.signChanges(k, i.m + 1);
      open_.push_back({k, i.m + 1, changes, i.cuts + 1, changes == i.changes ? 8U : 1U});
    }
    // Descartes' rule: a part never has more sign changes than the rest leaves it.
    assert(open_.back().changes + open_[open_.size() - 2].changes <= i.changes);
  }

  /// Roots may lie close together at an end (frames of very different size) or at an
  /// extremum (features that touch up to rounding). If a part of the interval has all its
  /// sign changes, the rest has no root.
  /// @return whether such a part was found; it takes the place of the interval
  bool jump(const Interval& i) {
    constexpr int kCutsOfTurn = 4;
    constexpr unsigned kMaxTurnJump = 48;
    const Integer first = i.k << i.jump, last = ((i.k + 1) << i.jump) - 1;
    if (jumpTo(i, first, 0) || jumpTo(i, last, 0)) return true;
    if (i.jump > kMaxTurnJump) return false;
    const double turn =
        std::ldexp(estimateRoot(p_.derivative(), i.k, i.m), static_cast<int>(i.jump));
    return jumpTo(i, first + static_cast<std::int64_t>(turn), kCutsOfTurn);
  }
  bool jumpTo(const Interval& i, const Integer& k, int cuts) {
    constexpr unsigned kMaxJump = 256;
    if (p_.signChanges(k, i.m + i.jump) != i.changes) return false;
    assert(k >> i.jump == i.k);
    open_.push_back(
        {k, i.m + i.jump, i.changes, i.cuts + cuts, std::min(2 * i.jump, kMaxJump)});
    return true;
  }

  ExactPolynomial p_;
  bool is_square_free_;
  std::vector<Interval> open_;
  std::vector<Root> roots_;
};

}  // namespace

std::vector<Root> rootsInUnitInterval(const ExactPolynomial& polynomial) {
  assert(!polynomial.isZero());
  return RootSearch(polynomial).run();
}

double timeOf(const Integer& k, unsigned m, int clock_exponent, int direction) {
  assert(0 <= k && k <= Integer(1) << m);
  if (clock_exponent == 0) return toDouble(k, m, direction);
  Integer before = (Integer(1) << m) - k, after = k;
  (clock_exponent > 0 ? before : after) <<=
      static_cast<unsigned>(std::abs(clock_exponent));
  return ratioToDouble(after, before + after, direction);
}

bool Root::isBetweenEnds() const {
  return 0 <= k_ && k_ < Integer(1) << m_ && sign_below_ != 0 &&
         polynomial_.signAt(k_, m_) == sign_below_ &&
         polynomial_.signAt(k_ + 1, m_) == -sign_below_;
}

Integer Root::guessInside(unsigned bits) const {
  if (bits <= kEstimateBits)
    return static_cast<std::int64_t>(
        std::ldexp(estimateRoot(polynomial_, k_, m_), static_cast<int>(bits)));
  // False position: in a short interval the polynomial is nearly a line.
  const Integer lo = abs(polynomial_.valueAt(k_, m_)),
                hi = abs(polynomial_.valueAt(k_ + 1, m_));
  return (lo << bits) / (lo + hi);
}

int Root::probe(const Integer& k, unsigned m) {
  assert(m > m_ && k > k_ << (m - m_) && k < (k_ + 1) << (m - m_));
  const int sign = polynomial_.signAt(k, m);
  if (sign == 0) {
    k_ = k;
    m_ = m;
    is_dyadic_ = true;
  }
  return sign;
}

bool Root::narrow(unsigned bits) {
  assert(bits > 0 && !is_dyadic_);
  // The points on both sides of the estimate.
  if (bits > 1) {
    const Integer first = k_ << bits, end = (k_ + 1) << bits;
    const Integer guess = first + guessInside(bits);
    assert(first <= guess && guess <= end);
    const Integer below = guess > first ? guess - 1 : first,
                  above = guess + 2 < end ? guess + 2 : end;
    const unsigned m = m_ + bits;
    int sign = below == first ? sign_below_ : probe(below, m);
    if (is_dyadic_) return true;
    if (sign == sign_below_) {
      for (Integer k = below; k < above; ++k) {
        sign = k + 1 == end ? -sign_below_ : probe(k + 1, m);
        if (is_dyadic_) return true;
        if (sign == sign_below_) continue;
        k_ = k;
        m_ = m;
        assert(isBetweenEnds());
        return true;
      }
    }
  }
  const Integer mid = 2 * k_ + 1;
  const int sign = probe(mid, m_ + 1);
  if (is_dyadic_) return true;
  k_ = sign == sign_below_ ? mid : mid - 1;
  ++m_;
  assert(isBetweenEnds());
  return bits == 1;
}

int Root::compare(const Integer& numerator, const Integer& denominator) const {
  assert(denominator > 0);
  const Integer scaled = numerator << m_, place = k_ * denominator;
  if (is_dyadic_) return place.compare(scaled);
  if (scaled <= place) return 1;
  if (scaled >= place + denominator) return -1;
  return sign_below_ * polynomial_.signAtFraction(numerator, denominator);
}

/// Sign of a linear polynomial at the root. Its own root is a fraction, and the sign
/// tells on which side of this root the fraction lies.
int Root::signOfLine(const ExactPolynomial& g) const {
  assert(g.degree() == 1 && !is_dyadic_);
  const int slope = g[1].sign();
  return slope * compare(slope > 0 ? -g[0] : g[0], abs(g[1]));
}

int Root::signOf(const ExactPolynomial& g) {
  if (g.degree() <= 0) return g.isZero() ? 0 : g[0].sign();
  if (is_dyadic_) return g.signAt(k_, m_);
  if (g == polynomial_) return 0;
  if (g.degree() == 1) return signOfLine(g);
  if (polynomial_.degree() == 1) {
    const int slope = polynomial_[1].sign();
    return g.signAtFraction(-slope * polynomial_[0], slope * polynomial_[1]);
  }
  // Where g has no root in the interval, its sign is that of any inner point. The number
  // of bits won by a step doubles while steps succeed.
  unsigned bits = kEstimateBits;
  bool common_known = false;
  for (bool first = true; !is_dyadic_ && g.signChanges(k_, m_) > 0; first = false) {
    if (!first && !common_known) {
      // A common root in the interval is this root, since its polynomial has no other
      // there. The divisor changes its sign at it.
      const ExactPolynomial common = gcd(polynomial_, g);
      if (common.degree() > 0 && common.signAt(k_, m_) != common.signAt(k_ + 1, m_))
        return 0;
      common_known = true;
    }
    bits = narrow(bits) ? 2 * bits : kEstimateBits;
  }
  return is_dyadic_ ? g.signAt(k_, m_) : g.signAt(2 * k_ + 1, m_ + 1);
}

double Root::timeBelow(int clock_exponent) const {
  return timeOf(k_, m_, clock_exponent, -1);
}

double Root::lowerBound() const { return toDouble(k_, m_, -1); }

double Root::upperBound() const {
  return toDouble(is_dyadic_ ? k_ : Integer(k_ + 1), m_, 1);
}

/// Whether a bracket in [0, 1] is no wider than that and a few units in the last place.
[[maybe_unused]] static bool isNarrow(const std::pair<double, double>& bracket,
                                      double width) {
  const auto [lo, hi] = bracket;
  return 0 <= lo && lo <= hi && hi <= 1 &&
         hi - lo <= width + 4 * std::numeric_limits<double>::epsilon() * hi +
                        std::numeric_limits<double>::min();
}

std::pair<double, double> Root::bracket(double width, int clock_exponent) {
  // No two doubles are closer, and 1 / width is finite.
  width = std::max(width, std::numeric_limits<double>::min());
  if (clock_exponent != 0) return bracketOnClock(width, clock_exponent);
  // More bits than a double has would not change the doubles around the root. A root
  // below 2^-1074 has no bits of a double.
  const auto hasBitsOfDouble = [this] {
    return !k_.is_zero() && boost::multiprecision::msb(k_) > 54;
  };
  while (!is_dyadic_ && m_ < kMaxBits && !hasBitsOfDouble()) {
    const double excess = std::ldexp(1., -static_cast<int>(m_)) / width;
    if (!(excess > 1)) break;
    narrow(static_cast<unsigned>(std::min<int>(kEstimateBits, std::ilogb(excess) + 1)));
  }
  const std::pair<double, double> around{lowerBound(), upperBound()};
  assert(isNarrow(around, width));
  return around;
}

std::pair<double, double> Root::bracketOnClock(double width, int clock_exponent) {
  const auto shift = static_cast<unsigned>(std::abs(clock_exponent));
  for (;;) {
    const double lo = timeOf(k_, m_, clock_exponent, -1),
                 hi = timeOf(is_dyadic_ ? k_ : Integer(k_ + 1), m_, clock_exponent, 1);
    assert(0 <= lo && lo <= hi && hi <= 1);
    constexpr double kUlps = 4 * std::numeric_limits<double>::epsilon();
    if (is_dyadic_ || hi - lo <= width || hi - lo <= kUlps * lo || m_ > kMaxBits + shift)
      return {lo, hi};
    narrow(kEstimateBits);
  }
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
