// SPDX-License-Identifier: BSD-3-Clause
#include "advance/convex_advance.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "advance/advancement.h"
#include "numerics/error_bounds.h"
#include "paths/posed_vector.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

double accelerationOf(const AccelerationBound& bound, const MovingConvex& set) {
  if (bound.isZero() && bound.per_displacement == 0) return 0;
  if (!set.shape) return accelerationOf(bound, set.triangle);
  const double radius = set.shape->flat() ? 0 : set.shape->box().radius;
  return bound.of(set.shape->center(), radius) * kUpward;
}

/// How far a point of the set moves in the frame of its body.
double displacementOf(const MovingConvex& set) {
  double most = 0;
  for (int i = 0; i < 3 && !set.shape; ++i)
    most = std::max(most, norm(set.triangle.corner[1][i] - set.triangle.corner[0][i]));
  return most;
}

/// 256 u of the size of the paths and of the points, in units of the position error,
/// which is at least 48 u of it: what axisAcceleration() rounds by.
constexpr double kAxisRoundings = 6;

int flatOf(const MovingConvex& a, const MovingConvex& b) {
  if (a.shape && a.shape->flat()) return 0;
  return b.shape && b.shape->flat() ? 1 : -1;
}

/// What is farthest along a direction: a point, the corners of a triangle that are as far
/// up to a tolerance, and the middle of these.
struct Extreme {
  Vec point, middle;
  unsigned corners;
};

Extreme extremeOf(const PosedConvex& set, const Vec& direction, double tolerance) {
  assert(!(tolerance < 0));
  int id;
  Extreme out{set.support(direction, id), {0, 0, 0}, 0};
  if (set.shape) {
    out.middle = out.point;
    return out;
  }
  int count = 0;
  const auto isRepeated = [&set](int k) {
    // Corners of a free edge or point (MeshTriangle).
    return std::any_of(set.corner, set.corner + k, [&](const Vec& other) {
      return maxNorm(other - set.corner[k]) == 0;
    });
  };
  for (int k = 0; k < 3; ++k) {
    if (dot(direction, out.point - set.corner[k]) > tolerance || isRepeated(k)) continue;
    out.middle = out.middle + set.corner[k];
    out.corners |= 1U << k;
    ++count;
  }
  // The farthest corner is one of them, or an equal one before it.
  assert(count > 0);
  out.middle = (1. / count) * out.middle;
  return out;
}

}  // namespace

MovingConvex movingConvexOf(const MovingBody& body, std::int32_t place) {
  MovingConvex out{&body.path(), body.shape(), {}, body.speed()};
  if (body.shape() && body.shape()->flat())
    out.speed = body.path().speed(norm(body.shape()->flat()->foot()) * kUpward);
  if (body.isMesh()) out.triangle = body.triangle(place);
  if (!body.octree()) return out;
  out.shape = &body.octree()->cell(place);
  const Vec center = out.shape->center();
  const double far = std::sqrt(dot(center, center)) + out.shape->box().radius;
  out.speed = std::min(out.speed, body.path().speed(far * kUpward));
  assert(!(out.speed < 0));
  return out;
}

ConvexAdvance::ConvexAdvance(const MovingConvex& a, const MovingConvex& b, double t0,
                             double t1, const BodyTolerance& tolerance)
    : set_{&a, &b},
      flat_(flatOf(a, b)),
      t1_(t1),
      tolerance_(tolerance),
      path_acceleration_{a.path->acceleration(t0, t1), b.path->acceleration(t0, t1)},
      set_acceleration_{accelerationOf(path_acceleration_[0], a),
                        accelerationOf(path_acceleration_[1], b)},
      acceleration_(set_acceleration_[0] + set_acceleration_[1]) {
  assert(a.shape || b.shape);
  assert(!(a.shape && a.shape->flat()) || !(b.shape && b.shape->flat()));
  assert(isPartOfStep(t0, t1) && !(acceleration_ < 0) && !(tolerance.distance < 0));
  for (int k = 0; k < 2; ++k)
    axis_acceleration_[k] =
        set_[k]->path->axis()
            ? set_[k]->path->axisAcceleration(displacementOf(*set_[k])) +
                  kAxisRoundings * tolerance_.position
            : 0;
}

