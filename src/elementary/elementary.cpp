// SPDX-License-Identifier: BSD-3-Clause
#include "elementary/elementary.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <optional>

#include "base/default_floating_point.h"
#include "elementary/accurate_pair.h"
#include "elementary/axis_window.h"
#include "elementary/coplanarity_filter.h"
#include "elementary/exact.h"
#include "elementary/in_plane.h"
#include "elementary/interval_stack.h"
#include "elementary/moving_pair.h"
#include "elementary/pair_table.h"
#include "elementary/predicates.h"
#include "numerics/error_bounds.h"
#include "numerics/illinois.h"
#include "numerics/moving_vector.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

StepVolume restrict(const AccuratePair& pair, double lo, double hi) {
  StepVolume g;
  if (!pair.volume(lo, hi, g.b, g.outer))
    g.outer = std::numeric_limits<double>::infinity();
  g.b[1] *= 3;
  g.b[2] *= 3;
  g.inner = 4 * g.outer;
  return g;
}

bool isFinite(const FeaturePoints& x) {
  double sum = 0;
  for (int i = 0; i < 4; ++i)
    for (int k = 0; k < 3; ++k) sum += 0 * x[i].t0[k] + 0 * x[i].t1[k];
  return sum == 0;
}

/// Whether the features touch at t = 0.
bool touchAtStart(ContinuousContactKind kind, const FeaturePoints& x) {
  return isFinite(x) && doTouchAtStart(kind, x);
}

bool isStill(const FeaturePoints& x) {
  for (int i = 0; i < 4; ++i)
    for (int k = 0; k < 3; ++k)
      if (x[i].t0[k] != x[i].t1[k]) return false;
  return isFinite(x);
}

/// Whether the points pass each other so closely that double-double cannot decide the
/// pair: there the volume is 2^-78 of the volume elsewhere.
bool nearlyMeet(const MovingPair& pair) {
  const Difference &u = pair.difference[kU], &v = pair.difference[kV],
                   &w = pair.difference[kW];
  const ClosestApproach closest({u.t0, v.t0, w.t0}, {u.t1, v.t1, w.t1});
  return closest.s > 0 && closest.s < 1 && closest.duration < 0x1p-26;
}

/// The times that are not proved free of contact and not proved to have one.
struct Undecided {
  bool unsure{false};
  double unsure_lo{1};
  double unsure_hi{0};

  void addUnsure(double lo, double hi) {
    assert(lo <= hi && (!unsure || unsure_lo <= lo));
    if (!unsure) unsure_lo = lo;
    unsure = true;
    unsure_hi = std::max(unsure_hi, hi);
  }

  ElementaryResult withoutProof() const {
    if (unsure) return {Answer::kUnsure, unsure_lo, unsure_hi, DecidedBy::kSolver};
    return {Answer::kNo, 0, 0, DecidedBy::kSolver};
  }
  /// A contact is proved in [lo, hi]. The first contact may be earlier, in an undecided
  /// interval.
  ElementaryResult withContactIn(double lo, double hi, double toc_err) const {
    if (unsure) lo = unsure_lo;
    assert(0 <= lo && lo <= hi && hi <= 1);
    return {hi - lo <= toc_err ? Answer::kYes : Answer::kUnsure, lo, hi,
            DecidedBy::kSolver};
  }
};

/// The search for the first contact of a pair in a window. It examines intervals, the
/// earliest first, and cuts those that no proof decides.
class ContactSearch {
 public:
  ContactSearch(ContinuousContactKind kind, const FeaturePoints& x, double toc_err,
                double t_stop)
      : kind_(kind),
        x_(x),
        toc_err_(toc_err),
        t_stop_(t_stop),
        min_width_(std::min(toc_err, 1e-4) * 0x1p-10),
        pair_(kind, x) {}

