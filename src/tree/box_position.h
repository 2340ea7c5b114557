// SPDX-License-Identifier: BSD-3-Clause
//
// Boxes of points and of meshes in other positions.
#ifndef FCL_CCD_TREE_BOX_POSITION_H
#define FCL_CCD_TREE_BOX_POSITION_H

#include "mesh/moving_kdop.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief Box of a point relative to an origin. `pad` is a bound on earlier rounding.
void fitPoint(const double* point, const double (&origin)[3], float pad, Kdop16& out);

/// @brief Where the boxes of a tree are in space: [frame][axis].
struct BoxPosition {
  /// The point that the boxes are relative to.
  double origin[2][3];
  /// The translation of the mesh, in addition.
  double translation[2][3];
  /// RigidTree::largestCoordinate() of a RigidTree. 0 for a MovingKdopTree: its boxes
  /// contain the rounding of coordinates relative to the origin.
  double largest_coordinate;
};

/// @brief The shift that is added to the sum of a box of tree a and a box of tree b. It
/// is rounded outward: by the rounding of its own computation, and of the moved
/// coordinates.
KdopShift relativeShift(const BoxPosition& a, const BoxPosition& b);

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