void ConvexAdvance::ignoreInitiallyCloser() {
  const Moment now = momentAt(0);
  const ConvexGap gap = gapOf(now, 0);
  if (gap.distance > tolerance_.distance + tolerance_.touching) return;
  const double own =
      (gap.gap / growthOfNormal(now) - tolerance_.radii) * (1 - kNearerShare) -
      2 * tolerance_.touching;
  assert(!(tolerance_.radii + own > tolerance_.distance));
  if (own > 0) tolerance_.distance = tolerance_.radii + own;
}

PosedConvex ConvexAdvance::setAt(int k, double t) const {
  assert(isTimeOfStep(t));
  const MovingConvex& set = *set_[k];
  PosedConvex out{set.shape, nullptr, set.path->pose(t), {}};
  for (int i = 0; i < 3 && !set.shape; ++i)
    out.corner[i] =
        posed(out.pose, set.triangle.corner[0][i], set.triangle.corner[1][i], t);
  return out;
}

ConvexAdvance::Side ConvexAdvance::sideAt(int k, double t, const Moment& now) const {
  const MovingConvex& set = *set_[k];
  Side side{now.set[k], set.path->rate(t), {}};
  for (int i = 0; i < 3 && !set.shape; ++i)
    side.velocity[i] = posedVertex(side.now.pose, side.rate, set.triangle.corner[0][i],
                                   set.triangle.corner[1][i], t)
                           .velocity;
  return side;
}

double ConvexAdvance::Side::reachAfter(double h, const Vec& n, const Vec& change) const {
  assert(!(h < 0));
  if (!now.shape) {
    double most = -HUGE_VAL;
    for (int i = 0; i < 3; ++i)
      most = std::max(most, dot(n, now.corner[i]) +
                                h * (dot(n, velocity[i]) + dot(change, now.corner[i])));
    return most;
  }
  if (now.shape->flat()) {
    const MovingPoint foot = posedPoint(now.pose, rate, now.shape->flat()->foot());
    return dot(n, foot.position) +
           h * (dot(n, foot.velocity) + dot(change, foot.position));
  }
  // As n . (R x + T) + h (n . (R' x + T') + n' . (R x + T)) for all points x of the core.
  const Vec later = n + h * change;
  const double(&r)[9] = now.pose.rotation;
  const double(&v)[9] = rate.rotation;
  double turned[3];
  for (int k = 0; k < 3; ++k)
    turned[k] = r[k] * later.x + r[3 + k] * later.y + r[6 + k] * later.z +
                h * (v[k] * n.x + v[3 + k] * n.y + v[6 + k] * n.z);
  return now.shape->reach({turned[0], turned[1], turned[2]}) +
         dot(later, vecOf(now.pose.translation)) + h * dot(n, vecOf(rate.translation));
}

ConvexAdvance::Line ConvexAdvance::Side::farthestAfter(double h, const Vec& n,
                                                       const Vec& change) const {
  assert(!(h < 0));
  if (!now.shape) {
    Line best{}, line{};
    double most = -HUGE_VAL;
    for (int i = 0; i < 3; ++i) {
      line = {dot(n, now.corner[i]), dot(n, velocity[i]) + dot(change, now.corner[i])};
      if (!(line.value + h * line.rate > most)) continue;
      most = line.value + h * line.rate;
      best = line;
    }
    return best;
  }
  const Vec point =
      now.shape->flat()
          ? now.shape->flat()->foot()
          : now.shape->support(rotatedBack(now.pose.rotation, n + h * change) +
                               h * rotatedBack(rate.rotation, n));
  const MovingPoint at = posedPoint(now.pose, rate, point);
  return {dot(n, at.position), dot(n, at.velocity) + dot(change, at.position)};
}

