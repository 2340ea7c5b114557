// SPDX-License-Identifier: BSD-3-Clause
//
// The advancement of eight pairs to a distance, step by step as advanceToDistance() does
// it: every number has the same bits. A lane that needs more than the plain steps is left
// open. And the least distance of eight pairs at rest.
#if defined(FCL_CCD_USE_HIGHWAY)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "kernels/advance_kernels.cpp"
#include "hwy/foreach_target.h"
#endif

#include <algorithm>
#include <cassert>
#include <cstdint>

#include "base/bits.h"
#include "elementary/distance_advance.h"
#include "elementary/least_distance.h"
#include "kernels/eight_features.h"
#include "kernels/kernel_functions.h"
#include "kernels/lanes.h"
#include "kernels/nearest_points.h"
#include "kernels/point_orders.h"
#include "kernels/vectors.h"

HWY_BEFORE_NAMESPACE();
namespace fcl {
namespace detail {
namespace deformable {
namespace HWY_NAMESPACE {

/// Eight DifferencePolygons, of VF or EE pairs.
struct Polygons {
  Vectors t0[4], t1[4], velocity[4];
  Doubles size;
  int count;

  Polygons() = default;
  FCL_CCD_INLINE Polygons(ContinuousContactKind kind, const Vectors (&x0)[4],
                          const Vectors (&x1)[4]) {
    set(kind, x0, x1);
  }

  FCL_CCD_INLINE void set(ContinuousContactKind kind, const Vectors (&x0)[4],
                          const Vectors (&x1)[4]) {
    count = kind == ContinuousContactKind::kVertexFace ? 3 : 4;
    size = all(0);
    for (int k = 0; k < count; ++k) {
      const CornerPoints p = DifferencePolygon::pointsOf(kind, k);
      t0[k] = x0[p.second] - x0[p.first];
      t1[k] = x1[p.second] - x1[p.first];
      velocity[k] = t1[k] - t0[k];
      size = larger(size, larger(dot(t0[k], t0[k]), dot(t1[k], t1[k])));
    }
    size = squareRoot(size) * all(1 + 0x1p-50);
  }

  FCL_CCD_INLINE int next(int k) const { return k + 1 < count ? k + 1 : 0; }

  FCL_CCD_INLINE void cornersAt(const Doubles& t, Vectors (&corner)[4]) const {
    for (int k = 0; k < count; ++k) corner[k] = at(t0[k], t1[k], t);
  }
};

/// Until when directions separate pairs, and how fast the gap closes.
struct Steps {
  Doubles until, rate;
};

/// A lane of the mask fails: its direction proves nothing.
FCL_CCD_INLINE Steps where(const DoubleMask& proves, const Steps& steps) {
  return {select(proves, steps.until, all(-HUGE_VAL)),
          select(proves, steps.rate, all(0))};
}

/// AdvancingPair::fixedStep().
FCL_CCD_INLINE Steps fixedSteps(const Polygons& x, const Vectors& n, const Doubles& least,
                                const Doubles& t) {
  const Doubles zero = all(0);
  Steps steps{all(HUGE_VAL), zero};
  DoubleMask proves = zero == zero;
  for (int k = 0; k < x.count; ++k) {
    const Doubles a = dot(n, x.t0[k]) - least, b = dot(n, x.t1[k]) - least;
    const DoubleMask starts = a > zero, ends = b > zero;
    const Doubles time = a / (a - b), down = time * all(Advance::kDown);
    proves = proves & (starts | (ends & (time * all(Advance::kUp) <= t)));
    const DoubleMask is_first = starts & (b <= zero) & (down < steps.until);
    steps.until = select(is_first, down, steps.until);
    steps.rate = select(is_first, a - b, steps.rate);
  }
  return where(proves, steps);
}

/// AdvancingPair::turningStep().
FCL_CCD_INLINE Steps turningSteps(const Polygons& x, const Vectors (&corner)[4],
                                  const Vectors& n, const Vectors& turn, const Doubles& d,
                                  const Doubles& least, const Doubles& t) {
  const Doubles zero = all(0), square = dot(turn, turn);
  Doubles longest = all(1) / squareRoot(square), rate = zero;
  DoubleMask proves = longest > zero;
  for (int k = 0; k < x.count; ++k) {
    const Vectors &c = corner[k], &change = x.velocity[k];
    const Doubles gap = dot(n, c) - least,
                  closing = dot(n, change) + dot(turn, c) - d * dot(n, turn),
                  bend = dot(turn, change) - all(0.5) * d * square;
    const Doubles root = firstRoots(gap, closing, bend);
    proves = proves & (gap > zero);
    const DoubleMask is_first = root < longest;
    longest = select(is_first, root, longest);
    rate = select(is_first, zero - closing, rate);
  }
  return where(proves, {t + longest * all(Advance::kDown), rate});
}

/// The plain directions of the nearest points.
struct PlainDirections {
  NearestSides sides;
  Vectors n;

