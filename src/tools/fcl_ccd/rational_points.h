// SPDX-License-Identifier: BSD-3-Clause
//
// The points of a query as its text has them, where doubles cannot.
#ifndef FCL_CCD_RATIONAL_POINTS_H
#define FCL_CCD_RATIONAL_POINTS_H

#include <array>
#include <cstddef>

#include "elementary/feature_points.h"
#include "fcl/narrowphase/continuous_contact_kind.h"
#include "numerics/exact_polynomial.h"
#include "rational_text.h"

namespace fcl_ccd {

/// @brief Four points with straight paths, whose coordinates are rational numbers.
class RationalPoints {
 public:
  /// @param point  0 to 3
  /// @param t  0 or 1
  void set(std::size_t point, std::size_t t, std::size_t axis, const Rational& value) {
    x_[point][axis][t] = value;
  }

  /// @brief Whether and when features of these points touch; exact.
  /// @param toc_err  above 0; the largest width of the bracket of the time
  fcl::detail::deformable::ElementaryResult decide(fcl::ContinuousContactKind kind,
                                                   double toc_err) const;

 private:
  std::array<std::array<std::array<Rational, 2>, 3>, 4> x_;
};

}  // namespace fcl_ccd

#endif
