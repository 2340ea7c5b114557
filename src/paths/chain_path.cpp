// SPDX-License-Identifier: BSD-3-Clause
//
// Rounding (u = 2^-53), in spectral norms. The axis is within 3 u, entries of B [a]
// within 3 u, B [a] within 12 u, B [a]^2 within 24 u. With sin and 1 - cos, at most 1 and
// 2 and within 4 and 8.2 u, and the sum of three terms of sizes 1, 1 and 2, the matrix of
// a joint is within 12 + 48 + 4 + 8.2 + 27 u of the turn by the computed angle. The
// product with the rotation before it adds 9 u: below 128 u and the error of the angle.
#include "paths/chain_path.h"

#include <atomic>
#include <cassert>
#include <string>
#include <utility>

#include "base/default_floating_point.h"
#include "base/error.h"
#include "base/slot_cache.h"
#include "paths/path_matrix.h"
#include "paths/posed_vector.h"
#include "paths/sine.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

constexpr double kRoundingOfJoint = 128 * kUnit;

/// A computed polynomial is within this: Horner's rule rounds twice a coefficient, and
/// the coefficients were rounded once or twice.
double errorOf(const Coefficients& p) {
  return (2 * static_cast<double>(p.size()) + 2) * kUnit * sizeOf(p);
}

/// Bound on |p(t)| for t in [0, 1]. A linear one is largest at an end.
double mostOf(const Coefficients& p) {
  return p.size() == 2 ? std::max(std::abs(p[0]), std::abs(p[0] + p[1])) : sizeOf(p);
}

void requireValue(const Coefficients& value, bool is_angle, std::size_t joint) {
  const bool is_finite = std::isfinite(sizeOf(value));
  if (is_finite && !(is_angle && mostOf(value) > kMostAngle)) return;
  throwBadInput("the value " + std::to_string(joint) + " of the joints " +
                (is_finite ? "is an angle of more than 2^20 radians, or a polynomial of "
                             "which the sizes of the coefficients have a larger sum. "
                             "Subtract whole turns"
                           : "is not finite. Correct it"));
}

std::uint64_t nextNumber() {
  static std::atomic<std::uint64_t> count{0};
  return ++count;
}

/// A path and a time. The number 0 is no path's.
struct StateKey {
  std::uint64_t path;
  double t;
  bool operator==(const StateKey& other) const {
    return path == other.path && t == other.t;
  }
};

/// A computed rotation is one up to this, whatever its joints: bounds on its error are
/// smaller, but for chains of very many fixed joints. For assertions.
[[maybe_unused]] constexpr double kMostDefect = 0x1p-30;

/// Whether no bound is smaller than the other one; also of NaN. For assertions.
[[maybe_unused]] bool areAtLeast(const DerivativeBounds& x, const DerivativeBounds& y) {
  return !(x.first < y.first) && !(x.second < y.second) && !(x.third < y.third);
}

/// Whether what holds for a joint includes what holds for the one before it: lengths and
/// errors add up along a chain. For assertions.
[[maybe_unused]] bool includes(const JointBounds& of, const JointBounds& before) {
  return areAtLeast(of.rotation, before.rotation) &&
         areAtLeast(of.rotation, of.rotation_before) &&
         areAtLeast(of.translation, before.translation) && !(of.reach < before.reach) &&
         !(of.rotation_error < before.rotation_error) &&
         !(of.translation_error < before.translation_error) &&
         !(of.turn_error < before.turn_error) && !(of.speed_error < before.speed_error);
}

double middleOf(double t0, double t1) { return t0 + 0.5 * (t1 - t0); }

}  // namespace