MovingPoint ConvexAdvance::Side::cornerOf(int piece) const {
  if (!now.shape) return {now.corner[piece], velocity[piece]};
  return posedPoint(now.pose, rate, now.shape->supportOf(piece, {0, 0, 0}));
}

Vec ConvexAdvance::Moment::center(int k) const {
  const PosedConvex& of = set[k];
  if (of.shape) return posed(of.pose, of.shape->center());
  return (1. / 3) * (of.corner[0] + of.corner[1] + of.corner[2]);
}

double ConvexAdvance::Side::size() const {
  if (now.shape) return now.shape->flat() ? 0 : 2 * now.shape->box().radius;
  double square = 0;
  for (int i = 0; i < 3; ++i) {
    const Vec edge = now.corner[(i + 1) % 3] - now.corner[i];
    square = std::max(square, dot(edge, edge));
  }
  return std::sqrt(square);
}

ConvexAdvance::Separator ConvexAdvance::inWorld(const Vec& direction) const {
  return {direction, {0, 0, 0}, accelerationAlong(direction), margin(1), 1};
}

/// Bound on the acceleration of two points to each other along a direction. That of a
/// turn is at right angles to its axis.
double ConvexAdvance::accelerationAlong(const Vec& direction) const {
  double most = 0;
  for (int k = 0; k < 2; ++k) {
    const Vec* const axis = set_[k]->path->axis();
    const double share = axis ? norm(cross(direction, *axis)) + 0x1p-48 : 1;
    most += std::min(set_acceleration_[k],
                     share * set_acceleration_[k] + axis_acceleration_[k]);
  }
  return most * kUpward;
}

/// A matrix that is no rotation changes the length of the normal of a flat. How much
/// longer than now it may become.
double ConvexAdvance::growthOfNormal(const Moment& now) const {
  if (flat_ < 0 || set_[flat_]->path->isTranslation()) return 1;
  const PosedConvex& flat = now.set[flat_];
  const MotionPath& path = *set_[flat_]->path;
  const double length = norm(rotated(flat.pose.rotation, flat.shape->flat()->normal));
  assert(!(length > path.stretch() * kUpward + path.rotationError()));
  return path.stretch() / length;
}

// The direction is n(t) = R(t) m with m = R(t0)^T n. For two points with the difference z
// the second derivative of n . z is n . z'' + 2 n' . z' + n'' . z, and r times the norm
// of R'' is at most the bound on the acceleration of points within r of the origin.
//
// The length of R x is at most s |x|, s the stretch of R, so that |m| <= s and |n(t)| <=
// s^2; and n' and n'' are bounded by |m|.
//
// A flat is the plane through its foot with the normal n(t), where m is parallel to that
// in the body frame and n(t0) a unit vector. So its foot stands for all of its points.
// The height n . z is at most |n| times the distance.
ConvexAdvance::Separator ConvexAdvance::inBody(int k, double t, const State& state,
                                               const ConvexGap& gap) const {
  assert(flat_ < 0 || k == flat_);
  const MotionPath& path = *set_[k]->path;
  const double(&r)[9] = state.side[k].now.pose.rotation;
  const double(&v)[9] = state.side[k].rate.rotation;
  const Vec& n = gap.direction;
  Vec m = rotatedBack(r, n);
  double length = path.stretch();
  if (flat_ >= 0) {
    const Vec& normal = set_[k]->shape->flat()->normal;
    length = 1 / norm(rotated(r, normal));
    m = (dot(m, normal) < 0 ? -length : length) * normal;
  }
  const double longest = std::max(path.stretch(), 1.) * length, turn = path.turnSpeed(),
               speed = set_[0]->speed + set_[1]->speed;
  double apart = std::max(gap.distance, gap.gap);
  if (flat_ >= 0) apart = norm(state.now.center(1) - state.now.center(0));
  apart += speed * (t1_ - t);
  for (int side = 0; side < 2; ++side)
    apart += state.side[side].size() * set_[side]->path->stretch();
  const double turning =
      2 * turn * speed + path_acceleration_[k].of({0, 0, 0}, apart * kUpward);
  return {rotated(r, m), rotated(v, m), (acceleration_ + turning) * longest * kUpward,
          flat_ >= 0 ? margin(growthOfNormal(state.now)) : margin(1) * longest * kUpward,
          0.5 / turn};
}

