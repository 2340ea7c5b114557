// SPDX-License-Identifier: BSD-3-Clause
//
// A body that passes through poses at given times. Between two of them, s goes from 0 to
// 1 and the origin of the body follows a cubic with given velocities at both ends
// (Hermite). The rotation is a product of three turns about fixed axes (Kim, Kim and Shin
// 1995, "A General Construction Scheme for Unit Quaternion Curves with Simple High Order
// Derivatives"),
//
//   R(s) = R0 exp(b1 [w1]) exp(b2 [w2]) exp(b3 [w3]),
//   b1 = 1 - (1 - s)^3,  b2 = 3 s^2 - 2 s^3,  b3 = s^3.
//
// Its angular velocity is 3 w1 at s = 0 and 3 w3 at s = 1, seen from the body. So w1 and
// w3 follow from the angular velocities at the waypoints, and w2 from R(1).
//
// This is the motion of a chain of three prismatic and three revolute joints whose values
// are cubics. So each piece is the motion of a link (chain_path.h).
//
// The velocity at a waypoint is the mean of those of the pieces beside it that Fritsch
// and Butland use (1984, "A Method for Constructing Local Monotone Piecewise Cubic
// Interpolants"), for each coordinate: between both, and 0 if one of them is 0 or they
// have opposite signs. No coordinate goes beyond its values at the ends of a piece.
#ifndef FCL_CCD_PATHS_WAYPOINT_PATH_H
#define FCL_CCD_PATHS_WAYPOINT_PATH_H

#include <cstddef>
#include <vector>

#include "fcl/math/motion/bounded_motion.h"
#include "paths/chain_path.h"
#include "paths/quaternion.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief The least time between two waypoints. Rounding of velocities grows with its
/// inverse.
constexpr double kLeastPieceTime = 0x1p-16;

class WaypointPath : public BoundedMotion {
 public:
  /// @param times  of the poses: from 0 to 1, at least kLeastPieceTime apart
  /// @pre at least two poses, which are rotations up to 2^-47
  WaypointPath(const std::vector<Pose>& poses, const std::vector<double>& times);

  Placement placementAt(double t) const override;
  Placement rateAt(double t) const override;
  double accelerationBound(const double (&center)[3], double radius, double t0,
                           double t1) const override;
  double angularSpeedBound(double t0, double t1) const override;
  Rounding moreRounding() const override { return rounding_; }

 private:
  /// The path between two waypoints, for s from 0 to 1.
  struct Piece {
    double begin, duration;
    LinkPath path;
    /// Of R and T, by s.
    DerivativeBounds rotation, translation;
    /// How far the turns of the chain are from the exact ones; 0: it does not turn.
    double turn_error;
    /// Size of the terms of the cubics, which round.
    double size;

    double atTime(double t) const { return (t - begin) / duration; }
    Rounding rounding() const;
  };
  /// A pose with its time and its velocities.
  struct Waypoint {
    double t;
    Vec position;
    Quaternion rotation;
    /// Of the origin, in the world; and seen from the body.
    Vec velocity{0, 0, 0}, angular_velocity{0, 0, 0};
  };

  static std::vector<Waypoint> waypointsOf(const std::vector<Pose>& poses,
                                           const std::vector<double>& times);
  static Piece makePiece(const Waypoint& x, const Waypoint& y);
  const Piece& pieceAt(double t) const;
  /// The largest bound of the pieces that a span meets.
  template <typename Bound>
  double largest(double t0, double t1, const Bound& bound) const;

  std::vector<Piece> pieces_;
  Rounding rounding_{0, 0, 0, 0};
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
