// SPDX-License-Identifier: BSD-3-Clause
//
// Boxes of points and of meshes in other positions.
#ifndef FCL_CCD_TREE_BOX_POSITION_H
#define FCL_CCD_TREE_BOX_POSITION_H

#include "mesh/moving_kdop.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief Box of a point relative to an origin, with `pad` for what was rounded before.
void fitPoint(const double* point, const double (&origin)[3], float pad, Kdop16& out);

/// @brief Where the boxes of a tree are in space: [frame][axis].
struct BoxPosition {
  /// What they are relative to.
  double origin[2][3];
  /// By which the mesh is moved on top.
  double translation[2][3];
  /// Of a RigidTree, as reach(); 0 of a MovingKdopTree, whose boxes have room for the
  /// rounding of what is relative to the origin.
  double reach;
};

/// @brief What to add to the sum of a box of one tree and one of another: outward by the
/// rounding of the numbers that make it, and of the moved coordinates themselves.
KdopShift relativeShift(const BoxPosition& a, const BoxPosition& b);

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
