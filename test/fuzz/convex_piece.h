// SPDX-License-Identifier: BSD-3-Clause
//
// Convex pieces in Real, and bounds on their distance. No code of the library.
#ifndef FCL_FUZZ_CONVEX_PIECE_H
#define FCL_FUZZ_CONVEX_PIECE_H

#include <functional>
#include <vector>

#include "real.h"

namespace fcl {
namespace test {

/// @brief A convex core, and all points within a radius of it, in the frame of a body.
struct ConvexPiece {
  enum class Kind { kPoints, kEllipsoid, kCone, kCylinder, kPlane, kHalfspace };
  Kind kind{Kind::kPoints};
  /// Points whose hull it is, at t = 0 and at t = 1.
  std::vector<RealVector> t0, t1;
  /// Half axes; or radius and half height around the z axis.
  RealVector size{RealVector::Zero()};
  Real radius{0};
  /// Of planes and halfspaces.
  RealVector normal{RealVector::Zero()};
  Real offset{0};

  bool isFlat() const { return kind == Kind::kPlane || kind == Kind::kHalfspace; }
  /// @brief The largest distance of its points from the origin of the frame; of a flat
  /// the distance of its foot.
  Real reach() const;
};

/// @brief A piece at a time.
struct PosedPiece {
  const ConvexPiece* piece;
  RealMatrix rotation;
  RealVector translation;
  Real t;

  /// @brief A farthest point of the core along a direction of the world.
  RealVector support(const RealVector& direction) const;
};

/// @brief The distance of two pieces is between these; both are 0 if they overlap. The
/// lower bound is that along a direction, the upper one that of two points.
struct GapBounds {
  Real lower, upper;
};
GapBounds gapBounds(const PosedPiece& a, const PosedPiece& b);

/// @brief The bounds of a pair at a time.
using GapAt = std::function<GapBounds(Real)>;

/// @brief What samples of the step find.
struct Sampled {
  /// A time at which the two are certainly within the distance, the first one that was
  /// found; 2 without.
  Real first{2};
  /// The least upper bound on their distance, and its time.
  Real least, least_at;
};

/// @brief Samples a step: the time between two of them is short where the pieces are
/// near. The least distances are refined.
/// @param speed  about how fast the two approach; only the number of samples depends on
/// it
Sampled sampleStep(const GapAt& gap, Real speed, Real distance);

}  // namespace test
}  // namespace fcl

#endif