  FCL_CCD_INLINE void set(const Polygons& x, const Vectors (&corner)[4],
                          const NearestPoints& near) {
    sides = NearestSides(x, corner, near);
    n = directionsApart(near, sides);
  }
};

/// AdvancingPair::longestStep(), its first attempt.
FCL_CCD_INLINE Steps longestSteps(const Polygons& x, const Vectors (&corner)[4],
                                  const NearestPoints& near, const PlainDirections& plain,
                                  const Doubles& d, const Doubles& least,
                                  const Doubles& t, double t_stop) {
  const Vectors& n = plain.n;
  const Steps fixed = fixedSteps(x, n, least, t);
  const DoubleMask is_enough = fixed.until > all(t_stop);
  if (isAll(is_enough)) return fixed;
  const Steps turning = turningSteps(
      x, corner, n, turnsApart(x, corner, near, plain.sides, n), d, least, t);
  const DoubleMask is_longer =
      (fixed.until <= all(t_stop)) & (turning.until > fixed.until);
  return {select(is_longer, turning.until, fixed.until),
          select(is_longer, turning.rate, fixed.rate)};
}

/// DistanceTolerance of eight pairs.
struct Tolerances {
  Doubles distance_error, margin, touching;

  FCL_CCD_INLINE Tolerances(const Doubles& d, const Doubles& size)
      : distance_error(all(64 * kUnit) * size),
        margin(all(128 * kUnit) * (d + size)),
        touching(all(DistanceTolerance::kTouching) * (d + size)) {}
};

/// A pair on its way to the distance.
struct PairOnWay {
  /// Which of the pairs it is.
  std::size_t number;
  /// Until when it is apart, how fast the gap closes, and its distance.
  double time, rate, distance;
};

/// Eight pairs on their way to the distance.
class AdvancingPairs {
 public:
  /// @param on_way  1 to 8 of the pairs
  FCL_CCD_INLINE void begin(ContinuousContactKind kind, const FourPoints* pairs,
                            const PairOnWay* on_way, std::size_t count) {
    assert(1 <= count && count <= kEight);
    count_ = count;
    EightPoints eight;
    double time[kEight], rate[kEight], distance[kEight];
    for (std::size_t lane = 0; lane < kEight; ++lane) {
      // Copies of the last pair fill the empty lanes.
      const PairOnWay& pair = on_way[std::min(lane, count - 1)];
      number_[lane] = pair.number;
      eight.set(lane, pairs[pair.number].x);
      time[lane] = pair.time;
      rate[lane] = pair.rate;
      distance[lane] = pair.distance;
    }
    Points points(eight);
    orders_ = PointOrders(kind, points);
    x_.set(kind, points.t0, points.t1);
    t_ = load<kEight>(time);
    rate_ = load<kEight>(rate);
    d_ = load<kEight>(distance);
    const Doubles size = max(x_.size, d_);
    open_ = ~bits((size >= all(Advance::kLeastSize)) & (size <= all(Advance::kMostSize)));
  }