ChainPath::ChainPath(std::shared_ptr<const JointTree> tree, const Pose& base,
                     std::vector<Coefficients> values)
    : tree_(std::move(tree)), base_(base), number_(nextNumber()) {
  base_bounds_.reach = norm(base.translation);
  const auto& joints = tree_->joints();
  assert(values.size() == joints.size());
  for (std::size_t j = 0; j < joints.size(); ++j) {
    // Each joint comes after the one that carries it.
    assert(-1 <= joints[j].parent && joints[j].parent < static_cast<int>(j));
    requireValue(values[j], joints[j].is_revolute, j);
    bounds_.push_back(boundsOf(joints[j], values[j]));
    is_steady_ = is_steady_ && values[j].size() <= 2;
    const Coefficients rate = derivativeOf(values[j]);
    values_.push_back({std::move(values[j]), rate, derivativeOf(rate)});
  }
  assert(values_.size() == bounds_.size());
}

JointBounds ChainPath::boundsOf(const JointTree::Joint& joint,
                                const Coefficients& value) const {
  const JointBounds& before = bounds(joint.parent);
  const DerivativeBounds still{0, 0, 0}, moves = derivativeBounds(value);
  const double offset = norm(joint.origin.pose.translation),
               length = offset + (joint.is_revolute ? 0 : largestValue(value)),
               angle_error = joint.is_revolute ? errorOf(value) : 0,
               rate_error = errorOf(derivativeOf(value)),
               way_error =
                   joint.origin.translation_error +
                   (joint.is_revolute ? 0
                                      : errorOf(value) + largestValue(value) *
                                                             joint.origin.rotation_error);
  JointBounds out{};
  out.rotation_before = before.rotation;
  out.rotation = joint.is_revolute
                     ? boundsOfProduct(before.rotation, boundsOfTurn(moves), 1)
                     : before.rotation;
  out.translation =
      before.translation +
      boundsOfProduct(before.rotation, joint.is_revolute ? still : moves, length);
  out.reach = (before.reach + length) * kUpward;
  // A rotation within e turns a vector within e of it, and rounds it by 6 u. The origin
  // of the joint has its own errors, and an axis of a few u. A sum of angular velocities
  // rounds by u of its size.
  const double turned = before.rotation_error + 16 * kUnit;
  out.rotation_error = before.rotation_error + kRoundingOfJoint + angle_error +
                       joint.origin.rotation_error;
  out.translation_error =
      before.translation_error + turned * length + way_error + 2 * kUnit * out.reach;
  out.turn_error =
      before.turn_error + (joint.is_revolute ? 2 * kUnit * out.rotation.first : 0);
  out.speed_error =
      before.speed_error +
      (before.turn_error + before.rotation.first * (turned + 8 * kUnit)) * length +
      before.rotation.first * way_error + 4 * kUnit * out.translation.first;
  (joint.is_revolute ? out.turn_error : out.speed_error) +=
      moves.first * (turned + joint.origin.rotation_error) + rate_error;
  assert(includes(out, before));
  return out;
}

std::vector<double> ChainPath::valuesAt(double t) const {
  std::vector<double> values;
  for (const Value& value : values_) values.push_back(valueAt(value.at, t));
  return values;
}

/// The place of a joint's frame, seen from that of the joint before it.
Vec ChainPath::wayOf(const JointTree::Joint& joint, const Pose& before,
                     const Value& value, double t) {
  const Vec way = rotated(before.rotation, vecOf(joint.origin.pose.translation));
  if (joint.is_revolute) return way;
  return way + valueAt(value.at, t) * rotated(before.rotation, joint.axis_in_parent);
}

void ChainPath::move(const JointTree::Joint& joint, const Pose& before,
                     const Value& value, double t, Pose& out) {
  const auto& origin = joint.origin.pose;
  set(out.translation, vecOf(before.translation) + wayOf(joint, before, value, t));
  if (!joint.is_revolute) return multiply(before.rotation, origin.rotation, out.rotation);
  const SineCosine at = sineAndOneMinusCosine(valueAt(value.at, t));
  double own[9];
  for (int i = 0; i < 9; ++i)
    own[i] = origin.rotation[i] +
             (at.sine * joint.sine_rotation[i] + at.cosine * joint.cosine_rotation[i]);
  multiply(before.rotation, own, out.rotation);
}