/// The gap of the cores along a direction, `h` later, at least. It is concave in h, since
/// a support function is convex.
double ConvexAdvance::gapAfter(double h, const State& state,
                               const Separator& along) const {
  return -state.side[1].reachAfter(h, -1. * along.direction, -1. * along.change) -
         state.side[0].reachAfter(h, along.direction, along.change) - along.margin -
         h * tolerance_.rate - 0.5 * along.acceleration * h * h;
}

/// The time at which the two points that are nearest along the direction after `h` have
/// no gap any more. The sets have none then either.
double ConvexAdvance::endOfTangent(double h, const State& state,
                                   const Separator& along) const {
  const Line a = state.side[0].farthestAfter(h, along.direction, along.change),
             b = state.side[1].farthestAfter(h, -1. * along.direction,
                                             -1. * along.change);
  const double value = -(a.value + b.value) - along.margin,
               slope = -(a.rate + b.rate) - tolerance_.rate, bend = along.acceleration;
  if (!(value > 0)) return 0;
  const double root = std::sqrt(slope * slope + 2 * bend * value);
  // The root of the parabola, in the form that does not cancel.
  return slope > 0 ? (slope + root) / bend : 2 * value / (root - slope);
}

/// A step, at most to the end of the span, during which the direction separates the sets;
/// negative if it does not separate them now. A step that ends with a gap had one all the
/// time, since the gap is concave.
/// @param shorter  a step that is no longer than this one is of no use
double ConvexAdvance::step(double t, const State& state, const Separator& along,
                           double shorter) const {
  const double longest = std::min(t1_ - t, along.longest);
  assert(!(longest < 0) && !(along.margin < 0) && !(along.acceleration < 0));
  const double gap = gapAfter(0, state, along);
  if (!(gap > 0)) return -1;
  // Newton's method. Any two points of the sets have more gap than the sets, so that it
  // comes to the end of the gap from above. At that end the gap may be 0 and round to
  // less; half of the margin is for that.
  const double least = -0.5 * tolerance_.position;
  // From far above it halves the time in each round, then digits double.
  constexpr int kRounds = 40;
  double upper = HUGE_VAL, beyond = gap, at = 0;
  for (int round = 0; round < kRounds; ++round) {
    at = std::min(longest, endOfTangent(at, state, along));
    if (!(at > shorter)) return shorter;
    if (!(at < upper)) break;
    upper = at;
    beyond = gapAfter(upper, state, along);
    if (beyond >= (upper < longest ? least : 0)) return upper;
  }
  // The line between two values is below the gap, so that its root is a step that is too
  // short.
  const double chord = upper * (gap / (gap - beyond));
  assert(!(chord > upper * kUpward));
  return gapAfter(chord, state, along) >= least ? chord : 0;
}

/// A direction that turns with a body stays at right angles to its flat sides, so that a
/// large one does not shorten the step.
double ConvexAdvance::fixedStep(double t, const State& state,
                                const ConvexGap& gap) const {
  if (flat_ >= 0) return step(t, state, inBody(flat_, t, state, gap), -1);
  double best = step(t, state, inWorld(gap.direction), -1);
  bool follows_side = false;
  if (gap.nearest.count > 0 && best < t1_ - t) {
    const double following =
        step(t, state, turning(gap.direction, turnOfNearest(state, gap), t1_ - t), best);
    // Three corners are those of an edge of each set, or of a face and a corner: then it
    // is the normal of a flat side.
    follows_side = gap.nearest.count == 3 && following > best;
    best = std::max(best, following);
  }
  for (int k = 0; k < 2 && !follows_side; ++k) {
    if (best >= t1_ - t) return best;
    const bool is_ball = set_[k]->shape && set_[k]->shape->isBall();
    if (!is_ball && !set_[k]->path->isTranslation())
      best = std::max(best, step(t, state, inBody(k, t, state, gap), best));
  }
  return best;
}

