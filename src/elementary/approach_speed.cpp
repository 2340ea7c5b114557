// SPDX-License-Identifier: BSD-3-Clause
#include "elementary/approach_speed.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <optional>

#include "elementary/flat_passage.h"
#include "elementary/in_plane.h"
#include "elementary/interval_stack.h"
#include "elementary/moving_pair.h"
#include "numerics/error_bounds.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

double lengthOf(const Vec& v) { return std::sqrt(dot(v, v)); }

/// A vector's change in the step, a constant velocity. A component is below 2 U and has
/// an error of 4 u U: those of both ends, and its own rounding.
Vec changeOf(const Difference& d) { return d.t1 - d.t0; }

/// The volume's derivative by time, u' . (v x w) + v' . (w x u) + w' . (u x v): a bound
/// on its size over an interval.
///
/// A product in u' . n is of size 4 UVW. Its error is 4 u U 2 VW + 2 U 22 u VW + 4 u UVW
/// = 56 u UVW. Three of them and sums of size 8 and 12: 188 u UVW. Three such terms and
/// sums of size 24 and 36: 624 u UVW. The middle coefficient is taken by its half, which
/// has no larger errors.
double mostVolumeChange(const Vec (&change)[3], const CrossCoefficients (&of_others)[3],
                        double size) {
  constexpr double kBound = 640 * kUnit;
  double c[3] = {0, 0, 0};
  for (int i = 0; i < 3; ++i) {
    c[0] += dot(change[i], of_others[i].c0);
    c[1] += dot(change[i], of_others[i].c1);
    c[2] += dot(change[i], of_others[i].c2);
  }
  return std::max(std::max(std::abs(c[0]), 0.5 * std::abs(c[1])), std::abs(c[2])) +
         kBound * size;
}

double mostVolume(const StepVolume& f) {
  return std::max(std::max(std::abs(f.b[0]), std::abs(f.b[3])) + f.outer,
                  (std::max(std::abs(f.b[1]), std::abs(f.b[2])) + f.inner) / 3);
}

/// A lower bound on the length of n over an interval: that along its direction in the
/// middle, a unit vector up to 5 u. A product with n is off by 1.8 errors of a component,
/// and rounds by less than 40 u VW, which is another two.
double leastLength(const MovingCross& n) {
  const Vec middle = n.c0 + n.c1 + n.c2;
  const double length = lengthOf(middle);
  if (!(length > 0)) return 0;
  const Vec m = (1 / length) * middle;
  const double least =
      std::min(std::min(dot(m, n.c0), 0.5 * dot(m, n.c1)), dot(m, n.c2)) - 4 * n.error;
  // Not above the length at the ends, which is below 1.8 times the largest coordinate.
  assert(!(least > 2 * maxNorm(n.c0)) && !(least > 2 * maxNorm(n.c2)));
  return least;
}

/// An upper bound on the length of the derivative of n, v' x w + v x w', which is linear.
/// A component has four products of size 2 VW with errors of 14 u VW, and sums: less than
/// 96 u VW.
double mostNormalChange(const StepSegment& v, const StepSegment& w, const Vec& dv,
                        const Vec& dw) {
  const double at_lo = lengthOf(cross(dv, w.l) + cross(v.l, dw)),
               at_hi = lengthOf(cross(dv, w.h) + cross(v.h, dw));
  return std::max(at_lo, at_hi) * kUpward + 192 * kUnit * (v.norm * w.norm);
}

/// Whether the volume has at most one root in the interval: its coefficients change their
/// sign at most once, also if any that is not certain has either sign.
bool hasOneRootAtMost(const StepVolume& f) {
  const double bound[4] = {f.outer, f.inner, f.inner, f.outer};
  const auto isCertain = [&](int i, double sign) { return sign * f.b[i] > bound[i]; };
  const double first = f.b[0] < 0 ? -1 : 1;
  int last = 0;
  while (last < 4 && isCertain(last, first)) ++last;
  // The coefficient after these may have any sign.
  for (int i = last + 1; i < 4; ++i)
    if (!isCertain(i, -first)) return false;
  return true;
}

/// The times at which a pair may approach, the earliest first.
class ApproachSearch {
 public:
  ApproachSearch(ContinuousContactKind kind, const FeaturePoints& x,
                 const TouchingRequest& request)
      : pair_(kind, x), request_(request) {
    for (int i = 0; i < 3; ++i) change_[i] = changeOf(pair_.difference[i]);
    if (!request.stars) return;
    for (int flat = 0; flat < (pair_.table.isTriangle() ? 1 : 2); ++flat)
      passages_[flat].emplace(pair_, x, *request.stars, flat, request.toc_lo,
                              request.min_approach_speed);
  }