void ChainPath::rates(const JointTree::Joint& joint, const Pose& before,
                      const JointRates& rates_before, const Value& value, double t,
                      JointRates& out) {
  const double rate = valueAt(value.rate, t),
               acceleration = valueAt(value.acceleration, t);
  const Vec axis = rotated(before.rotation, joint.axis_in_parent),
            way = wayOf(joint, before, value, t), turning = cross(rates_before.turn, way);
  out = rates_before;
  out.speed = out.speed + turning;
  out.acceleration = out.acceleration + cross(rates_before.turn_rate, way) +
                     cross(rates_before.turn, turning);
  const Vec axis_rate = cross(rates_before.turn, axis);
  if (joint.is_revolute) {
    out.turn = out.turn + rate * axis;
    out.turn_rate = out.turn_rate + acceleration * axis + rate * axis_rate;
  } else {
    out.speed = out.speed + rate * axis;
    out.acceleration = out.acceleration + acceleration * axis + (2 * rate) * axis_rate;
  }
}

void ChainPath::computePoses(double t, std::size_t count, Kept& kept) const {
  const auto& joints = tree_->joints();
  assert(count <= joints.size());
  kept.poses.resize(joints.size());
  for (; kept.num_poses < count; ++kept.num_poses) {
    const JointTree::Joint& joint = joints[kept.num_poses];
    assert(joint.parent < static_cast<int>(kept.num_poses));
    move(joint,
         joint.parent < 0 ? base_ : kept.poses[static_cast<std::size_t>(joint.parent)],
         values_[kept.num_poses], t, kept.poses[kept.num_poses]);
  }
}

void ChainPath::computeRates(double t, std::size_t count, Kept& kept) const {
  const auto& joints = tree_->joints();
  assert(count <= kept.num_poses);
  kept.rates.resize(joints.size());
  for (; kept.num_rates < count; ++kept.num_rates) {
    const JointTree::Joint& joint = joints[kept.num_rates];
    const bool is_first = joint.parent < 0;
    const auto parent = static_cast<std::size_t>(is_first ? 0 : joint.parent);
    rates(joint, is_first ? base_ : kept.poses[parent],
          is_first ? base_rates_ : kept.rates[parent], values_[kept.num_rates], t,
          kept.rates[kept.num_rates]);
  }
}

// The thread keeps what is computed here: the mode of a caller must not get into it.
ChainPath::Kept& ChainPath::keptAt(double t) const {
  constexpr int kBits = 6;
  using Cache = SlotCache<StateKey, Kept, 1 << kBits>;
  thread_local const std::unique_ptr<Cache> cache(new Cache(StateKey{0, 0}));
  const std::size_t slot = slotOf(t, static_cast<std::int32_t>(number_), kBits);
  return cache->get(slot, {number_, t},
                    [](Kept& made) { made.num_poses = made.num_rates = 0; });
}

const Pose& ChainPath::poseAt(int joint, double t) const {
  if (joint < 0) return base_;
  Kept& kept = keptAt(t);
  const auto place = static_cast<std::size_t>(joint);
  computePoses(t, place + 1, kept);
  assert(place < kept.num_poses && isRotation(kept.poses[place].rotation, kMostDefect));
  return kept.poses[place];
}

ChainPath::State ChainPath::stateAt(int joint, double t) const {
  if (joint < 0) return {base_, base_rates_};
  Kept& kept = keptAt(t);
  const auto place = static_cast<std::size_t>(joint);
  computePoses(t, place + 1, kept);
  computeRates(t, place + 1, kept);
  return {kept.poses[place], kept.rates[place]};
}

LinkPath::LinkPath(std::shared_ptr<const ChainPath> chain, const JointTree::Link& link)
    : chain_(std::move(chain)), joint_(link.joint), pose_(link.pose) {
  assert(joint_ < static_cast<int>(chain_->tree().joints().size()));
}

Pose LinkPath::poseAt(double t) const {
  const Pose& joint = chain_->poseAt(joint_, t);
  Pose out;
  multiply(joint.rotation, pose_.pose.rotation, out.rotation);
  set(out.translation,
      rotated(joint.rotation, vecOf(pose_.pose.translation)) + vecOf(joint.translation));
  return out;
}