/// The common normal of two edges turns with neither of their bodies. Along any fixed
/// direction the edges would come nearer in proportion to their length, so that they pass
/// each other at a small distance in short steps.
double ConvexAdvance::longestStep(double t, const State& state, const ConvexGap& gap) {
  // Sets that are still apart after these probably move along each other.
  constexpr int kPlainSteps = 32;
  const double best = fixedStep(t, state, gap);
  if (++num_steps_ <= kPlainSteps || flat_ >= 0 || gap.nearest.count > 0 ||
      best >= t1_ - t)
    return best;
  // Where it does not help it is tried more and more rarely.
  constexpr int kMostDoublings = 6;
  if (num_steps_ % (1 << std::min(num_in_vain_, kMostDoublings)) != 0) return best;
  const double turning = turningStep(t, state, gap);
  num_in_vain_ = turning > best ? 0 : num_in_vain_ + 1;
  return std::max(best, turning);
}

/// How fast the direction between the nearest corners, edges or faces turns. Their
/// differences are a corner, an edge or a face, to which it is at right angles.
Vec ConvexAdvance::turnOfNearest(const State& state, const ConvexGap& gap) const {
  Vec x[3], velocity[3];
  const NearestCorners& nearest = gap.nearest;
  for (int i = 0; i < nearest.count; ++i) {
    const MovingPoint a = state.side[0].cornerOf(nearest.corner[i][0]),
                      b = state.side[1].cornerOf(nearest.corner[i][1]);
    x[i] = b.position - a.position;
    velocity[i] = b.velocity - a.velocity;
  }
  if (nearest.count == 1) return (1 / norm(x[0])) * velocity[0];
  const Vec edge = x[1] - x[0], edge_rate = velocity[1] - velocity[0];
  if (nearest.count == 3) {
    const Vec other = x[2] - x[0], other_rate = velocity[2] - velocity[0],
              normal = cross(edge, other),
              change = cross(edge_rate, other) + cross(edge, other_rate);
    return ((dot(normal, gap.direction) < 0 ? -1 : 1) / norm(normal)) * change;
  }
  // Along the edge it follows the edge, across it the nearest point.
  const double square = dot(edge, edge), share = -dot(edge, x[0]) / square;
  const Vec across = cross(gap.direction, edge),
            near_velocity = velocity[0] + share * edge_rate;
  return (1 / square) *
         (-dot(gap.direction, edge_rate) * edge +
          (dot(near_velocity, across) / norm(x[0] + share * edge)) * across);
}

// The direction n + h m goes from the one at t to that at a later time, at which the sets
// are still apart, where m is at right angles to n and h |m| <= 1/2. For two points with
// the difference z
//   (n + h m) . z(t + h) >= (n + h m) . z + h n . z' - (2 |m| |z'| + 1.12 |z''|) h^2 / 2,
// and it proves a distance above d while this is more than
// d |n + h m| <= d (1 + h^2 |m|^2 / 2). Positions round by 1.5 of their error, since n .
// z and h m . z are products by themselves. The rate is multiplied by |n + h m| too.
ConvexAdvance::Separator ConvexAdvance::turning(const Vec& direction, const Vec& change,
                                                double longest) const {
  constexpr double kMostTurn = 0.5, kMostLength = 1.12;
  Separator along{direction, change - dot(direction, change) * direction, 0,
                  margin(1) + 0.5 * tolerance_.position, longest};
  const double turn_speed = norm(along.change) * kUpward;
  if (!(turn_speed < HUGE_VAL)) return inWorld(direction);
  along.acceleration =
      (kMostLength * acceleration_ +
       turn_speed * (2 * speed() + tolerance_.distance * turn_speed + tolerance_.rate)) *
      kUpward;
  along.longest = std::min(longest, kMostTurn / turn_speed);
  return along;
}