  ElementaryResult firstContact(double window_lo, double window_hi) {
    open_.push({window_lo, window_hi});
    [[maybe_unused]] Interval last{window_lo, window_lo};
    for (; !open_.isEmpty(); ++looks_) {
      const auto [lo, hi] = open_.pop();
      // What was before is decided, or noted as unsure.
      assert(last.lo <= lo && lo <= last.hi);
      last = {lo, hi};
      // An undecided interval may end in a contact that begins after t_stop.
      if (lo > t_stop_ && !found_.unsure) break;
      if (looks_ == Intervals::kMaxLooks) {
        giveUp(lo, hi);
        break;
      }
      if (examine(lo, hi)) return answer_;
    }
    return found_.withoutProof();
  }

 private:
  struct Interval {
    double lo, hi;
  };
  using Intervals = IntervalStack<Interval, 128>;
  /// What to do with an interval after a look at it.
  enum class Next { kLeave, kCut, kGiveUp };

  /// Proves that the interval has no contact, or cuts it, or leaves it undecided.
  /// @return whether the search is over, with an answer
  bool examine(double lo, double hi) {
    const double width = hi - lo;
    const StepSegment u = restrict(pair_.difference[kU], lo, hi),
                      v = restrict(pair_.difference[kV], lo, hi),
                      w = restrict(pair_.difference[kW], lo, hi);
    const MovingCross n = accurate_ ? accurate_->normal(lo, hi) : cross(v, w);
    const StepVolume f = accurate_ ? restrict(*accurate_, lo, hi) : spannedVolume(u, n);
    if (f.hasNoRoot()) return false;
    const bool crosses = f.changesSign();

    const Side side = sideIn(lo, hi, u, v, w, n);
    if (side == Side::kNegative) return false;
    if (side == Side::kPositive && crosses && width <= toc_err_)
      return finish(found_.withContactIn(lo, hi, toc_err_));
    if (accurate_ && crosses && side == Side::kMixed) {
      const AccuratePair::RootContact contact = accurate_->contactAtRoot(lo, hi);
      if (contact.answer == Answer::kNo) return false;
      assert(lo <= contact.lo && contact.lo <= contact.hi && contact.hi <= hi);
      if (contact.answer == Answer::kYes)
        return finish(found_.withContactIn(contact.lo, contact.hi, toc_err_));
    }
    // A wide interval with a root is cut close around the root, before other tests.
    if (!(crosses && width > toc_err_)) {
      if (areSeparated(pair_, lo, hi)) return false;
      if (looks_ == 0 && lo == 0 && touchAtStart(kind_, x_))
        return finish({Answer::kYes, 0, 0, DecidedBy::kSolver});
      const Next next = nextFor(lo, hi, f);
      if (next == Next::kGiveUp) {
        giveUp(lo, hi);
        return finish(found_.withoutProof());
      }
      if (next == Next::kLeave) return false;
    }
    cut(lo, hi, f, crosses);
    return false;
  }

  /// insideness() in an interval. The accurate pair finds signs that doubles lose.
  Side sideIn(double lo, double hi, const StepSegment& u, const StepSegment& v,
              const StepSegment& w, const MovingCross& n) {
    const StepSegment segments[] = {u, v, w, restrict(pair_.difference[kR], lo, hi),
                                    restrict(pair_.difference[kQ], lo, hi)};
    return insideness(pair_.table, [&](int i) {
      const auto& [x, y] = pair_.table.inside[i];
      const Side side = sideOver(cross(segments[x], segments[y]), n);
      if (side != Side::kLost || !accurate_) return side;
      return sideOver(accurate_->side(i, lo, hi), n);
    });
  }

  /// Changes to the accurate pair where doubles are not expected to decide.
  Next nextFor(double lo, double hi, const StepVolume& f) {
    // After this many looks doubles alone are not expected to decide.
    constexpr int kAccurateLook = 6;
    // A flat interval (no coefficient has a certain sign) is cut only while the inside
    // conditions may decide.
    constexpr double kMinFlatWidth = 0x1p-2;
    // Norms that are out of range are so in all intervals, and for the accurate pair.
    if (!f.hasBounds() && !accurate_) return Next::kGiveUp;
    if (!accurate_ && (f.isLost() || looks_ >= kAccurateLook)) {
      if (nearlyMeet(pair_)) return Next::kGiveUp;
      accurate_.emplace(kind_, x_);
      push(lo, hi);
      return Next::kLeave;
    }
    const bool flat = !f.hasBounds() || f.isLost();
    const double width = hi - lo;
    if (!(width <= min_width_ || (flat && width <= kMinFlatWidth))) return Next::kCut;
    found_.addUnsure(lo, hi);
    return Next::kLeave;
  }

