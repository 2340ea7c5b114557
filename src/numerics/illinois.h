// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_NUMERICS_ILLINOIS_H
#define FCL_CCD_NUMERICS_ILLINOIS_H

#include <cassert>
#include <cmath>

namespace fcl {
namespace detail {
namespace deformable {

/// @brief An estimate of a root of f between lo and hi, where f has the values f_lo and
/// f_hi of different sign. It uses the Illinois method: false position that halves the
/// weight of an end that stays. Nothing is proved about the result.
/// @param tol  a step of this length ends the search
template <typename F>
double illinois(F&& f, double lo, double hi, double f_lo, double f_hi, double tol,
                int max_steps) {
  assert(lo <= hi && tol >= 0);
  double t = lo;
  for (int i = 0; i < max_steps; ++i) {
    const double previous = t;
    t = (f_hi * lo - f_lo * hi) / (f_hi - f_lo);
    if (!(t > lo && t < hi)) t = lo + 0.5 * (hi - lo);
    assert(lo <= t && t <= hi);
    if (std::abs(t - previous) <= tol) break;
    const double value = f(t);
    if (value == 0) break;
    if ((value < 0) == (f_lo < 0)) {
      lo = t;
      f_lo = value;
      f_hi *= 0.5;
    } else {
      hi = t;
      f_hi = value;
      f_lo *= 0.5;
    }
  }
  return t;
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