/// Along the direction to the nearest points of a later time.
double ConvexAdvance::turningStep(double t, const State& state, const ConvexGap& gap) {
  constexpr double kLonger = 4;
  constexpr int kAttempts = 4;
  const double longest = t1_ - t;
  const Vec& n = gap.direction;
  const Separator before = turning(n, turn_, longest);
  const double room = gapAfter(0, state, before);
  if (!(room > 0)) return -1;
  // They may be in contact at the end of the step that the bend alone would allow.
  double later = t;
  ConvexGap next{};
  horizon_ =
      std::min({longest, kLonger * horizon_, std::sqrt(2 * room / before.acceleration)});
  for (int attempt = 0; attempt < kAttempts && !(next.gap > margin(1)); ++attempt) {
    if (attempt > 0) horizon_ /= kLonger;
    later = std::min(t + horizon_, t1_);
    if (!(later > t)) return -1;
    const Moment there = momentAt(later);
    next = convexGap(there.set[0], there.set[1], n, margin(1), 0);
  }
  if (!(next.gap > margin(1))) return -1;
  turn_ = (1 / (later - t)) * (next.direction - n);
  return step(t, state, turning(n, turn_, longest), -1);
}

/// The gap along the normal of a flat. Points of the other set that are lowest, or
/// highest, up to rounding count as one feature.
ConvexGap ConvexAdvance::flatGap(const Moment& now) const {
  const PosedConvex &flat = now.set[flat_], &other = now.set[1 - flat_];
  const FlatShape& shape = *flat.shape->flat();
  const Vec normal = rotated(flat.pose.rotation, shape.normal),
            up = (1 / norm(normal)) * normal, foot = now.center(flat_);
  const Extreme low = extremeOf(other, -1. * up, tolerance_.position),
                high = extremeOf(other, up, tolerance_.position);
  const double lowest = dot(up, low.point - foot), highest = dot(up, high.point - foot);
  const bool is_below = !shape.is_solid && -highest > lowest;
  const Extreme& near = is_below ? high : low;
  ConvexGap out{};
  out.gap = is_below ? -highest : lowest;
  out.direction = is_below == (flat_ == 0) ? -1. * up : up;
  out.distance = std::max(out.gap, 0.);
  out.depth = std::max(shape.is_solid ? -lowest : std::min(-lowest, highest), 0.);
  Vec point = near.middle;
  unsigned corners = near.corners;
  if (!shape.is_solid && out.gap < 0) {
    // Points on both sides of the plane.
    assert(lowest < 0 && highest > 0);
    point = low.point + (-lowest / (highest - lowest)) * (high.point - low.point);
    corners = low.corners | high.corners;
  }
  out.point[1 - flat_] = point;
  out.point[flat_] = point - (is_below ? -out.distance : out.distance) * up;
  out.corners[1 - flat_] = corners;
  assert(isUnit(out.direction));
  return out;
}

/// The direction between the centers, or the suggested one if it shows a larger gap.
/// Newton's method needs a good one.
Vec ConvexAdvance::firstGuess(const Moment& now) const {
  const Vec way = now.center(1) - now.center(0);
  const bool is_curved = now.set[0].isCurved() || now.set[1].isCurved();
  if (!is_curved || !(maxNorm(suggested_) > 0)) return way;
  const auto gapAlong = [&now](const Vec& n) {
    return -now.set[1].reach(-1. * n) - now.set[0].reach(n);
  };
  const double length = norm(way);
  return length > 0 && gapAlong(way) > length * gapAlong(suggested_) ? way : suggested_;
}

