// SPDX-License-Identifier: BSD-3-Clause
//
// Many pairs of triangles, shapes and cells that one direction keeps apart.
#ifndef FCL_CCD_BODIES_PARTING_DIRECTION_H
#define FCL_CCD_BODIES_PARTING_DIRECTION_H

#include <cstdint>
#include <memory>
#include <utility>

#include "base/slot_cache.h"
#include "bodies/body_tolerance.h"
#include "bodies/moving_body.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief The direction along which a pair of triangles, shapes or cells of two bodies
/// touches first. Where a flat part of a body comes to lie on a flat part of the other
/// one, thousands of pairs touch at that time, up to rounding, and the same direction
/// parts all of them until then.
class PartingDirection {
 public:
  /// @param tolerance  its distance is that of the cores
  PartingDirection(const MovingBody& a, const MovingBody& b,
                   const BodyTolerance& tolerance);

  /// @param direction  from a to b, in the world; 0: none is known
  void set(const Vec& direction);

  /// @brief The gaps of two parts along the direction at two times, less the distance of
  /// contact and the bound on their rounding. A gap is the least coordinate of a point of
  /// b minus the greatest one of a. Beside a plane or a halfspace the direction is its
  /// normal, which turns with it.
  /// @return whether both are positive; false if too many triangles are to be looked at
  bool areApart(const BodyPart& a, const BodyPart& b, const double (&t)[2],
                double (&gap)[2]);

 private:
  /// The poses of both bodies at a time.
  struct Poses {
    Pose body[2];
  };
  Poses posesAt(double t) const;
  bool isBelowFlat(const Poses& poses) const;
  Vec directionAt(const Poses& poses, bool is_below) const;
  double gapAt(double t, const BodyPart& a, const BodyPart& b, const Poses& poses,
               const Vec& direction);
  double reachOf(int k, const BodyPart& part, double t, const Vec& in_body);
  void forgetReaches();

  const MovingBody* body_[2];
  /// The body that is a plane or a halfspace; -1: none.
  int flat_{-1};
  double margin_;
  Vec direction_{0, 0, 0};
  /// How many triangles may be looked at. Each one that is not needed thanks to a gap
  /// makes room for others, so that the time is at most in proportion to that of the
  /// query without this. The first ones cost less than the pieces of work before.
  std::int64_t room_{1024};
  /// What is known of nodes of meshes: a node is met in many pairs, most of them with the
  /// same times. Null: nothing.
  static constexpr int kSlotBits = 8;
  using Reaches = SlotCache<std::pair<std::int32_t, double>, double, 1 << kSlotBits>;
  std::unique_ptr<Reaches> known_[2];
  /// The side of a plane for which they are known: see isBelowFlat().
  bool known_below_{false};
};

/// @brief Whether a gap stays positive. The deviation must be larger than its bound by
/// more than 2^-49 of it, for the rounding of this.
/// @param gap  positive, at the beginning and at the end of a span
/// @param deviation  the largest distance from a straight line, in the middle of the
/// span, that a bound on its second derivative allows
bool staysPositive(const double (&gap)[2], double deviation);

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
