// SPDX-License-Identifier: BSD-3-Clause
//
// Polynomials with integer coefficients and their real roots in [0, 1], exactly: what the
// last stage of the elementary test needs and no more.
#ifndef FCL_CCD_SRC_EXACT_POLYNOMIAL_H
#define FCL_CCD_SRC_EXACT_POLYNOMIAL_H

#include <boost/multiprecision/cpp_int.hpp>
#include <utility>
#include <vector>

namespace fcl {
namespace detail {
namespace deformable {

using Integer = boost::multiprecision::cpp_int;

/// @brief Coefficients by ascending power, no zero in the last place; empty is zero.
class Polynomial {
 public:
  Polynomial() = default;
  explicit Polynomial(std::vector<Integer> coefficients);

  bool isZero() const { return c_.empty(); }
  int degree() const { return static_cast<int>(c_.size()) - 1; }
  const Integer& operator[](int i) const { return c_[static_cast<std::size_t>(i)]; }

  Polynomial operator+(const Polynomial& other) const;
  Polynomial operator-(const Polynomial& other) const;
  Polynomial operator*(const Polynomial& other) const;

  Polynomial derivative() const;
  /// @brief Divided by the greatest common divisor of the coefficients.
  Polynomial primitive() const;
  /// @brief Quotient by a divisor that divides this without rest, up to a constant
  /// factor.
  Polynomial quotient(const Polynomial& divisor) const;

  /// @brief Sign at k / 2^m.
  int signAt(const Integer& k, unsigned m) const;

  /// @brief Descartes' bound on the number of roots in the open interval (k, k + 1) /
  /// 2^m: the sign changes of the Bernstein coefficients; exact when 0 or 1.
  int signChanges(const Integer& k, unsigned m) const;

 private:
  std::vector<Integer> c_;
};

/// @brief Greatest common divisor, primitive; of degree 0 when the two have no common
/// root.
Polynomial gcd(Polynomial a, Polynomial b);

/// @brief A root in [0, 1] of a square-free polynomial: the number k / 2^m itself, or the
/// only root in the open interval (k, k + 1) / 2^m, whose ends are not roots.
class Root {
 public:
  /// @brief The number 0.
  Root() = default;
  Root(Integer k, unsigned m, bool is_dyadic, Polynomial polynomial)
      : k_(std::move(k)),
        m_(m),
        is_dyadic_(is_dyadic),
        polynomial_(std::move(polynomial)) {}

  /// @brief Sign of g at the root, exact; may narrow the interval.
  int signOf(const Polynomial& g);

  /// @brief Doubles [lo, hi] around the root, hi - lo <= width or, where that is less
  /// than a few units in the last place, as close as doubles get.
  std::pair<double, double> bracket(double width);

 private:
  void halve();

  Integer k_{0};
  unsigned m_{0};
  bool is_dyadic_{true};
  Polynomial polynomial_;
};

/// @brief All roots of p (not zero) in [0, 1], in no order.
std::vector<Root> rootsInUnitInterval(const Polynomial& p);

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