ConvexGap ConvexAdvance::gapOf(const Moment& now, double contact) const {
  if (flat_ >= 0) return flatGap(now);
  const Vec guess = maxNorm(guess_) > 0 ? guess_ : firstGuess(now);
  return convexGap(now.set[0], now.set[1], guess, margin(1), contact, nearest_);
}

/// Each search ends where the distance is not above the gap by more than a tenth of what
/// it was before.
ConvexGap ConvexAdvance::nearestAt(double t, double error) const {
  constexpr int kMostSearches = 16;
  assert(!(error < 0));
  constexpr double kShare = 0.9;
  const Moment now = momentAt(t);
  ConvexGap gap = gapOf(now, 0);
  double enough = margin(1);
  for (int i = 0; i < kMostSearches && flat_ < 0; ++i) {
    if (gap.depth > 0 || gap.distance - gap.gap <= error) break;
    const double more = gap.gap + kShare * (gap.distance - gap.gap);
    if (!(more > enough)) break;
    enough = more;
    gap = convexGap(now.set[0], now.set[1], gap.direction, enough, 0, gap.nearest);
  }
  return gap;
}

/// Prefers the direction of a flat side: where the gap is a few roundings wide another
/// one may happen to show as much.
ConvexGap ConvexAdvance::gapAt(double t) const {
  const Moment now = momentAt(t);
  ConvexGap gap = gapOf(now, 0);
  if (flat_ >= 0) return gap;
  for (const PosedConvex& set : now.set) {
    Vec n = set.flatNormal(gap.direction);
    const double length = norm(n);
    if (!(length > 0x1p-500) || !(gap.gap > 0)) continue;
    n = ((dot(n, gap.direction) < 0 ? -1 : 1) / length) * n;
    const double along = -now.set[1].reach(-1. * n) - now.set[0].reach(n);
    if (!(along >= gap.gap - tolerance_.position)) continue;
    gap.direction = n;
    gap.gap = along;
  }
  assert(isUnit(gap.direction) || maxNorm(gap.direction) == 0);
  return gap;
}

/// Of a flat, and of cores that are apart, the gap is the largest there is.
Penetration ConvexAdvance::penetrationAt(double t, const ConvexGap& gap) const {
  if (flat_ >= 0 || gap.gap > -tolerance_.touching) return {gap.direction, -gap.gap};
  const Moment now = momentAt(t);
  return penetrationOf(now.set[0], now.set[1]);
}

ConvexAdvance::Answer ConvexAdvance::advance(double& t, double t_stop, int& steps,
                                             AdvanceCounts& counts) {
  ConvexGap gap;
  return deformable::advance(
      t, t1_, t_stop, steps, counts, [this](double time) { return momentAt(time); },
      [this, &gap](const Moment& now) {
        const double contact = tolerance_.distance * growthOfNormal(now) +
                               tolerance_.touching - tolerance_.position;
        gap = gapOf(now, contact);
        return gap.distance <= contact;
      },
      [this, &gap](double time, const Moment& now) {
        guess_ = gap.direction;
        nearest_ = gap.nearest;
        return longestStep(time, stateAt(time, now), gap);
      });
}

double ConvexAdvance::proveContact(double t, double width) const {
  // A pair in contact that is not proved yet has to come nearer by three errors at least.
  constexpr double kLeastErrors = 3;
  const Moment now = momentAt(t);
  const State state = stateAt(t, now);
  const double closing = state.side[0].farthestAfter(0, guess_, {0, 0, 0}).rate +
                         state.side[1].farthestAfter(0, -1. * guess_, {0, 0, 0}).rate;
  return provedTimeAfter(t, width, tolerance_.position, speed(),
                         closing > 0 ? kLeastErrors * tolerance_.position / closing : 0,
                         [this](double time) { return provesContactAt(time); });
}

bool ConvexAdvance::provesContactAt(double t) const {
  const ConvexGap gap = gapOf(momentAt(t), 0);
  return gap.depth > 4 * tolerance_.position ||
         gap.distance + tolerance_.position <= tolerance_.distance;
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
