// SPDX-License-Identifier: BSD-3-Clause
#include "elementary/distance_advance.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "elementary/accurate_nearest.h"
#include "elementary/approach_speed.h"
#include "elementary/following_direction.h"
#include "elementary/most_steps.h"
#include "elementary/ordered_points.h"
#include "elementary/scaled_points.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// A pair whose points are in order.
struct OrderedPair : OrderedPoints<VertexPath> {
  FeaturePoints x;
  OrderedPair(ContinuousContactKind kind, const FeaturePoints& points,
              const PointIds& ids)
      : OrderedPoints(kind, points.point, ids),
        x{{point[0], point[1], point[2], point[3]}} {}
};

/// Until when a direction provably separates a pair.
struct Step {
  /// If this is not after the time at which the step begins, the direction proves
  /// nothing.
  double until;
  /// How fast the gap along the direction closes.
  double rate;
};

/// A direction that turns: n + tau * turn at the time t + tau.
struct TurningDirection {
  Vec n, turn;
};

/// The features of one query, as a polygon, and proofs that they are apart.
///
/// A fixed direction n: the corners are linear functions of t along n. A product with a
/// corner is off by 5 u L, and n is below 1 + 5 u: the margin needs 16 u (d + L).
///
/// A direction that turns, while it turns by less than its length: (n + tau m) . (c + tau
/// c') for each corner, at most d |n + tau m| <= d (1 + tau n . m + tau^2 m^2 / 2) (1 + 8
/// u) + rest, since the root of 1 + x is at most 1 + x / 2. The term with n . m is
/// rounding as a rule, but not in slivers, where m is a quotient by a small area. With c
/// 8 u L off and c', below 2 L, 4 u L off, the three coefficients are off by 11 u L, 24 u
/// L and 12 u L + 4 u d, if times tau. The root adds 8 u of each, 48 u L + 8 u d, the
/// length of the direction 12 u d, the time 4 u L: below 100 u (d + L).
///
/// A distance that becomes less at a speed s, with s times the rest of the step at most
/// d: along a fixed direction it is a linear function as well. The term of a direction
/// that turns is s tau |n + tau m| more, at least s tau (1 + tau n . m) (1 - 10 u).
/// Products with s round by less than 16 u s: the margin has 32 u s more.
class AdvancingPair {
 public:
  AdvancingPair(ContinuousContactKind kind, const FeaturePoints& x) : polygon_(kind, x) {
    for (int k = 0; k < polygon_.count(); ++k)
      velocities_[k] = polygon_.t1(k) - polygon_.t0(k);
  }

  double size() const { return polygon_.size(); }

  NearestPoint nearestAt(double t) {
    assert(0 <= t && t <= 1);
    for (int k = 0; k < polygon_.count(); ++k) corners_[k] = polygon_.at(k, t);
    return nearestPoint(polygon_, corners_);
  }

  /// The distance at t of the point that is nearest at another time: the pair is not
  /// further apart.
  double distanceOf(const NearestPoint& near, double t) const {
    const int first = std::max({near.corner, near.side, 0}), last = polygon_.count() - 1;
    const Vec p = polygon_.at(first, t);
    Vec point = p;
    if (near.side >= 0) {
      point = p + near.along * (polygon_.at(polygon_.next(first), t) - p);
    } else if (near.corner < 0) {
      point = p + near.along * (polygon_.at(1, t) - p) +
              near.across * (polygon_.at(last, t) - p);
    }
    return std::sqrt(dot(point, point));
  }

  Vec direction(const NearestPoint& near, int attempt) const {
    const Vec n = directionApart(polygon_, corners_, near, attempt);
    assert(isDirection(n));
    return n;
  }

  NearestPoint sureNearest(const NearestPoint& near, double error) const {
    return deformable::sureNearest(polygon_, corners_, near, error);
  }

  AccurateNearest accurate() const { return accurateNearest(polygon_, corners_); }

  /// A distance at a time, and that plus the margin. Both become less at this speed.
  struct Apart {
    double d, least, speed;
  };