BoundedMotion::Placement LinkPath::placementAt(double t) const {
  const DefaultFloatingPoint mode;
  const Pose pose = poseAt(t);
  Placement out;
  std::copy(pose.rotation, pose.rotation + 9, out.rotation);
  std::copy(pose.translation, pose.translation + 3, out.translation);
  return out;
}

BoundedMotion::Placement LinkPath::rateAt(double t) const {
  const DefaultFloatingPoint mode;
  const ChainPath::State state = chain_->stateAt(joint_, t);
  double rotation[9];
  multiply(state.pose.rotation, pose_.pose.rotation, rotation);
  Placement out;
  crossColumns(state.rates.turn, rotation, out.rotation);
  set(out.translation, cross(state.rates.turn, rotated(state.pose.rotation,
                                                       vecOf(pose_.pose.translation))) +
                           state.rates.speed);
  return out;
}

// The pose (S, s) of the link in the frame of its joint rounds.
LinearBound LinkPath::radiusInJoint() const {
  return {1 + 0x1p-39, pose_.rotation_error + 0x1p-45,
          pose_.translation_error + 0x1p-45 * norm(pose_.pose.translation)};
}

LinearBound LinkPath::reachInJoint() const {
  const LinearBound radius = radiusInJoint();
  return {radius.per_radius, 1 + 0x1p-39 + radius.per_distance,
          norm(pose_.pose.translation) * (1 + 0x1p-39) + radius.constant};
}

// R x = R_p B exp(q [a]) x for x = S c + s, and only the part of x at right angles to a
// turns with q. The derivatives of R are at least those of R_p, and what is more belongs
// to q.
AccelerationBound LinkPath::accelerationInStep() const {
  const JointBounds& of = bounds();
  const LinearBound radius = radiusInJoint(), reach = reachInJoint();
  double of_reach = of.rotation.second, across = 0;
  AccelerationBound out{};
  out.jerk = HUGE_VAL;
  if (joint_ >= 0 &&
      chain_->tree().joints()[static_cast<std::size_t>(joint_)].is_revolute) {
    across = of.rotation.second - of.rotation_before.second;
    // The computed part is within 64 u of the size of x.
    of_reach = of.rotation_before.second + 0x1p-46 * across;
    const Vec axis =
        across * chain_->tree().joints()[static_cast<std::size_t>(joint_)].axis;
    crossColumns(axis, pose_.pose.rotation, out.turn);
    set(out.offset, cross(axis, vecOf(pose_.pose.translation)));
  }
  out.per_radius = of_reach * reach.per_radius + across * radius.per_radius;
  out.per_distance = of_reach * reach.per_distance + across * radius.per_distance;
  out.constant =
      of.translation.second + of_reach * reach.constant + across * radius.constant;
  out.per_displacement = 2 * of.rotation.first * kUpward;
  return out;
}

// (T + R (S c + s))'' in the middle, and by how much more it may be in the span. The
// computed acceleration has the relative errors of the rotations, of which a term has up
// to three, and of angular velocities, which are at most 2^-38 (errorOf(), and
// largestValue()). An error of the direction of a velocity acts on all of x.
AccelerationBound LinkPath::accelerationFromMiddle(double t0, double t1) const {
  const ChainPath::State state = chain_->stateAt(joint_, middleOf(t0, t1));
  const JointRates& middle = state.rates;
  const JointBounds& of = bounds();
  const LinearBound radius = radiusInJoint(), reach = reachInJoint();
  const double turning = dot(middle.turn, middle.turn) + norm(middle.turn_rate),
               half = 0.5 * (t1 - t0), error = 16 * of.rotation_error + 0x1p-36,
               per_reach = turning * error + error * of.rotation.second +
                           half * of.rotation.third;
  AccelerationBound out{};
  out.jerk = HUGE_VAL;
  out.per_radius = turning * radius.per_radius + per_reach * reach.per_radius;
  out.per_distance = turning * radius.per_distance + per_reach * reach.per_distance;
  out.constant = turning * radius.constant + per_reach * reach.constant +
                 error * of.translation.second + half * of.translation.third;
  out.per_displacement = 2 * (turnSpeedIn(t0, t1, middle) * kUpward);
  double rotation[9], velocity[9], first[9], second[9];
  multiply(state.pose.rotation, pose_.pose.rotation, rotation);
  crossColumns(middle.turn, rotation, velocity);
  crossColumns(middle.turn, velocity, first);
  crossColumns(middle.turn_rate, rotation, second);
  for (int i = 0; i < 9; ++i) out.turn[i] = first[i] + second[i];
  const Vec arm = rotated(state.pose.rotation, vecOf(pose_.pose.translation));
  set(out.offset, middle.acceleration + cross(middle.turn_rate, arm) +
                      cross(middle.turn, cross(middle.turn, arm)));
  // The bound for the whole step holds in the middle of the span.
  assert(!isTimeOfStep(middleOf(t0, t1)) ||
         !(norm(vecOf(out.offset)) >
           (1 + 2 * error) * accelerationInStep().of({0, 0, 0}, 0) +
               turning * error * reach.constant + 0x1p-500));
  return out;
}

