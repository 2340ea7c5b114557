// SPDX-License-Identifier: BSD-3-Clause
#include "bodies/parting_direction.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "paths/posed_vector.h"

namespace fcl {
namespace detail {
namespace deformable {
// The pose of a point x rounds by the position error of its path, as in the advancement
// of pairs. n . p(x) is computed as (R^T n) . x + n . T. This rounds by 9 u |x| + 3 u |T|
// and the differences by 2 u (|x| + |T|). The tolerance has 16 u of these sizes. Pairs
// rest at twice the position error: so another pair that touches at the same time, up to
// rounding, has a gap beyond the margin.
PartingDirection::PartingDirection(const MovingBody& a, const MovingBody& b,
                                   const BodyTolerance& tolerance)
    : body_{&a, &b}, margin_(tolerance.distance) {
  // Heights above a flat are products with a normal that may be longer than 1.
  for (auto k : {0, 1}) {
    if (!body_[k]->shape() || !body_[k]->shape()->flat()) continue;
    flat_ = k;
    margin_ *= body_[k]->path().stretch();
  }
  margin_ += tolerance.position;
  assert(!(margin_ < 0));
}

void PartingDirection::set(const Vec& direction) {
  constexpr int kRoom = 64;
  if (!(maxNorm(direction) > 0)) return;
  assert(isUnit(direction));
  direction_ = direction;
  room_ += kRoom;
  forgetReaches();
}

void PartingDirection::forgetReaches() {
  for (auto& known : known_)
    if (known) known->forgetAll();
}

double PartingDirection::reachOf(int k, const BodyPart& part, double t,
                                 const Vec& in_body) {
  if (part.child < 0 || !body_[k]->isMesh())
    return body_[k]->reach(part, t, in_body, room_);
  if (!known_[k]) known_[k] = std::make_unique<Reaches>(std::pair{-1, 0.});
  const std::size_t slot = slotOf(t, part.child, kSlotBits);
  if (const double* known = known_[k]->find(slot, {part.child, t})) return *known;
  const double reach = body_[k]->reach(part, t, in_body, room_);
  if (room_ < 0)
    known_[k]->forget(slot);
  else
    known_[k]->put(slot, {part.child, t}) = reach;
  return reach;
}

PartingDirection::Poses PartingDirection::posesAt(double t) const {
  return {{body_[0]->path().pose(t), body_[1]->path().pose(t)}};
}

/// Whether the other body is on the side of a plane to which its normal does not point.
bool PartingDirection::isBelowFlat(const Poses& poses) const {
  if (flat_ < 0 || body_[flat_]->shape()->flat()->is_solid) return false;
  const Vec up = directionAt(poses, false);
  return dot(up, direction_) < 0;
}

Vec PartingDirection::directionAt(const Poses& poses, bool is_below) const {
  if (flat_ < 0) return direction_;
  const Vec up =
      rotated(poses.body[flat_].rotation, body_[flat_]->shape()->flat()->normal);
  return is_below == (flat_ == 0) ? -1. * up : up;
}

double PartingDirection::gapAt(double t, const BodyPart& a, const BodyPart& b,
                               const Poses& poses, const Vec& direction) {
  const BodyPart* part[2] = {&a, &b};
  double gap = -margin_;
  for (auto k : {0, 1}) {
    const Vec out = k == 0 ? direction : -1. * direction,
              in_body = rotatedBack(poses.body[k].rotation, out);
    gap -= k == flat_ ? dot(in_body, body_[k]->shape()->flat()->foot())
                      : reachOf(k, *part[k], t, in_body);
    gap -= dot(out, vecOf(poses.body[k].translation));
  }
  return gap;
}

// The end comes first: there most parts that touch earlier are not apart.
bool PartingDirection::areApart(const BodyPart& a, const BodyPart& b,
                                const double (&t)[2], double (&gap)[2]) {
  constexpr int kRoom = 4;
  assert(isTimeOfStep(t[0]) && isTimeOfStep(t[1]));
  room_ += kRoom;
  if (!(maxNorm(direction_) > 0) || room_ < 0) return false;
  const std::int64_t room = room_;
  Poses poses = posesAt(t[1]);
  const bool is_below = isBelowFlat(poses);
  if (is_below != known_below_) {
    forgetReaches();
    known_below_ = is_below;
  }
  gap[1] = gapAt(t[1], a, b, poses, directionAt(poses, is_below));
  if (!(gap[1] > 0) || room_ < 0) return false;
  poses = posesAt(t[0]);
  gap[0] = gapAt(t[0], a, b, poses, directionAt(poses, is_below));
  if (!(gap[0] > 0) || room_ < 0) return false;
  // gapAt() has subtracted from the room what the parts take.
  assert(room_ <= room);
  room_ += 2 * (room - room_);
  return true;
}

// At a share s of the span the gap is at least (1 - s) g0 + s g1 - 4 D s (1 - s). Divided
// by s (1 - s) the first two terms are g0 / s + g1 / (1 - s), which is least, (sqrt g0 +
// sqrt g1)^2, where s is to 1 - s as sqrt g0 to sqrt g1.
bool staysPositive(const double (&gap)[2], double deviation) {
  assert(gap[0] > 0 && gap[1] > 0 && deviation >= 0);
  const double root = std::sqrt(gap[0]) + std::sqrt(gap[1]);
  return root * root > 4 * deviation;
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