  double first() {
    const double toc_hi = request_.toc_hi;
    if (toc_hi < request_.t_max) open_.push({toc_hi, request_.t_max});
    // A contact that approaches is decided by the first look.
    open_.push({request_.toc_lo, toc_hi});
    [[maybe_unused]] double left_out_until = request_.toc_lo;
    for (int looks = 0; !open_.isEmpty(); ++looks) {
      const Interval now = open_.pop();
      assert(now.lo == left_out_until);
      if (isLeftOut(now.lo, now.hi, looks == 0)) {
        left_out_until = now.hi;
        continue;
      }
      if (now.hi - now.lo <= kNarrow || looks == Intervals::kMaxLooks) return now.lo;
      const double middle = now.lo + 0.5 * (now.hi - now.lo);
      open_.push({middle, now.hi});
      open_.push({now.lo, middle});
    }
    assert(left_out_until >= request_.t_max);
    return kNever;
  }

 private:
  struct Interval {
    double lo, hi;
  };
  using Intervals = IntervalStack<Interval, 128>;
  /// What is not decided in a part of the step that is as short counts as approach.
  static constexpr double kNarrow = 0x1p-13;

  /// Whether one of the proofs of approachesFrom() holds.
  bool isLeftOut(double lo, double hi, bool is_first) {
    const StepSegment u = restrict(pair_.difference[kU], lo, hi),
                      v = restrict(pair_.difference[kV], lo, hi),
                      w = restrict(pair_.difference[kW], lo, hi);
    const MovingCross n = cross(v, w);
    const StepVolume f = spannedVolume(u, n);
    if (!f.hasBounds()) return false;
    const double sign = f.b[0] > f.outer ? 1 : f.b[0] < -f.outer ? -1 : 0;
    if (is_first && hasOneRootAtMost(f)) side_ = sign;
    if (side_ != 0 && sign == side_ && f.hasNoRoot()) return true;
    if (!may_be_across_ && areSeparated(pair_, lo, hi)) return true;
    if (isSlow(u, v, w, n, f)) {
      may_be_across_ = true;
      return true;
    }
    const StepSegment segments[] = {u, v, w, restrict(pair_.difference[kR], lo, hi),
                                    restrict(pair_.difference[kQ], lo, hi)};
    const auto sideOf = [&](int i) {
      const auto& [p, q] = pair_.table.inside[i];
      return sideOver(cross(segments[p], segments[q]), n);
    };
    return insideness(pair_.table, sideOf) == Side::kNegative ||
           passesFlat(lo, hi, sideOf);
  }

  template <typename SideOf>
  bool passesFlat(double lo, double hi, const SideOf& sideOf) {
    for (const auto& passage : passages_) {
      if (!passage) continue;
      const FlatPassage::Answer answer = passage->passes(lo, hi, sideOf);
      may_be_across_ |= answer == FlatPassage::Answer::kAcross;
      if (answer != FlatPassage::Answer::kUnknown) return true;
    }
    return false;
  }

  /// The derivative of volume / |n| is volume' / |n| - (volume / |n|) (n . n') / |n|^2.
  bool isSlow(const StepSegment& u, const StepSegment& v, const StepSegment& w,
              const MovingCross& n, const StepVolume& f) const {
    const double least = leastLength(n);
    if (!(least > 0)) return false;
    const CrossCoefficients of_others[3] = {n, cross(w, u), cross(u, v)};
    const double change =
        mostVolumeChange(change_, of_others, u.norm * (v.norm * w.norm));
    const double height = mostVolume(f) / least;
    const double turned = height * mostNormalChange(v, w, change_[kV], change_[kW]);
    return (change + turned) * kUpward <= request_.min_approach_speed * least;
  }

  MovingPair pair_;
  /// Of u, v and w.
  Vec change_[3];
  const TouchingRequest& request_;
  /// The sign of the volume before the contact; 0: not known.
  double side_{0};
  /// Whether the features may have passed through each other so far.
  bool may_be_across_{false};
  /// For each feature that may be flat.
  std::optional<FlatPassage> passages_[2];
  Intervals open_;
};

}  // namespace

double approachesFrom(ContinuousContactKind kind, const FeaturePoints& x,
                      const TouchingRequest& request) {
  assert(request.min_approach_speed > 0 && request.toc_lo <= request.toc_hi);
  assert(0 <= request.toc_lo && request.toc_hi <= 1 && request.t_max <= 1);
  if (axisOfCommonPlane(x) >= 0) return kNever;
  return ApproachSearch(kind, x, request).first();
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