// Which one is less depends on the place. They are compared for the points around the
// origin of the link, within a part of what the chain reaches.
AccelerationBound LinkPath::accelerationIn(double t0, double t1) const {
  constexpr double kPart = 0.125;
  const AccelerationBound in_step = accelerationInStep();
  if (t0 == 0 && t1 == 1) return in_step;
  const AccelerationBound from_middle = accelerationFromMiddle(t0, t1);
  const double reach = bounds().reach, near = reach > 0 ? kPart * reach : 1;
  return in_step.of({0, 0, 0}, near) < from_middle.of({0, 0, 0}, near) ? in_step
                                                                       : from_middle;
}

double LinkPath::turnSpeedIn(double t0, double t1, const JointRates& middle) const {
  const DerivativeBounds& whole = bounds().rotation;
  const double error = 0x1p-36 + 16 * bounds().rotation_error, speed = norm(middle.turn),
               there = speed + error * whole.first + 0.5 * (t1 - t0) * whole.second;
  assert(!isTimeOfStep(middleOf(t0, t1)) ||
         !(speed > (1 + error) * whole.first * kUpward + 0x1p-500));
  return std::min(whole.first, there) * kUpward;
}

double LinkPath::accelerationBound(const double (&center)[3], double radius, double t0,
                                   double t1) const {
  const DefaultFloatingPoint mode;
  const Vec place = vecOf(center);
  return std::min(accelerationInStep().of(place, radius),
                  accelerationFromMiddle(t0, t1).of(place, radius));
}

double LinkPath::speedBound() const {
  const JointBounds& of = bounds();
  return (of.translation.first + of.rotation.first * norm(pose_.pose.translation)) *
         kUpward;
}

double LinkPath::extentBound() const {
  const double lengths = bounds().reach - norm(chain_->base().translation) +
                         norm(pose_.pose.translation) + 8 * kUnit * bounds().reach;
  return std::min(speedBound(), 2 * lengths * kUpward);
}

double LinkPath::angularSpeedBound(double t0, double t1) const {
  const DefaultFloatingPoint mode;
  return turnSpeedIn(t0, t1, chain_->stateAt(joint_, middleOf(t0, t1)).rates);
}

BoundedMotion::Rounding LinkPath::moreRounding() const {
  const DefaultFloatingPoint mode;
  const JointBounds& of = bounds();
  const double offset = norm(pose_.pose.translation),
               turned = of.rotation_error + 16 * kUnit,
               rate = of.turn_error + of.rotation.first * (turned + 8 * kUnit);
  return {(turned + pose_.rotation_error) * kUpward,
          (rate + of.rotation.first * pose_.rotation_error) * kUpward,
          (of.translation_error + turned * offset + pose_.translation_error +
           2 * kUnit * (of.reach + offset)) *
              kUpward,
          (of.speed_error + rate * offset + of.rotation.first * pose_.translation_error +
           4 * kUnit * of.translation.first) *
              kUpward};
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