  /// Takes a step.
  /// @param step  its number, from 0 on
  /// @return the pairs that are left, a bit each
  FCL_CCD_INLINE unsigned advance(int step, const DistanceRequest& request) {
    // Most pairs take two or three.
    constexpr int kMostStepsTogether = 12;
    const double t_stop = std::min(request.t_stop, request.t_max);
    Tolerances tolerance(d_, x_.size);
    Vectors corner[4];
    x_.cornersAt(t_, corner);
    near_ = nearestPoints(x_, corner);
    open_ |= ~bits(near_.is_sure);
    reached_ = near_.distance + tolerance.distance_error;
    const bool ignores = step == 0 && request.ignores_initially_closer;
    PlainDirections plain;
    if (ignores) {
      plain.set(x_, corner, near_);
      open_ |= ~bits(areSure(corner, plain.n, tolerance.distance_error));
      ignoreInitiallyCloser(tolerance);
      tolerance = Tolerances(d_, x_.size);
    }
    is_contact_ = reached_ <= d_ + tolerance.touching;
    left_ = ~(open_ | bits(is_contact_)) & ((1U << count_) - 1);
    if (left_ == 0) return 0;
    if (!ignores) plain.set(x_, corner, near_);
    const Steps next =
        longestSteps(x_, corner, near_, plain, d_, d_ + tolerance.margin, t_, t_stop);
    open_ |= left_ & ~bits(next.until > t_);
    const DoubleMask is_soon = next.until <= all(t_stop);
    left_ &= ~open_ & bits(is_soon);
    if (step == kMostStepsTogether) {
      open_ |= left_;
      left_ = 0;
    }
    const DoubleMask moves =
        (reached_ > d_ + tolerance.touching) & (next.until > t_) & is_soon;
    t_ = select(moves, next.until, t_);
    rate_ = select(moves, next.rate, rate_);
    return left_;
  }

  /// Takes the answers of the pairs that are not left.
  /// @param on_way  gets those that are left
  /// @return behind the last of these
  FCL_CCD_INLINE PairOnWay* takeAnswers(const DistanceRequest& request, Approach* answers,
                                        PairOnWay* on_way) {
    double toc_lo[kEight], toc_hi[kEight], part[kEight], rate[kEight], distance[kEight];
    store(t_, toc_lo);
    store(upperEnds(request), toc_hi);
    store(near_.part, part);
    store(rate_, rate);
    store(d_, distance);
    const unsigned open = open_ | orders_.unknown(), yes = bits(is_contact_) & ~open;
    // Each mask is read by itself: a branch for each lane would be unpredictable.
    for (unsigned lanes = left_; lanes != 0; lanes &= lanes - 1) {
      const auto lane = static_cast<std::size_t>(lowestBit(lanes));
      *on_way++ = {number_[lane], toc_lo[lane], rate[lane], distance[lane]};
    }
    for (unsigned lanes = ~left_ & ((1U << count_) - 1); lanes != 0; lanes &= lanes - 1) {
      const auto lane = static_cast<std::size_t>(lowestBit(lanes));
      Approach& out = answers[number_[lane]];
      out.answer = open >> lane & 1U  ? Approach::Answer::kOpen
                   : yes >> lane & 1U ? Approach::Answer::kYes
                                      : Approach::Answer::kNo;
      out.exchanges = static_cast<std::uint8_t>(orders_.exchanges(lane));
      out.part = static_cast<std::uint8_t>(part[lane]);
      out.toc_lo = toc_lo[lane];
      out.toc_hi = toc_hi[lane];
      assert(out.exchanges < 8 && out.part <= Approach::kInside);
      assert(out.answer != Approach::Answer::kYes || isBracket(out, request));
    }
    return on_way;
  }

 private:
  /// Whether the bracket of a contact is in the part of the step that is asked for, and
  /// no wider than wanted.
  [[maybe_unused]] static bool isBracket(const Approach& contact,
                                         const DistanceRequest& request) {
    return 0 <= contact.toc_lo && contact.toc_lo <= contact.toc_hi &&
           contact.toc_hi <= request.t_max &&
           contact.toc_hi - contact.toc_lo <= request.toc_err;
  }
  /// The upper ends of the brackets: setBracket() in distance_advance.cpp.
  FCL_CCD_INLINE Doubles upperEnds(const DistanceRequest& request) {
    const Doubles gap = reached_ - d_,
                  distance_error = Tolerances(d_, x_.size).distance_error;
    const Doubles width = min(min(all(request.toc_err), all(Advance::kShareOfTime) * t_),
                              all(request.t_max) - t_);
    Doubles hi = t_, h = all(Advance::kFirstGuess) * gap / rate_;
    DoubleMask is_left = is_contact_ & (t_ > all(0)) & (reached_ > d_) &
                         (width > all(0)) & (rate_ > all(0));
    if ((bits(is_left) & ~open_) == 0) return hi;
    const auto take = [&](const Doubles& time, const Doubles& distance) HWY_ATTR {
      const DoubleMask is_within = is_left & (time > t_) & (time - t_ <= width) &
                                   (distance + distance_error <= d_);
      hi = select(is_within, time, hi);
      is_left = is_left & (hi == t_);
    };
    const Doubles guess = t_ + min(h, width);
    take(guess, distancesOfNearest(guess));
    for (unsigned left = bits(is_left) & ~open_; left != 0; left &= bits(is_left)) {
      const Doubles time = t_ + min(h, width);
      Vectors corner[4];
      x_.cornersAt(time, corner);
      const NearestPoints there = nearestPoints(x_, corner);
      // A sum that is rounded up to more than the width, and a sliver.
      open_ |= left & ~bits((time - t_ <= width) & there.is_sure);
      take(time, there.distance);
      is_left = is_left & (h < width);
      left &= ~open_;
      h = h * all(Advance::kFactor);
    }
    return hi;
  }

