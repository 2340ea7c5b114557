// SPDX-License-Identifier: BSD-3-Clause
#include "rational_points.h"

#include <boost/multiprecision/integer.hpp>

#include "elementary/exact.h"
#include "elementary/exact_pair.h"

namespace fcl_ccd {

namespace deformable = fcl::detail::deformable;
using deformable::ExactPolynomial;
using deformable::Integer;

deformable::ElementaryResult RationalPoints::decide(fcl::ContinuousContactKind kind,
                                                    double toc_err) const {
  // All coordinates times the same number: the features touch at the same times.
  boost::multiprecision::cpp_int common = 1;
  for (const auto& point : x_)
    for (const auto& path : point)
      for (const Rational& value : path) common = lcm(common, value.denominator);
  const auto toInteger = [&common](const Rational& value) {
    return Integer(value.numerator * (common / value.denominator));
  };
  std::array<deformable::ExactPair::MovingPoint, 4> paths;
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      const Integer from = toInteger(x_[i][k][0]);
      paths[i][k] = ExactPolynomial{from, toInteger(x_[i][k][1]) - from};
    }
  return decideExactly(deformable::ExactPair(kind, paths), toc_err);
}

}  // namespace fcl_ccd