  /// Cuts an interval close around a root, or in the middle.
  void cut(double lo, double hi, const StepVolume& f, bool crosses) {
    const double width = hi - lo;
    if (!crosses) {
      const double mid = lo + 0.5 * width;
      push(mid, hi);
      push(lo, mid);
      return;
    }
    const double half = width > toc_err_ ? 0.25 * toc_err_ : width * 0x1p-6;
    const double t =
        lo + illinois(f, 0, 1, f.b[0], f.b[3], 0.125 * half / width, 24) * width;
    const double a = std::max(lo, t - half), b = std::min(hi, t + half);
    push(b, hi);
    push(a, b);
    push(lo, a);
  }

  void push(double lo, double hi) {
    if (lo < hi || (lo == hi && open_.isEmpty())) open_.push({lo, hi});
  }

  /// This interval and all later ones stay undecided.
  void giveUp(double lo, double hi) {
    found_.addUnsure(lo, open_.isEmpty() ? hi : open_.latest().hi);
  }

  bool finish(const ElementaryResult& answer) {
    answer_ = answer;
    return true;
  }

  ContinuousContactKind kind_;
  const FeaturePoints& x_;
  double toc_err_, t_stop_;
  /// An interval this short is not cut further.
  double min_width_;
  MovingPair pair_;
  /// The pair in double-double, from the look on from which it is used.
  std::optional<AccuratePair> accurate_;
  Intervals open_;
  int looks_{0};
  Undecided found_;
  ElementaryResult answer_{Answer::kUnsure, 0, 1, DecidedBy::kSolver};
};

/// Whether the bracket of a contact, if there may be one, begins in the window, and is no
/// wider than wanted if a contact is proved.
[[maybe_unused]] bool isBracketFrom(double window_lo, double toc_err,
                                    const ElementaryResult& result) {
  const double lo = result.toc_lo, hi = result.toc_hi;
  return result.answer == Answer::kNo ||
         (window_lo <= lo && lo <= hi && hi <= 1 &&
          (result.answer == Answer::kUnsure || hi - lo <= toc_err));
}

}  // namespace

ElementaryResult solveCoplanarity(ContinuousContactKind kind, const FeaturePoints& x,
                                  double window_lo, double window_hi, double toc_err,
                                  double t_stop) {
  assert(0 <= window_lo && window_lo <= window_hi && window_hi <= 1 && toc_err > 0);
  // Features at rest that touch do so at the start.
  if (isStill(x))
    return {touchAtStart(kind, x) ? Answer::kYes : Answer::kNo, 0, 0, DecidedBy::kSolver};
  if (const int axis = axisOfCommonPlane(x); axis >= 0) {
    if (window_lo == 0 && touchAtStart(kind, x))
      return {Answer::kYes, 0, 0, DecidedBy::kSolver};
    const ElementaryResult result =
        solveInPlane(kind, x, axis, window_lo, window_hi, toc_err);
    assert(isBracketFrom(window_lo, toc_err, result));
    if (result.answer != Answer::kUnsure) return result;
  }
  const ElementaryResult result =
      ContactSearch(kind, x, toc_err, t_stop).firstContact(window_lo, window_hi);
  assert(isBracketFrom(window_lo, toc_err, result));
  return result;
}

