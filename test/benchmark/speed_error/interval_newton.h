// SPDX-License-Identifier: BSD-3-Clause
//
// The root finder that the paper and its predecessors use, after Redon et al. 2002 and
// Tang et al. 2009: Interval-Newton on the coplanarity cubic, an inside test where an
// interval is short enough. Tuned: the range of the derivative is exact (it is a
// quadratic), an interval without a root is also rejected by its mean value form, and
// the earlier half is looked at first. As in the original, nothing is rounded outward.
#ifndef FCL_BENCHMARK_INTERVAL_NEWTON_H
#define FCL_BENCHMARK_INTERVAL_NEWTON_H

#include "coplanarity_cubic.h"

namespace fcl {
namespace test {

/// @brief First time of contact, or -1.
/// @param resolution  intervals shorter than this are given to the inside test
/// @param inside_tol  see areInside()
template <typename N>
N firstTimeByIntervalNewton(const RelativePair<N>& pair, const CoplanarityCubic<N>& cubic,
                            const N& resolution, const N& inside_tol) {
  const N zero(0), none(-1);
  if (cubic.isFlat())
    return areInside(pair, N(0), inside_tol)   ? N(0)
           : areInside(pair, N(1), inside_tol) ? N(1)
                                               : none;
  const PowerCubic<N> f(cubic);
  const N three_c3 = N(3) * f.c[3];
  const N turn = f.c[3] == zero ? none : (zero - f.c[2]) / three_c3;
  const N derivative_at_turn = f.derivative(turn);

  // Where the values overflow or underflow no interval can be rejected; others take fewer
  // than a hundred looks.
  constexpr int kMaxLooks = 1000;
  // Each level of bisection leaves one interval open and at least halves the next.
  constexpr int kMaxOpen = 64;
  struct Interval {
    N lo, hi;
  } open[kMaxOpen];
  int num_open = 0;
  open[num_open++] = {N(0), N(1)};
  for (int look = 0; num_open > 0; ++look) {
    --num_open;
    N lo = open[num_open].lo, hi = open[num_open].hi;
    if (look == kMaxLooks) return lo;  // given up, on the safe side
    // The range of the derivative.
    const N slope_lo = f.derivative(lo), slope_hi = f.derivative(hi);
    N least = slope_lo < slope_hi ? slope_lo : slope_hi;
    N most = slope_lo < slope_hi ? slope_hi : slope_lo;
    if (turn > lo && turn < hi) {
      if (derivative_at_turn < least) least = derivative_at_turn;
      if (derivative_at_turn > most) most = derivative_at_turn;
    }
    const N mid = N(0.5) * (lo + hi), half = hi - mid;
    const N value = f(mid);
    const N old_width = hi - lo;
    if (least > zero || most < zero) {
      // A quotient of the value by the derivative's range.
      const N p = value / least, q = value / most;
      const N newton_lo = mid - (p > q ? p : q), newton_hi = mid - (p > q ? q : p);
      if (newton_lo > hi || newton_hi < lo) continue;
      if (newton_lo > lo) lo = newton_lo;
      if (newton_hi < hi) hi = newton_hi;
    } else {
      const N steepest = most > zero - least ? most : zero - least;
      const N reach = half * steepest;
      if (value > reach || value < zero - reach) continue;
    }
    const N width = hi - lo;
    if (width <= resolution || num_open + 2 > kMaxOpen) {
      if (areInside(pair, N(0.5) * (lo + hi), inside_tol)) return lo;
      continue;
    }
    if (width <= N(0.5) * old_width) {
      open[num_open++] = {lo, hi};
    } else {
      const N cut = N(0.5) * (lo + hi);
      open[num_open++] = {cut, hi};
      open[num_open++] = {lo, cut};
    }
  }
  return none;
}

}  // namespace test
}  // namespace fcl

#endif