  /// AdvancingPair::distanceOf() the nearest points at t_.
  FCL_CCD_INLINE Doubles distancesOfNearest(const Doubles& time) const {
    Vectors corner[4];
    x_.cornersAt(time, corner);
    const NearestSides sides(x_, corner, near_);
    const Vectors inside = corner[0] + near_.along * (corner[1] - corner[0]) +
                           near_.across * (corner[x_.count - 1] - corner[0]),
                  on_side = sides.from + near_.along * (sides.to - sides.from);
    const Vectors point =
        select(near_.isInside(), inside, select(near_.isSide(), on_side, sides.from));
    return squareRoot(dot(point, point));
  }

  /// AdvancingPair::sureNearest(): the lanes whose nearest points it takes as they are.
  FCL_CCD_INLINE DoubleMask areSure(const Vectors (&corner)[4], const Vectors& n,
                                    const Doubles& error) const {
    Doubles height = dot(n, corner[0]);
    for (int k = 1; k < x_.count; ++k) height = min(dot(n, corner[k]), height);
    return height >= near_.distance - error;
  }

  /// Sets the distance of each pair that is nearer than it at t = 0.
  FCL_CCD_INLINE void ignoreInitiallyCloser(const Tolerances& tolerance) {
    constexpr double kShare = DistanceTolerance::kShare;
    const DoubleMask is_closer = reached_ <= d_ * all(1 + kShare) + tolerance.touching;
    const Doubles less = reached_ * all(1 - 2 * kShare) - all(2) * tolerance.touching;
    d_ = select(is_closer, less, d_);
    // They touch.
    open_ |= ~bits(d_ > all(0));
  }

  std::size_t count_, number_[kEight];
  Polygons x_;
  PointOrders orders_;
  Doubles d_, t_, rate_, reached_;
  NearestPoints near_;
  DoubleMask is_contact_;
  unsigned open_, left_;
};

/// Takes the steps of some eights in turn: each number of a step depends on the one
/// before, so that a processor would wait for them if it had only one eight to work on.
/// When fewer eights would do for the pairs that are left, these are put together.
void approach(ContinuousContactKind kind, const FourPoints* pairs, std::size_t count,
              const DistanceRequest& request, Approach* answers) {
  assert(1 <= count && count <= kMostApproaching && request.distance >= 0);
  AdvancingPairs eights[kMostApproaching / kEight];
  PairOnWay on_way[kMostApproaching];
  for (std::size_t i = 0; i < count; ++i) on_way[i] = {i, 0, 0, request.distance};
  const auto eightsFor = [](std::size_t n) { return (n + kEight - 1) / kEight; };
  int step = 0;
  for (std::size_t num_pairs = count; num_pairs > 0;) {
    const std::size_t size = eightsFor(num_pairs);
    std::size_t open[kMostApproaching / kEight], num_open = size;
    for (std::size_t i = 0; i < size; ++i) {
      open[i] = i;
      eights[i].begin(kind, pairs, on_way + kEight * i,
                      std::min(kEight, num_pairs - kEight * i));
    }
    // To begin again takes about half a step of each eight, so it pays when a quarter of
    // the eights is saved for two steps or more.
    while (num_open > 0 && 4 * eightsFor(num_pairs) > 3 * num_open) {
      std::size_t still_open = 0;
      num_pairs = 0;
      for (std::size_t i = 0; i < num_open; ++i) {
        const std::size_t eight = open[i];
        const unsigned left = eights[eight].advance(step, request);
        num_pairs += static_cast<unsigned>(countBits(left));
        // There is no branch, since it would be unpredictable.
        open[still_open] = eight;
        still_open += left != 0;
      }
      num_open = still_open;
      ++step;
    }
    PairOnWay* end = on_way;
    for (std::size_t i = 0; i < size; ++i)
      end = eights[i].takeAnswers(request, answers, end);
    assert(end == on_way + num_pairs);
  }
}

/// Eight DifferencePolygons at t = 0.
struct StartPolygons {
  Vectors corner[4];
  int count;