double apartUntil(ContinuousContactKind kind, const FeaturePoints& x, double window_lo,
                  double window_hi) {
  assert(0 <= window_lo && window_lo <= window_hi && window_hi <= 1);
  const MovingPair pair(kind, x);
  const Vec d = pair.directionAt(window_lo);
  const double size = maxNorm(d);
  double until = window_hi;
  for (int i = 0; i < pair.table.num_corners; ++i) {
    const auto [place, sign] = pair.table.corner[i];
    const Difference& corner = pair.difference[place];
    const double scale = size * corner.norm, bound = kSideBound * scale;
    if (!isInRange(scale)) return window_lo;
    const double at_lo = sign * dot(d, corner.at(window_lo)) - bound,
                 at_hi = sign * dot(d, corner.at(window_hi)) - bound;
    if (!(at_lo > 0)) return window_lo;
    if (at_hi > 0) continue;
    // Both are lower bounds of a distance from the plane that changes linearly. The share
    // of the window in which it stays positive is rounded three times, the time four
    // times, by 2^-53 each.
    const double share = at_lo / (at_lo - at_hi) * (1 - 0x1p-50);
    assert(0 <= share && share <= 1);
    until = std::min(until, window_lo + share * (window_hi - window_lo) - 0x1p-51);
  }
  return std::max(window_lo, until);
}

ElementaryResult decide(ContinuousContactKind kind, const FeaturePoints& x,
                        double window_lo, double window_hi, double toc_err, double t_stop,
                        double t_max) {
  assert(window_hi <= t_max);
  // The bounds on rounding are those of this mode.
  assert(isDefaultFloatingPointMode());
  const ElementaryResult solved =
      solveCoplanarity(kind, x, window_lo, window_hi, toc_err, t_stop);
  if (solved.answer != Answer::kUnsure) return solved;
  const ElementaryResult exact = decideExactly(kind, x, toc_err, t_stop, t_max);
  // What the stages before prove is true: no filter would have removed a contact, and the
  // solver has not passed its time.
  assert(exact.answer != Answer::kYes || mayBecomeCoplanar(kind, x, 0, 1));
  assert(exact.answer != Answer::kYes || exact.toc_hi >= solved.toc_lo);
  return exact;
}

namespace {

/// A single pair, for runStages().
struct SinglePair {
  ContinuousContactKind kind;
  const FeaturePoints& x;
  double window_lo, window_hi, toc_err, t_stop;
  ElementaryResult result;

  void cullByBoxes() {
    const bool may_meet = narrowWindow(kind, x, window_lo, window_hi);
    result = {may_meet ? Answer::kUnsure : Answer::kNo, 0, 0, DecidedBy::kBox};
  }
  void filterCoplanarity() {
    if (result.answer == Answer::kUnsure &&
        !mayBecomeCoplanar(kind, x, window_lo, window_hi))
      result = {Answer::kNo, 0, 0, DecidedBy::kFilter};
  }
  /// Only for eight pairs at a time; solveRest() decides plain cases as well.
  void solvePlainCases() {}
  void solveRest() {
    if (result.answer == Answer::kUnsure)
      result = decide(kind, x, window_lo, window_hi, toc_err, t_stop);
  }
};

}  // namespace

ElementaryResult elementaryTest(ContinuousContactKind kind, const FeaturePoints& x,
                                double window_lo, double window_hi, double toc_err,
                                double t_stop) {
  SinglePair pair{kind, x, window_lo, window_hi, toc_err, t_stop, {}};
  runStages(pair);
  return pair.result;
}

namespace {

/// A factor for a vector whose fourth power would leave the range of double.
double scaleOf(const Vec& v) {
  const double norm = maxNorm(v);
  if (norm > 0x1p-100 && norm < 0x1p100) return 1;
  const bool has_size = norm > 0 && std::isfinite(norm);
  return has_size ? std::ldexp(1, std::min(-std::ilogb(norm), 1000)) : 1;
}

double clamped(double value) { return std::max(0., std::min(1., value)); }

/// Where two parallel edges meet. They begin at a distance u from each other and go along
/// v and w. The result is the position on the first edge of the beginning of the second
/// edge, or of its end: of the one that is nearer to the middle of the first edge.
/// @return the positions on both edges, from 0 to 1
std::pair<double, double> meetingOfParallels(const Vec& u, const Vec& v, const Vec& w) {
  const double along = dot(v, v), other = dot(w, w);
  const auto onSecond = [&](double s) {
    return other > 0 ? clamped((s * dot(v, w) - dot(u, w)) / other) : 0.;
  };
  if (!(along > 0)) return {0, onSecond(0)};
  const double first = dot(u, v) / along, last = first + dot(w, v) / along;
  const double nearer = std::abs(first - 0.5) <= std::abs(last - 0.5) ? first : last;
  const double s = clamped(nearer);
  return {s, onSecond(s)};
}

}  // namespace

