// SPDX-License-Identifier: BSD-3-Clause
//
// The exact path has the quaternions of the waypoints, as computed from their matrices,
// and the velocities at the waypoints, as computed: with these it is continuous, and so
// is its velocity. The chain of a piece differs from it by rounding (u = 2^-53).
//
// Turns. An exponential as a quaternion is within 20 u, a product rounds by 8 u, and a
// rotation vector of up to pi radians is within pi times the error of a quaternion, and
// 35 u. So w2 is within pi (2 * 20 + 3 * 8) u + 35 u, below 256 u, and w1 and w3 are
// within 38 u. The matrix of R0 is within 24 u. Let w be within e of the exact w*, and
// D(b) = exp(-b [w]) exp(b [w*]). Then |D'(b)| <= e and |D''(b)| <= 2 pi e. With |b1'|,
// |b3'| <= 3, |b2'| <= 1.5 and |b''| <= 6 the product of D1, D2 and D3 is within 332 u
// of the identity, and has derivatives by s of at most (6 * 38 + 1.5 * 256) u and
// (2 * 63 * 38 + 21 * 256) u: with e = 384 u, below e, 2 e and 32 e.
//
// Cubics. Let M be the sum of the lengths of the way and of the velocities at both ends,
// times the duration. Their coefficients round by less than 16 u M in all; with the
// factors of the first and the second derivative by less than 32 u M and 48 u M.
//
// s is within 3 u of itself. This is 3 u of what changes in a piece.
#include "paths/waypoint_path.h"

#include <algorithm>
#include <cassert>
#include <memory>
#include <utility>

#include "base/default_floating_point.h"
#include "numerics/error_bounds.h"
#include "paths/path_matrix.h"
#include "paths/posed_vector.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

constexpr double kTurnError = 384 * kUnit;

Turning turningBy(const Vec& w) {
  const double angle = norm(w);
  if (angle < kLeastTurn) return {};
  const Vec axis = (1 / angle) * w;
  return {(1 / norm(axis)) * axis, angle};
}

Quaternion quaternionOf(const Vec& w) {
  const double angle = norm(w);
  if (angle == 0) return {{0, 0, 0}, 1};
  const SineCosine half = sineCosine(0.5 * angle);
  return {(half.sine / angle) * w, half.cosine};
}

/// The rotation of a quaternion of any length.
void setRotation(const Quaternion& q, double (&r)[9]) {
  const double factor = 2 / (dot(q.v, q.v) + q.s * q.s);
  assert(0 < factor && factor < HUGE_VAL);
  const double v[3] = {q.v.x, q.v.y, q.v.z};
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    r[4 * i] = 1 - factor * (v[j] * v[j] + v[k] * v[k]);
    r[3 * i + j] = factor * (v[i] * v[j] - q.s * v[k]);
    r[3 * i + k] = factor * (v[i] * v[k] + q.s * v[j]);
  }
  assert(isRotation(r, 0x1p-44));
}

/// The weighted harmonic mean of two velocities; 0 if they have not the same sign.
double velocityBetween(double before, double after, double time_before,
                       double time_after) {
  if (before == 0 || after == 0 || (before > 0) != (after > 0)) return 0;
  const double weight_before = time_before + 2 * time_after,
               weight_after = 2 * time_before + time_after;
  const double mean =
      (weight_before + weight_after) / (weight_before / before + weight_after / after);
  // A steeper one would let a cubic pass its ends.
  assert(!(std::abs(mean) > 3 * std::min(std::abs(before), std::abs(after)) * kUpward));
  return mean;
}

/// The velocities at waypoints: at the ends, those of the pieces there.
/// @param changes, times  of the pieces
std::vector<Vec> velocitiesAt(const std::vector<Vec>& changes,
                              const std::vector<double>& times) {
  assert(!times.empty() && changes.size() == times.size());
  std::vector<Vec> speeds;
  for (std::size_t i = 0; i < times.size(); ++i)
    speeds.push_back((1 / times[i]) * changes[i]);
  std::vector<Vec> out{speeds.front()};
  for (std::size_t i = 1; i < times.size(); ++i) {
    const Vec &x = speeds[i - 1], &y = speeds[i];
    const auto mean = [&](double before, double after) {
      return velocityBetween(before, after, times[i - 1], times[i]);
    };
    out.push_back({mean(x.x, y.x), mean(x.y, y.y), mean(x.z, y.z)});
  }
  out.push_back(speeds.back());
  assert(out.size() == times.size() + 1);
  return out;
}

