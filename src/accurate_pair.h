// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_SRC_ACCURATE_CUBIC_H
#define FCL_CCD_SRC_ACCURATE_CUBIC_H

#include "fcl/narrowphase/detail/deformable/elementary_test.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief The volume u . (v x w) over the whole step, as in solveCoplanarity(), in twice
/// the digits of a double: for features that lie nearly in one plane, whose volume is
/// mere rounding to doubles.
class AccurateCubic {
 public:
  AccurateCubic(FeatureKind kind, const FeaturePoints& x);

  /// @brief Bernstein coefficients over [lo, hi], and a bound on their error; false where
  /// the coordinates leave the range in which there is one.
  bool restrict(double lo, double hi, double (&b)[4], double& error) const;

 private:
  double b_[4];
  double error_;  // infinite where there is no bound
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
