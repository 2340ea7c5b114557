// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_BODIES_BODY_TOLERANCE_H
#define FCL_CCD_BODIES_BODY_TOLERANCE_H

#include "bodies/moving_body.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief Bounds on the rounding in a query of two bodies, derived from the size of their
/// coordinates.
struct BodyTolerance {
  /// @brief The bounds for two bodies.
  /// @param distance  the distance at which bodies are in contact: of shapes that of
  /// their cores, coreDistance()
  BodyTolerance(const MovingBody& a, const MovingBody& b, double distance);

  /// Bound on the error of a distance between computed points along a unit direction.
  double position;
  /// The same for a relative velocity.
  double rate;
  /// Features that come within distance + touching count as contact.
  double touching;
  double distance;
  /// How much more than the distance of the surfaces that of the cores is.
  double radii;
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
