// SPDX-License-Identifier: BSD-3-Clause
//
// The usual elementary tests in plain double precision, to compare with.
#ifndef FCL_BENCHMARK_PLAIN_SOLVERS_H
#define FCL_BENCHMARK_PLAIN_SOLVERS_H

#include "elementary/elementary.h"

namespace fcl {
namespace test {

/// @brief What a solver says of a pair; toc means something only for a contact.
struct SolverAnswer {
  bool contact;
  double toc;
};

/// @brief The paper's non-penetration filter over the whole step: the sign test of the
/// four Bernstein coefficients without a bound on their rounding. False: culled.
bool passesPlainFilter(fcl::ContinuousContactKind kind,
                       const detail::deformable::FeaturePoints& x);

/// @brief Roots of the coplanarity cubic, bracketed between those of its derivative and
/// found to the last place; a touching value (zero up to rounding) counts as a root. The
/// first one at which the features are inside each other up to inside_tol.
SolverAnswer solveCubic(fcl::ContinuousContactKind kind,
                        const detail::deformable::FeaturePoints& x, double inside_tol);

/// @brief Interval-Newton, which answers the early end of an interval of at most
/// `resolution`; the inside test has the same number as tolerance.
/// @param filter  pass the plain filter first; both use the same coefficients
SolverAnswer solveByIntervalNewton(fcl::ContinuousContactKind kind,
                                   const detail::deformable::FeaturePoints& x,
                                   double resolution, bool filter);

/// @brief FCL's own test (detail::Intersect).
SolverAnswer solveByFcl(fcl::ContinuousContactKind kind,
                        const detail::deformable::FeaturePoints& x);

}  // namespace test
}  // namespace fcl

#endif