void contactGeometry(ContinuousContactKind kind, const FeaturePoints& x, double t,
                     double (&position)[3], double (&normal)[3]) {
  // If the cross product of two edges is smaller, it is rounding only.
  constexpr double kParallel = 0x1p-48;
  assert(0 <= t && t <= 1);
  const bool vf = kind == ContinuousContactKind::kVertexFace;
  const MovingPair pair(kind, x);
  const Vec u = pair.difference[kU].at(t), v_there = pair.difference[kV].at(t),
            w_there = pair.difference[kW].at(t);
  const double v_scale = scaleOf(v_there), w_scale = scaleOf(w_there);
  const Vec v = v_scale * v_there, w = w_scale * w_there;
  Vec n = cross(v, w);
  // Weights of the four vertices in the two points that meet (feature 2 minus feature 1).
  double weight[4];
  const double area = dot(n, n);
  // u x w and v x u, with the scale of v x w.
  const double along_w = dot(cross(v_scale * u, w), n),
               along_v = dot(cross(v, w_scale * u), n);
  if (vf) {
    const double beta = area > 0 ? clamped(along_w / area) : 1. / 3;
    const double gamma = area > 0 ? clamped(along_v / area) : 1. / 3;
    weight[0] = -1;
    weight[1] = 1 - beta - gamma;
    weight[2] = beta;
    weight[3] = gamma;
  } else {
    std::pair<double, double> at(clamped(along_w / area), clamped(-along_v / area));
    if (!(area > kParallel * kParallel * (dot(v, v) * dot(w, w)))) {
      const double scale = std::min(v_scale, w_scale);
      at = meetingOfParallels(scale * u, scale * v_there, scale * w_there);
    }
    weight[0] = at.first - 1;
    weight[1] = -at.first;
    weight[2] = 1 - at.second;
    weight[3] = at.second;
  }
  // Those of a point add up to 1, minus those of the other one.
  assert(std::abs(weight[0] + weight[1] + weight[2] + weight[3]) <= 0x1p-50);
  double position_1[3] = {0, 0, 0}, relative_velocity[3] = {0, 0, 0};
  double offset_t0[3] = {0, 0, 0};
  for (int i = 0; i < 4; ++i)
    for (int k = 0; k < 3; ++k) {
      const double a = x[i].t0[k], b = x[i].t1[k];
      if (i < (vf ? 1 : 2)) position_1[k] -= weight[i] * ((1 - t) * a + t * b);
      relative_velocity[k] += weight[i] * (b - a);
      offset_t0[k] += weight[i] * a;
    }
  std::copy(position_1, position_1 + 3, position);

  // The square of a short normal may be subnormal, and so rounded.
  n = scaleOf(n) * n;
  const double length = std::sqrt(dot(n, n));
  if (!(length > 0) || !std::isfinite(length)) {
    std::fill(normal, normal + 3, 0.);
    return;
  }
  n = (1 / length) * n;
  assert(std::abs(dot(n, n) - 1) < 0x1p-46);
  double along =
      dot(n, {relative_velocity[0], relative_velocity[1], relative_velocity[2]});
  if (along == 0) along = -dot(n, {offset_t0[0], offset_t0[1], offset_t0[2]});
  if (along > 0) n = -1. * n;
  normal[0] = n.x;
  normal[1] = n.y;
  normal[2] = n.z;
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
