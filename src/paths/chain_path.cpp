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
  std::copy(base.rotation, base.rotation + 9, base_state_.rotation);
  base_state_.translation = vecOf(base.translation);
  base_bounds_.reach = norm(base.translation);
  const auto& joints = tree_->joints();
  assert(values.size() == joints.size());
  for (std::size_t j = 0; j < joints.size(); ++j) {
    // Each joint comes after the one that carries it.
    assert(-1 <= joints[j].parent && joints[j].parent < static_cast<int>(j));
    requireValue(values[j], joints[j].is_revolute, j);
    bounds_.push_back(boundsOf(joints[j], values[j]));
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

void ChainPath::move(const JointTree::Joint& joint, const JointState& before,
                     const Value& value, double t, JointState& out) {
  const double q = valueAt(value.at, t), rate = valueAt(value.rate, t),
               acceleration = valueAt(value.acceleration, t);
  const auto& origin = joint.origin.pose;
  const Vec axis = rotated(before.rotation, joint.axis_in_parent);
  Vec way = rotated(before.rotation, vecOf(origin.translation));
  if (!joint.is_revolute) way = way + q * axis;
  const Vec turning = cross(before.turn, way);
  out.translation = before.translation + way;
  out.speed = before.speed + turning;
  out.acceleration =
      before.acceleration + cross(before.turn_rate, way) + cross(before.turn, turning);
  if (!joint.is_revolute) {
    multiply(before.rotation, origin.rotation, out.rotation);
    out.speed = out.speed + rate * axis;
    out.acceleration =
        out.acceleration + acceleration * axis + (2 * rate) * cross(before.turn, axis);
    out.turn = before.turn;
    out.turn_rate = before.turn_rate;
    return;
  }
  const SineCosine at = sineAndOneMinusCosine(q);
  double own[9];
  for (int i = 0; i < 9; ++i)
    own[i] = origin.rotation[i] +
             (at.sine * joint.sine_rotation[i] + at.cosine * joint.cosine_rotation[i]);
  multiply(before.rotation, own, out.rotation);
  out.turn = before.turn + rate * axis;
  out.turn_rate =
      before.turn_rate + acceleration * axis + rate * cross(before.turn, axis);
}

void ChainPath::computeStates(double t, std::size_t count, Kept& kept) const {
  const auto& joints = tree_->joints();
  assert(count <= joints.size());
  kept.states.resize(joints.size());
  for (; kept.count < count; ++kept.count) {
    const JointTree::Joint& joint = joints[kept.count];
    assert(joint.parent < static_cast<int>(kept.count));
    move(joint,
         joint.parent < 0 ? base_state_
                          : kept.states[static_cast<std::size_t>(joint.parent)],
         values_[kept.count], t, kept.states[kept.count]);
  }
}

// The thread keeps what is computed here: the mode of a caller must not get into it.
const JointState& ChainPath::stateAt(int joint, double t) const {
  if (joint < 0) return base_state_;
  constexpr int kBits = 6;
  using Cache = SlotCache<StateKey, Kept, 1 << kBits>;
  thread_local const std::unique_ptr<Cache> cache(new Cache(StateKey{0, 0}));
  const std::size_t slot = slotOf(t, static_cast<std::int32_t>(number_), kBits);
  Kept& kept = cache->get(slot, {number_, t}, [](Kept& made) { made.count = 0; });
  const auto place = static_cast<std::size_t>(joint);
  computeStates(t, place + 1, kept);
  assert(place < kept.count && isRotation(kept.states[place].rotation, kMostDefect));
  return kept.states[place];
}

LinkPath::LinkPath(std::shared_ptr<const ChainPath> chain, const JointTree::Link& link)
    : chain_(std::move(chain)), joint_(link.joint), pose_(link.pose) {
  assert(joint_ < static_cast<int>(chain_->tree().joints().size()));
}

bool LinkPath::isRevolute() const {
  return joint_ >= 0 &&
         chain_->tree().joints()[static_cast<std::size_t>(joint_)].is_revolute;
}

BoundedMotion::Placement LinkPath::placementAt(double t) const {
  const DefaultFloatingPoint mode;
  const JointState& state = chain_->stateAt(joint_, t);
  Placement out;
  multiply(state.rotation, pose_.pose.rotation, out.rotation);
  set(out.translation,
      rotated(state.rotation, vecOf(pose_.pose.translation)) + state.translation);
  return out;
}

BoundedMotion::Placement LinkPath::rateAt(double t) const {
  const DefaultFloatingPoint mode;
  const JointState& state = chain_->stateAt(joint_, t);
  double rotation[9];
  multiply(state.rotation, pose_.pose.rotation, rotation);
  Placement out;
  crossColumns(state.turn, rotation, out.rotation);
  set(out.translation,
      cross(state.turn, rotated(state.rotation, vecOf(pose_.pose.translation))) +
          state.speed);
  return out;
}

// R x = R_p B exp(q [a]) x, and only the part of x at right angles to a turns with q. The
// derivatives of R are at least those of R_p, and what is more belongs to q. The computed
// part is within 8 u of the size of x.
DerivativeBounds LinkPath::boundsOfBall(const Vec& center, double radius) const {
  const JointBounds& of = bounds();
  const double far = norm(center) + radius;
  double across = far;
  if (isRevolute())
    across = norm(cross(chain_->tree().joints()[static_cast<std::size_t>(joint_)].axis,
                        center)) +
             64 * kUnit * norm(center) + radius;
  // A part of x is not longer than x.
  assert(!(across > far * kUpward + 0x1p-500));
  const auto bound = [&](double translation, double before, double rotation) {
    return (translation + before * far + (rotation - before) * across) * kUpward;
  };
  return {bound(of.translation.first, of.rotation_before.first, of.rotation.first),
          bound(of.translation.second, of.rotation_before.second, of.rotation.second),
          bound(of.translation.third, of.rotation_before.third, of.rotation.third)};
}

// The computed acceleration has the relative errors of the rotations, of which a term has
// up to three, and of angular velocities, which are at most 2^-38 (errorOf(), and
// largestValue()). An error of the direction of a velocity acts on all of x, the velocity
// itself only on what is across.
double LinkPath::boundOf(const AccelerationBound& in, const Vec& center,
                         double radius) const {
  const Vec x = posed(pose_.pose, center);
  const double distance = norm(center), length = norm(x),
               size = radius * (1 + 0x1p-39) + pose_.rotation_error * distance +
                      pose_.translation_error + 0x1p-46 * (length + distance);
  const DerivativeBounds whole = boundsOfBall(x, size);
  const double error = 16 * bounds().rotation_error, half = 0.5 * (in.t1 - in.t0),
               own = norm(rotated(in.turn, center) + vecOf(in.offset)),
               there = own + in.turning * (size + (error + 0x1p-44) * (length + size)) +
                       (0x1p-36 + error) * whole.second;
  // The bound for the whole step holds in the middle of the span.
  assert(!isTimeOfStep(middleOf(in.t0, in.t1)) ||
         !(own > (1 + 0x1p-36 + error) * whole.second * kUpward +
                     in.turning * (error + 0x1p-44) * (length + size) + 0x1p-500));
  return std::min(whole.second, there + half * whole.third) * kUpward;
}

// (T + R (S x + s))'' for the link's pose (S, s) in the frame of its joint (R, T).
AccelerationBound LinkPath::accelerationIn(double t0, double t1) const {
  const JointState& middle = chain_->stateAt(joint_, middleOf(t0, t1));
  AccelerationBound out{};
  out.motion = this;
  out.link = this;
  out.t0 = t0;
  out.t1 = t1;
  out.jerk = HUGE_VAL;
  out.turning = dot(middle.turn, middle.turn) + norm(middle.turn_rate);
  out.per_displacement = 2 * (turnSpeedIn(t0, t1, middle) * kUpward);
  double rotation[9], velocity[9], first[9], second[9];
  multiply(middle.rotation, pose_.pose.rotation, rotation);
  crossColumns(middle.turn, rotation, velocity);
  crossColumns(middle.turn, velocity, first);
  crossColumns(middle.turn_rate, rotation, second);
  for (int i = 0; i < 9; ++i) out.turn[i] = first[i] + second[i];
  const Vec arm = rotated(middle.rotation, vecOf(pose_.pose.translation));
  set(out.offset, middle.acceleration + cross(middle.turn_rate, arm) +
                      cross(middle.turn, cross(middle.turn, arm)));
  return out;
}

double LinkPath::turnSpeedIn(double t0, double t1, const JointState& middle) const {
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
  return boundOf(accelerationIn(t0, t1), vecOf(center), radius);
}

double LinkPath::angularSpeedBound(double t0, double t1) const {
  const DefaultFloatingPoint mode;
  return turnSpeedIn(t0, t1, chain_->stateAt(joint_, middleOf(t0, t1)));
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
