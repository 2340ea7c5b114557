// SPDX-License-Identifier: BSD-3-Clause
//
// Exact polynomials with integer coefficients and their real roots in [0, 1], as far as
// the last stage of the elementary test needs them.
#ifndef FCL_CCD_NUMERICS_EXACT_POLYNOMIAL_H
#define FCL_CCD_NUMERICS_EXACT_POLYNOMIAL_H

#include <boost/container/static_vector.hpp>
#include <boost/multiprecision/cpp_int.hpp>
#include <cassert>
#include <cstddef>
#include <initializer_list>
#include <utility>
#include <vector>

namespace fcl {
namespace detail {
namespace deformable {

/// An integer of any size. Up to 512 bits are stored in the object itself. Conditions on
/// coordinates of similar magnitude need no more.
using Integer =
    boost::multiprecision::number<boost::multiprecision::cpp_int_backend<512, 0>,
                                  boost::multiprecision::et_off>;

/// @brief Coefficients by ascending power. The last one is not 0; the polynomial 0 has
/// none.
class ExactPolynomial {
 public:
  /// The conditions of a contact have at most this degree.
  static constexpr int kMaxDegree = 3;
  using Coefficients = boost::container::static_vector<Integer, kMaxDegree + 1>;

  ExactPolynomial() = default;
  ExactPolynomial(std::initializer_list<Integer> coefficients)
      : c_(coefficients.begin(), coefficients.end()) {
    trim();
  }

  bool isZero() const { return c_.empty(); }
  bool operator==(const ExactPolynomial& other) const { return c_ == other.c_; }
  int degree() const { return static_cast<int>(c_.size()) - 1; }
  const Integer& operator[](int i) const {
    assert(i >= 0 && i <= degree());
    return c_[static_cast<std::size_t>(i)];
  }

  ExactPolynomial& operator+=(const ExactPolynomial& other);
  ExactPolynomial& operator-=(const ExactPolynomial& other);
  friend ExactPolynomial operator+(ExactPolynomial a, const ExactPolynomial& b) {
    return a += b;
  }
  friend ExactPolynomial operator-(ExactPolynomial a, const ExactPolynomial& b) {
    return a -= b;
  }
  friend ExactPolynomial operator*(const ExactPolynomial& a, const ExactPolynomial& b);

  ExactPolynomial derivative() const;
  /// @brief Divided by the greatest common divisor of the coefficients.
  ExactPolynomial primitive() const;
  /// @brief Quotient by a divisor that leaves no remainder, up to a constant factor.
  ExactPolynomial quotient(const ExactPolynomial& divisor) const;

  /// @brief The value at k / 2^m, times 2^(m degree).
  Integer valueAt(const Integer& k, unsigned m) const;

  /// @brief Sign at k / 2^m.
  int signAt(const Integer& k, unsigned m) const;

  /// @brief Sign at numerator / denominator, denominator > 0.
  int signAtFraction(const Integer& numerator, const Integer& denominator) const;

  /// @brief Bernstein coefficients over [k, k + 1] / 2^m, each with its binomial and
  /// times 2^(m degree).
  Coefficients bernstein(const Integer& k, unsigned m) const;

  /// @brief Descartes' bound on the number of roots in the open interval (k, k + 1) /
  /// 2^m: the sign changes of the Bernstein coefficients; exact when 0 or 1.
  int signChanges(const Integer& k, unsigned m) const;

 private:
  friend ExactPolynomial remainder(const ExactPolynomial& a, const ExactPolynomial& b);

  void trim() {
    while (!c_.empty() && c_.back().is_zero()) c_.pop_back();
  }

  Coefficients c_;
};

/// @brief Greatest common divisor, primitive; of degree 0 when the two have no common
/// root.
ExactPolynomial gcd(ExactPolynomial a, ExactPolynomial b);

/// @brief A root in [0, 1] of a polynomial. It is the number k / 2^m itself, or the only
/// root in the open interval (k, k + 1) / 2^m. In this case it is simple, and the ends of
/// the interval are not roots.
class Root {
 public:
  /// @brief The number k / 2^m.
  Root(Integer k, unsigned m) : k_(std::move(k)), m_(m) {
    assert(0 <= k_ && k_ <= Integer(1) << m_);
  }
  /// @brief The root of a polynomial in (k, k + 1) / 2^m.
  Root(Integer k, unsigned m, ExactPolynomial polynomial)
      : k_(std::move(k)),
        m_(m),
        is_dyadic_(false),
        sign_below_(polynomial.signAt(k_, m_)),
        polynomial_(std::move(polynomial)) {
    assert(isBetweenEnds());
  }

  /// @brief The exact sign of g at the root. It may narrow the interval.
  int signOf(const ExactPolynomial& g);

  /// @brief Sign of root - numerator / denominator, denominator > 0; exact.
  int compare(const Integer& numerator, const Integer& denominator) const;

  /// @brief A double not above the time of bracket().
  double timeBelow(int clock_exponent) const;

  /// @brief Doubles not above and not below the root.
  double lowerBound() const;
  double upperBound() const;

  /// @brief Doubles [lo, hi] around t, the number in [0, 1] with
  /// 2^clock_exponent t / (1 - t) = s / (1 - s) for this root s. If clock_exponent is 0,
  /// t = s. hi - lo <= width or, where that is less than a few units in the last place,
  /// as close as doubles get.
  std::pair<double, double> bracket(double width, int clock_exponent);

 private:
  /// The number of bits of the root's place in the interval that an estimate in doubles
  /// has.
  static constexpr unsigned kEstimateBits = 48;

  /// No positive double needs more bits.
  static constexpr unsigned kMaxBits = 1100;

  /// Whether the interval is in [0, 1], and the signs at its ends show a root.
  bool isBetweenEnds() const;
  std::pair<double, double> bracketOnClock(double width, int clock_exponent);
  int signOfLine(const ExactPolynomial& g) const;
  /// Makes the interval shorter by a factor of 2^-bits if the root is where it seems to
  /// be, and by a half if it is not.
  /// @return whether the root was there
  bool narrow(unsigned bits);
  /// Sign at the inner point k / 2^m. If it is 0, this point becomes the root.
  int probe(const Integer& k, unsigned m);
  /// The part of the interval, divided into 2^bits parts, in which the root seems to be.
  Integer guessInside(unsigned bits) const;

  Integer k_;
  unsigned m_;
  bool is_dyadic_{true};
  int sign_below_{0};
  ExactPolynomial polynomial_;
};

/// @brief A double not above (direction -1) or not below (1) the time t in [0, 1] with
/// 2^clock_exponent t / (1 - t) = s / (1 - s) for s = k / 2^m. If clock_exponent is 0,
/// t = s.
double timeOf(const Integer& k, unsigned m, int clock_exponent, int direction);

/// @brief All roots of p (not zero) in [0, 1], in no order.
std::vector<Root> rootsInUnitInterval(const ExactPolynomial& p);

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
