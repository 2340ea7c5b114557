// SPDX-License-Identifier: BSD-3-Clause
//
// The definition of a contact a second time, for tests: exact for all finite doubles,
// slow, and made of nothing that the library uses. Polynomials and algebraic numbers are
// CGAL's; whether features touch at a time is decided by orientations in the three
// coordinate planes, of degree 2 in t, where the library has quartics in space.
#ifndef FCL_TEST_ORACLE_EXACT_ORACLE_H
#define FCL_TEST_ORACLE_EXACT_ORACLE_H

#include <boost/multiprecision/cpp_int.hpp>
#include <memory>

#include "elementary/elementary.h"

namespace fcl {
namespace test {

/// @brief Whether two features touch in [0, 1], and the first time, an algebraic number.
class OracleAnswer {
 public:
  using Rational = boost::multiprecision::cpp_rational;
  struct FirstTime;

  /// @brief No contact.
  OracleAnswer() = default;
  explicit OracleAnswer(std::shared_ptr<FirstTime> time) : time_(std::move(time)) {}

  bool touch() const { return time_ != nullptr; }

  /// @brief Sign of (first time - t), exact. Only if touch(), as all below.
  int compareTime(double t) const;

  /// @brief lower() == upper() is the first time; otherwise it lies strictly between.
  bool isExact() const;
  Rational lower() const;
  Rational upper() const;

  /// @brief Halves the interval until it is not wider than `width`.
  void refine(const Rational& width);

 private:
  std::shared_ptr<FirstTime> time_;
};

/// @brief The answer for closed features, closed [0, 1] and straight paths between the
/// given doubles, which must be finite. Features without area or length are the point
/// sets that their corners span.
OracleAnswer askOracle(fcl::ContinuousContactKind kind,
                       const detail::deformable::FeaturePoints& x);

/// @brief The first time at which the distance of two features is at most d; touch() says
/// whether there is one. VE: vertex, edge. VV: two vertices. Unused points may be null.
/// @pre d >= 0
OracleAnswer askDistanceOracle(fcl::ContinuousContactKind kind,
                               const detail::deformable::FeaturePoints& x, double d);

/// @brief Whether the distance of two features is at most d at the time t, exact.
bool isWithinAt(fcl::ContinuousContactKind kind,
                const detail::deformable::FeaturePoints& x, double d, double t);

}  // namespace test
}  // namespace fcl

#endif
