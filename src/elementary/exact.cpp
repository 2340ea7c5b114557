// SPDX-License-Identifier: BSD-3-Clause
#include "elementary/exact.h"

#include <algorithm>
#include <cassert>
#include <cstdlib>
#include <limits>
#include <vector>

#include "elementary/exact_pair.h"
#include "elementary/magnified_solve.h"
#include "numerics/integer_coordinates.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

/// The time t_max as a fraction, on the clock of FrameDigits.
struct TimeLimit {
  Integer numerator, denominator;

  TimeLimit(double t_max, int clock_exponent) {
    const BinaryDigits t(t_max);
    Integer after = t.digits,
            before = (Integer(1) << static_cast<unsigned>(-t.exponent)) - after;
    (clock_exponent > 0 ? after : before) <<=
        static_cast<unsigned>(std::abs(clock_exponent));
    assert(t.exponent <= 0);
    numerator = after;
    denominator = before + after;
    assert(0 <= numerator && numerator <= denominator);
  }
};

/// Tests whether the features touch at t = 0. Returns whether this, or t_max = 0, decides
/// the answer.
bool isDecidedAtStart(const ExactQuery& query, double t_max, ElementaryResult& result) {
  const bool touch = query.touchInFrame(0);
  result = {touch ? Answer::kYes : Answer::kNo, 0, 0, DecidedBy::kExact};
  return touch || t_max == 0;
}

/// Whether the bracket of a contact is in [0, t_max], and no wider than that and a few
/// units in the last place.
[[maybe_unused]] bool isBracketUntil(double t_max, double toc_err,
                                     const ElementaryResult& result) {
  const double lo = result.toc_lo, hi = result.toc_hi;
  return result.answer != Answer::kYes ||
         (0 <= lo && lo <= hi && hi <= t_max &&
          hi - lo <= toc_err + 8 * std::numeric_limits<double>::epsilon() * hi +
                         std::numeric_limits<double>::min());
}

}  // namespace

ElementaryResult decideByRoots(const ExactPair& pair, int clock_exponent, double toc_err,
                               double t_stop, double t_max) {
  assert(toc_err > 0 && 0 <= t_max && t_max <= 1);
  std::vector<Root> times = pair.candidates();
  std::sort(times.begin(), times.end(),
            [](const Root& a, const Root& b) { return a.lowerBound() < b.lowerBound(); });
  const TimeLimit limit(t_max, clock_exponent);
  bool touch = false;
  double lo = 1, hi = t_max, latest = 1;
  for (Root& t : times) {
    if (t.lowerBound() > latest) break;
    if (!touch && t_stop < 1 && t.timeBelow(clock_exponent) > t_stop) break;
    if (t_max < 1 && t.compare(limit.numerator, limit.denominator) > 0) continue;
    if (!pair.touchAt(t)) continue;
    const auto [t_lo, t_hi] = t.bracket(toc_err, clock_exponent);
    assert(t_lo <= t_hi && t_lo <= t_max);
    lo = touch ? std::min(lo, t_lo) : t_lo;
    hi = std::min(hi, t_hi);
    latest = std::min(latest, t.upperBound());
    touch = true;
  }
  if (!touch) return {Answer::kNo, 0, 0, DecidedBy::kExact};
  assert(0 <= lo && lo <= hi && hi <= t_max);
  return {Answer::kYes, lo, hi, DecidedBy::kExact};
}

ElementaryResult decideExactly(ContinuousContactKind kind, const FeaturePoints& x,
                               double toc_err, double t_stop, double t_max) {
  assert(toc_err > 0 && 0 <= t_max && t_max <= 1);
  ExactQuery query(kind, x);
  ElementaryResult result;
  if (isDecidedAtStart(query, t_max, result)) return result;
  if (isWorthMagnifying(kind, x)) {
    result = solveMagnified(query, toc_err, t_stop, t_max);
    assert(isBracketUntil(t_max, toc_err, result));
    if (result.answer != Answer::kUnsure) return result;
  }
  result =
      decideByRoots(query.pair(), query.digits().clock_exponent, toc_err, t_stop, t_max);
  assert(isBracketUntil(t_max, toc_err, result));
  return result;
}

ElementaryResult decideExactly(const ExactPair& pair, double toc_err) {
  assert(toc_err > 0);
  Root start(0, 0);
  if (start.signOf(pair.volume()) == 0 && pair.touchAt(start))
    return {Answer::kYes, 0, 0, DecidedBy::kExact};
  return decideByRoots(pair, 0, toc_err, 1, 1);
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