  /// How fast the distance becomes less.
  double closingSpeed(const NearestPoint& near) const {
    const int first = std::max({near.corner, near.side, 0}), last = polygon_.count() - 1;
    const Vec& p = velocities_[first];
    Vec velocity = p;
    if (near.side >= 0) {
      velocity = p + near.along * (velocities_[polygon_.next(first)] - p);
    } else if (near.corner < 0) {
      velocity =
          p + near.along * (velocities_[1] - p) + near.across * (velocities_[last] - p);
    }
    return -dot(near.point, velocity) / near.distance;
  }

  /// The longest step that a direction of the nearest points proves.
  Step longestStep(const NearestPoint& near, const Apart& apart, double t,
                   double t_max) const {
    Step best{t, 0};
    for (int attempt = 0; attempt < kDirectionAttempts; ++attempt) {
      best = longerStep(near, direction(near, attempt), apart, t, t_max);
      if (best.until > t) return best;
    }
    return best;
  }

  /// The same for a direction that was found with twice the digits.
  Step accurateStep(const AccurateNearest& nearest, const Apart& apart, double t,
                    double t_max) const {
    const Step step = longerStep(nearest.near, nearest.direction, apart, t, t_max);
    if (step.until > t_max) return step;
    // A little more than the rest, so that it is behind t_max if all of it is proved.
    const double rest = (t_max - t) * (1 + 0x1p-40) + 0x1p-1000,
                 longest = followingStep(polygon_, corners_, velocities_, nearest, size(),
                                         apart.least, rest);
    assert(0 <= longest && longest <= rest);
    if (longest == rest) return {kInfinity, 0};
    const double until = (t + longest) * Advance::kDown;
    return until > step.until ? Step{until, step.rate} : step;
  }

 private:
  /// The longer one of the steps that a direction proves, fixed or while it turns.
  Step longerStep(const NearestPoint& near, const Vec& n, const Apart& apart, double t,
                  double t_max) const {
    const Step fixed = fixedStep(n, apart, t);
    if (fixed.until > t_max) return fixed;
    const Step turned =
        turningStep({n, turnApart(polygon_, corners_, velocities_, near, n)}, apart, t);
    return turned.until > fixed.until ? turned : fixed;
  }

  Step fixedStep(const Vec& n, const Apart& apart, double t) const {
    const double least_t0 = apart.least + apart.speed * t,
                 least_t1 = apart.least - apart.speed * (1 - t);
    Step step{kInfinity, 0};
    for (int k = 0; k < polygon_.count(); ++k) {
      const double a = dot(n, polygon_.t0(k)) - least_t0,
                   b = dot(n, polygon_.t1(k)) - least_t1;
      if (a > 0 && b > 0) continue;
      if (!(a > 0) && !(b > 0)) return {-kInfinity, 0};
      const double at = a / (a - b);
      if (!(a > 0)) {
        if (!(at * Advance::kUp <= t)) return {-kInfinity, 0};
      } else if (at * Advance::kDown < step.until) {
        step = {at * Advance::kDown, a - b};
      }
    }
    return step;
  }

  /// The same for a direction that turns, from the time of nearestAt() on.
  Step turningStep(const TurningDirection& direction, const Apart& apart,
                   double t) const {
    const auto& [n, turn] = direction;
    const double square = dot(turn, turn);
    // While it turns by less than its length.
    double longest = 1 / std::sqrt(square), rate = 0;
    const double along = dot(n, turn);
    if (!(longest > 0)) return {-kInfinity, 0};
    for (int k = 0; k < polygon_.count(); ++k) {
      const Vec c = corners_[k], change = velocities_[k];
      const double gap = dot(n, c) - apart.least,
                   closing =
                       dot(n, change) + dot(turn, c) - apart.d * along + apart.speed,
                   bend =
                       dot(turn, change) - 0.5 * apart.d * square + apart.speed * along;
      if (!(gap > 0)) return {-kInfinity, 0};
      const double root = firstRoot(gap, closing, bend);
      assert(!(root < 0));
      if (root < longest) {
        longest = root;
        rate = -closing;
      }
    }
    return {t + longest * Advance::kDown, rate};
  }