/// A chain that is built joint by joint. Joints that do not move are left out.
struct Chain {
  JointTree tree;
  std::vector<Coefficients> values;

  int last() const { return static_cast<int>(tree.links().size()) - 1; }

  void slide(const Vec& axis, const Coefficients& value) {
    if (sizeOf(value) == 0) return;
    tree.add(JointTree::Type::kPrismatic, {}, axis, last());
    values.push_back(value);
  }
  /// @param value  for a turn by a radian
  void turn(const Turning& turning, Coefficients value) {
    if (turning.angle == 0) return;
    for (double& x : value) x *= turning.angle;
    tree.add(JointTree::Type::kRevolute, {}, turning.axis, last());
    values.push_back(std::move(value));
  }
};

/// From 0 to `way`, with the slopes `begin` and `end`.
Coefficients cubic(double way, double begin, double end) {
  return {0, begin, 3 * way - (2 * begin + end), (begin + end) - 2 * way};
}

}  // namespace

std::vector<WaypointPath::Waypoint> WaypointPath::waypointsOf(
    const std::vector<Pose>& poses, const std::vector<double>& times) {
  std::vector<Waypoint> out;
  for (std::size_t i = 0; i < poses.size(); ++i)
    out.push_back(
        {times[i], vecOf(poses[i].translation), multipleOfQuaternion(poses[i].rotation)});
  std::vector<double> durations;
  std::vector<Vec> ways, turns;
  for (std::size_t i = 1; i < out.size(); ++i) {
    const Waypoint &x = out[i - 1], &y = out[i];
    durations.push_back(y.t - x.t);
    ways.push_back(y.position - x.position);
    const Turning turn = turningOf(inverse(x.rotation) * y.rotation);
    turns.push_back(turn.angle * turn.axis);
  }
  const std::vector<Vec> velocities = velocitiesAt(ways, durations),
                         angular = velocitiesAt(turns, durations);
  for (std::size_t i = 0; i < out.size(); ++i) {
    out[i].velocity = velocities[i];
    out[i].angular_velocity = angular[i];
  }
  return out;
}

WaypointPath::Piece WaypointPath::makePiece(const Waypoint& x, const Waypoint& y) {
  const double duration = y.t - x.t;
  assert(duration >= kLeastPieceTime);
  const Vec way = y.position - x.position, begin = duration * x.velocity,
            end = duration * y.velocity, w1 = (duration / 3) * x.angular_velocity,
            w3 = (duration / 3) * y.angular_velocity;
  Chain chain;
  chain.slide({1, 0, 0}, cubic(way.x, begin.x, end.x));
  chain.slide({0, 1, 0}, cubic(way.y, begin.y, end.y));
  chain.slide({0, 0, 1}, cubic(way.z, begin.z, end.z));
  Pose rotation, base;
  setRotation(x.rotation, rotation.rotation);
  chain.tree.add(JointTree::Type::kFixed, rotation, {}, chain.last());
  const Quaternion turn = inverse(x.rotation) * y.rotation;
  // They turn by less than the whole piece.
  assert(!(std::max(norm(w1), norm(w3)) > turningOf(turn).angle * kUpward));
  chain.turn(turningBy(w1), {0, 3, -3, 1});
  chain.turn(turningOf(inverse(quaternionOf(w1)) * turn * inverse(quaternionOf(w3))),
             {0, 0, 3, -2});
  chain.turn(turningBy(w3), {0, 0, 0, 1});
  set(base.translation, x.position);
  const int last = chain.last();
  const auto tree = std::make_shared<const JointTree>(std::move(chain.tree));
  const auto path =
      std::make_shared<const ChainPath>(tree, base, std::move(chain.values));
  const JointBounds& bounds = path->bounds(tree->links().back().joint);
  const bool is_turn = turn.v.x != 0 || turn.v.y != 0 || turn.v.z != 0;
  return {x.t,
          duration,
          LinkPath(path, tree->links()[static_cast<std::size_t>(last)]),
          bounds.rotation,
          bounds.translation,
          is_turn ? kTurnError : 0,
          (norm(way) + norm(begin) + norm(end)) * kUpward};
}