  FCL_CCD_INLINE StartPolygons(ContinuousContactKind kind, const StartPoints& x)
      : count(kind == ContinuousContactKind::kVertexFace ? 3 : 4) {
    for (int k = 0; k < count; ++k) {
      const CornerPoints p = DifferencePolygon::pointsOf(kind, k);
      corner[k] = x.t0[p.second] - x.t0[p.first];
    }
  }

  FCL_CCD_INLINE int next(int k) const { return k + 1 < count ? k + 1 : 0; }
};

/// The first step of approach(), without the sizes of the pairs: a distance of at
/// most d is a contact whatever the tolerance is. With the direction of the nearest point
/// a gap above `cull_distance` proves that there is none: cullDistanceOf() is larger than
/// a distance with its tolerances by more than the rounding of this, 16 u of the largest
/// length.
unsigned approachAtStart(ContinuousContactKind kind, const TrianglePair* pairs,
                         const std::uint32_t* codes, std::size_t count, double distance,
                         double cull_distance, Approach (&answers)[8]) {
  assert(1 <= count && count <= kEight && distance > 0x1p-150);
  assert(distance <= cull_distance && cull_distance < 0x1p150);
  // Copies of the last pair fill the empty lanes.
  std::uint32_t eight_codes[kEight];
  for (std::size_t lane = 0; lane < kEight; ++lane)
    eight_codes[lane] = codes[lane < count ? lane : count - 1];
  StartPoints points{EightFeatures(pairs, eight_codes)};
  const PointOrders orders(kind, points);
  const StartPolygons x(kind, points);
  const NearestPoints near = nearestPoints(x, x.corner);
  const Doubles least = near.distance * all(cull_distance);
  // A distance whose square is in range.
  DoubleMask is_far = near.square > all(0x1p-900);
  for (int k = 0; k < x.count; ++k)
    is_far = is_far & (dot(near.point, x.corner[k]) > least);
  const unsigned left = ((1U << count) - 1) & ~bits(is_far),
                 is_near = bits(near.is_sure & (near.distance <= all(distance))) &
                           ~orders.unknown();
  double part[kEight];
  store(near.part, part);
  for (unsigned lanes = left; lanes != 0; lanes &= lanes - 1) {
    const auto lane = static_cast<std::size_t>(lowestBit(lanes));
    Approach& out = answers[lane];
    out.answer = is_near >> lane & 1U ? Approach::Answer::kYes : Approach::Answer::kOpen;
    out.exchanges = static_cast<std::uint8_t>(orders.exchanges(lane));
    out.part = static_cast<std::uint8_t>(part[lane]);
    out.toc_lo = out.toc_hi = 0;
  }
  return left;
}

/// The first attempt of leastDistance(), if it is enough.
unsigned leastDistances(const EightPoints& pairs, double (&least)[8]) {
  assert(pairs.kind == ContinuousContactKind::kVertexFace ||
         pairs.kind == ContinuousContactKind::kEdgeEdge);
  const Points points(pairs);
  const Polygons x(pairs.kind, points.t1, points.t1);
  const NearestPoints near = nearestPoints(x, x.t1);
  const Vectors n = directionsApart(near, NearestSides(x, x.t1, near));
  Doubles gap = dot(n, x.t1[0]);
  for (int k = 1; k < x.count; ++k) gap = min(dot(n, x.t1[k]), gap);
  store(max(gap * all(1 - LeastDistance::kOfGap) - all(LeastDistance::kOfSize) * x.size,
            all(0)),
        least);
  assert(*std::min_element(least, least + kEight) >= 0);
  return bits(near.is_sure & (gap > all(LeastDistance::kEnough) * near.distance) &
              (x.size >= all(Advance::kLeastSize)) & (x.size <= all(Advance::kMostSize)));
}

}  // namespace HWY_NAMESPACE
}  // namespace deformable
}  // namespace detail
}  // namespace fcl
HWY_AFTER_NAMESPACE();