  DifferencePolygon polygon_;
  Vec corners_[DifferencePolygon::kMaxCorners];
  Vec velocities_[DifferencePolygon::kMaxCorners];
};

/// A time in (t, t + width] at which the features provably are within d; t if none is
/// found.
/// @param near  at t, above d
double proveWithin(AdvancingPair& pair, const DistanceTolerance& tolerance, double d,
                   double t, double width, const NearestPoint& near, double rate) {
  if (!(width > 0) || !(rate > 0)) return t;
  const double gap = near.distance + tolerance.distance_error - d;
  const auto isWithin = [&](double distance) {
    return distance + tolerance.distance_error <= d;
  };
  for (double first = Advance::kFirstGuess * gap / rate, h = first;;
       h *= Advance::kFactor) {
    double time = t + std::min(h, width);
    if (time - t > width) time = std::nextafter(time, t);
    // The points that are nearest at t are a proof as a rule, and quicker to follow.
    if (time > t && ((h == first && isWithin(pair.distanceOf(near, time))) ||
                     isWithin(pair.nearestAt(time).distance)))
      return time;
    if (!(h < width)) return t;
  }
}

/// After this number of steps the features are taken to slide along each other at nearly
/// the distance d. Then each step is made as long as it can be, and a contact may be
/// further away by a share of d. A graze needs fewer steps: each takes a quarter of the
/// gap, so that 24 take it from 1 to 2^-46.
constexpr int kPlainSteps = 64;

/// Takes the bracket from what is known at the time t.
void setBracket(AdvancingPair& pair, const DistanceTolerance& tolerance,
                const DistanceRequest& request, double d, double t,
                const NearestPoint& near, double rate, DistanceContact& out) {
  out.is_contact = true;
  out.toc_lo = out.toc_hi = t;
  if (t == 0 || near.distance + tolerance.distance_error <= d) return;
  const double width =
      std::min(std::min(request.toc_err, Advance::kShareOfTime * t), request.t_max - t);
  out.toc_hi = proveWithin(pair, tolerance, d, t, width, near, rate);
  assert(t <= out.toc_hi && out.toc_hi <= request.t_max);
  assert(out.toc_hi - out.toc_lo <= request.toc_err);
}

/// The advancement of a pair, from the time 0 on.
class Advancement {
 public:
  Advancement(ContinuousContactKind kind, AdvancingPair& pair, const int (&number)[4],
              const DistanceRequest& request, double min_approach_speed)
      : kind_(kind),
        pair_(pair),
        number_(number),
        request_(request),
        min_approach_speed_(min_approach_speed),
        t_stop_(std::min(request.t_max, request.t_stop)),
        d_(request.distance),
        tolerance_(d_, pair.size()) {
    assert(d_ >= 0 && request.toc_err > 0 && min_approach_speed >= 0);
    assert(0 <= t_stop_ && t_stop_ <= 1 && request.t_max <= 1);
  }

  DistanceContact run() {
    for (;; ++out_.steps) {
      near_ = pair_.nearestAt(t_);
      if (out_.steps == 0 && request_.ignores_initially_closer && areTouching()) {
        // They may pass through each other without coming nearer.
        d_ = request_.distance;
        return contact();
      }
      if (isApartAgain()) endLeavingOut();
      if (isNear() && !leavesOut()) return contact();
      const AdvancingPair::Apart apart = this->apart();
      Step step = pair_.longestStep(near_, apart, t_, t_stop_);
      if (!(step.until > t_) || (out_.steps >= kPlainSteps && !(step.until > t_stop_))) {
        const AccurateNearest nearest = pair_.accurate();
        near_ = nearest.near;
        if (isNear()) {
          if (!leavesOut()) return contact();
          continue;
        }
        const Step accurate = pair_.accurateStep(nearest, apart, t_, t_stop_);
        if (accurate.until > step.until) step = accurate;
      }
      if (step.until > t_stop_) return out_;
      if (!(step.until > t_) || out_.steps == kMostSteps) {
        out_.is_given_up =
            reached() > d_ + (DistanceTolerance::kShare * d_ + tolerance_.touching);
        return contact();
      }
      d_ -= speed_ * (step.until - t_);
      t_ = step.until;
      rate_ = step.rate;
      assert(isWithinStep());
    }
  }