WaypointPath::WaypointPath(const std::vector<Pose>& poses,
                           const std::vector<double>& times) {
  assert(poses.size() >= 2 && times.size() == poses.size());
  assert(times.front() == 0 && times.back() == 1);
  const std::vector<Waypoint> waypoints = waypointsOf(poses, times);
  for (std::size_t i = 1; i < waypoints.size(); ++i) {
    pieces_.push_back(makePiece(waypoints[i - 1], waypoints[i]));
    const Rounding of = pieces_.back().rounding();
    rounding_ = {std::max(rounding_.rotation, of.rotation),
                 std::max(rounding_.rotation_rate, of.rotation_rate),
                 std::max(rounding_.translation, of.translation),
                 std::max(rounding_.translation_rate, of.translation_rate)};
  }
}

const WaypointPath::Piece& WaypointPath::pieceAt(double t) const {
  const auto after =
      std::upper_bound(pieces_.begin() + 1, pieces_.end(), t,
                       [](double time, const Piece& p) { return time < p.begin; });
  assert(!isTimeOfStep(t) || isTimeOfStep((after - 1)->atTime(t)));
  return *(after - 1);
}

BoundedMotion::Placement WaypointPath::placementAt(double t) const {
  const DefaultFloatingPoint mode;
  const Piece& piece = pieceAt(t);
  return piece.path.placementAt(piece.atTime(t));
}

BoundedMotion::Placement WaypointPath::rateAt(double t) const {
  const DefaultFloatingPoint mode;
  const Piece& piece = pieceAt(t);
  Placement out = piece.path.rateAt(piece.atTime(t));
  for (double& x : out.rotation) x /= piece.duration;
  for (double& x : out.translation) x /= piece.duration;
  return out;
}

template <typename Bound>
double WaypointPath::largest(double t0, double t1, const Bound& bound) const {
  const Piece* piece = &pieceAt(t0);
  double most = 0;
  do {
    // A little longer than the part of the span in this piece: its ends round.
    const double s0 = std::max(piece->atTime(t0) - 8 * kUnit, 0.),
                 s1 = std::min(piece->atTime(t1) + 8 * kUnit, 1.);
    assert(!isPartOfStep(t0, t1) || isPartOfStep(s0, s1));
    most = std::max(most, bound(*piece, s0, s1));
    ++piece;
  } while (piece != pieces_.data() + pieces_.size() && piece->begin < t1);
  return most;
}

double WaypointPath::accelerationBound(const double (&center)[3], double radius,
                                       double t0, double t1) const {
  const DefaultFloatingPoint mode;
  const double far = norm(center) + radius;
  return largest(t0, t1, [&](const Piece& piece, double s0, double s1) {
    const DerivativeBounds& turn = piece.rotation;
    const double error = piece.turn_error * (turn.second + 4 * turn.first + 32) * far +
                         48 * kUnit * piece.size;
    return (piece.path.accelerationBound(center, radius, s0, s1) + error) /
           (piece.duration * piece.duration) * kUpward;
  });
}

double WaypointPath::angularSpeedBound(double t0, double t1) const {
  const DefaultFloatingPoint mode;
  return largest(t0, t1, [](const Piece& piece, double s0, double s1) {
    const double error = piece.turn_error * (piece.rotation.first + 2);
    return (piece.path.angularSpeedBound(s0, s1) + error) / piece.duration * kUpward;
  });
}

BoundedMotion::Rounding WaypointPath::Piece::rounding() const {
  const Rounding own = path.moreRounding();
  const DerivativeBounds &turn = rotation, &way = translation;
  return {
      (own.rotation + std::max(turn_error, 24 * kUnit) + 4 * kUnit * turn.first) *
          kUpward,
      (own.rotation_rate + turn_error * (turn.first + 2) +
       4 * kUnit * (turn.first + turn.second)) /
          duration * kUpward,
      (own.translation + 16 * kUnit * size + 4 * kUnit * way.first) * kUpward,
      (own.translation_rate + 32 * kUnit * size + 4 * kUnit * (way.first + way.second)) /
          duration * kUpward};
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