 private:
  double reached() const { return near_.distance + tolerance_.distance_error; }

  /// Whether the pair is in contact, if it approaches.
  bool isNear() const {
    const double share = out_.steps < kPlainSteps ? 0 : DistanceTolerance::kShare;
    return reached() <= d_ + (share * d_ + tolerance_.touching);
  }

  AdvancingPair::Apart apart() const {
    assert(speed_ >= 0);
    return {d_, d_ + tolerance_.margin + 32 * kUnit * speed_, speed_};
  }

  /// A distance that is less than that of the pair by more than the tolerance.
  double lessThanReached() const {
    return reached() * (1 - 2 * DistanceTolerance::kShare) - 2 * tolerance_.touching;
  }

  /// A pair that comes near and approaches slowly is no contact. From here on it is one
  /// where it comes nearer than a distance that becomes less at the least speed of
  /// approach. So the distance proves what the speed at this time does not: that of
  /// nearest points that are not unique, and that of later times. It stays above 0 until
  /// the end of the step.
  /// @return whether the pair is left out at this time
  bool leavesOut() {
    if (!(min_approach_speed_ > 0) || speed_ > 0) return false;
    near_ = pair_.sureNearest(near_, tolerance_.distance_error);
    const double least = lessThanReached();
    if (!(least > 0)) return false;
    const double speed = std::min(min_approach_speed_, least / (1 - t_));
    if (!(pair_.closingSpeed(near_) <= speed)) return false;
    assert(least < d_ && speed > 0);
    kept_d_ = d_;
    d_ = least;
    speed_ = speed;
    return true;
  }

  /// Whether a pair that is left out is further apart than the wanted distance.
  bool isApartAgain() {
    const auto isApart = [this] { return lessThanReached() > kept_d_; };
    if (!(speed_ > 0) || !isApart()) return false;
    near_ = pair_.sureNearest(near_, tolerance_.distance_error);
    return isApart();
  }

  void endLeavingOut() {
    d_ = kept_d_;
    speed_ = 0;
  }

  /// Takes the distance at t = 0, less the tolerance, as that of a pair that is nearer
  /// than the wanted one then. Otherwise each such pair would be a contact at t = 0.
  /// @return whether nothing is left
  bool areTouching() {
    near_ = pair_.sureNearest(near_, tolerance_.distance_error);
    if (reached() > d_ * (1 + DistanceTolerance::kShare) + tolerance_.touching)
      return false;
    d_ = lessThanReached();
    if (!(d_ > 0)) return true;
    tolerance_ = DistanceTolerance(d_, pair_.size());
    return false;
  }

  /// Whether the distance of a pair that is left out stays above 0, up to rounding.
  bool isWithinStep() const {
    const double share = DistanceTolerance::kShare * request_.distance;
    return t_ <= t_stop_ && d_ > -(share + tolerance_.touching);
  }

  DistanceContact contact() {
    // sureNearest() may replace the point by one that is off by the error.
    assert(out_.is_given_up ||
           near_.distance <=
               (d_ + (DistanceTolerance::kShare * d_ + tolerance_.touching)) * kUpward +
                   tolerance_.distance_error);
    setPart(kind_, near_, number_, out_);
    setBracket(pair_, tolerance_, request_, d_, t_, near_, rate_, out_);
    return out_;
  }

  ContinuousContactKind kind_;
  AdvancingPair& pair_;
  const int (&number_)[4];
  const DistanceRequest& request_;
  double min_approach_speed_;
  double t_stop_;
  double d_, t_{0}, rate_{0};
  /// While a pair is left out: how fast d_ becomes less, and what it was before.
  double speed_{0}, kept_d_{0};
  DistanceTolerance tolerance_;
  NearestPoint near_;
  DistanceContact out_;
};

/// The same for a pair whose size is extreme.
DistanceContact advanceScaled(ContinuousContactKind kind, const OrderedPair& ordered,
                              const DistanceRequest& request, double min_approach_speed) {
  const ScaledPoints scaled(kind, ordered.x, request.distance);
  DistanceRequest scaled_request = request;
  scaled_request.distance *= scaled.scale();
  AdvancingPair pair(kind, scaled.points());
  return Advancement(kind, pair, ordered.number, scaled_request,
                     min_approach_speed * scaled.scale())
      .run();
}

/// Where the nearest point of a pair of edges is on the first one, as a fraction.
double placeOnFirstEdge(const NearestPoint& near) {
  if (near.corner >= 0) return near.corner < 2 ? 0 : 1;
  switch (near.side) {
    case 0:
      return 0;
    case 1:
      return near.along;
    case 2:
      return 1;
    case 3:
      return 1 - near.along;
    default:
      return near.across;
  }
}

/// The middle of the nearest points at t and the direction between them.
/// @param pair  of the ordered points times the scale
void describeApproach(ContinuousContactKind kind, const OrderedPair& ordered,
                      AdvancingPair& pair, double scale, double t, double (&position)[3],
                      double (&normal)[3]) {
  const NearestPoint near = pair.nearestAt(t);
  const double s = kind == ContinuousContactKind::kEdgeEdge ? placeOnFirstEdge(near) : 0;
  assert(0 <= s && s <= 1);
  const double way[3] = {near.point.x, near.point.y, near.point.z};
  const auto at = [&](int i, int k) {
    return (1 - t) * ordered.x[i].t0[k] + t * ordered.x[i].t1[k];
  };
  for (int k = 0; k < 3; ++k) {
    const double on_first = s > 0 ? (1 - s) * at(0, k) + s * at(1, k) : at(0, k);
    position[k] = on_first + 0.5 * (way[k] / scale);
  }
  Vec n = near.distance > 0 ? pair.direction(near, 1) : Vec{0, 0, 0};
  const int num_first = kind == ContinuousContactKind::kEdgeEdge ? 2 : 1;
  if (ordered.number[0] >= num_first) n = -1. * n;
  normal[0] = n.x;
  normal[1] = n.y;
  normal[2] = n.z;
}

}  // namespace

DistanceContact advanceToApproach(ContinuousContactKind kind, const FeaturePoints& x,
                                  const DistanceRequest& request,
                                  double min_approach_speed, const PointIds& ids) {
  const OrderedPair ordered(kind, x, ids);
  AdvancingPair pair(kind, ordered.x);
  const double size = std::max(pair.size(), request.distance);
  if (size >= Advance::kLeastSize && size <= Advance::kMostSize)
    return Advancement(kind, pair, ordered.number, request, min_approach_speed).run();
  return advanceScaled(kind, ordered, request, min_approach_speed);
}

DistanceContact advanceToDistance(ContinuousContactKind kind, const FeaturePoints& x,
                                  const DistanceRequest& request, const PointIds& ids) {
  return advanceToApproach(kind, x, request, 0, ids);
}

void distanceGeometry(ContinuousContactKind kind, const FeaturePoints& x, double t,
                      double (&position)[3], double (&normal)[3]) {
  const OrderedPair ordered(kind, x, {});
  AdvancingPair plain(kind, ordered.x);
  if (plain.size() >= Advance::kLeastSize && plain.size() <= Advance::kMostSize) {
    describeApproach(kind, ordered, plain, 1, t, position, normal);
    return;
  }
  const ScaledPoints scaled(kind, ordered.x, 0);
  AdvancingPair pair(kind, scaled.points());
  describeApproach(kind, ordered, pair, scaled.scale(), t, position, normal);
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
