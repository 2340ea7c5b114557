// SPDX-License-Identifier: BSD-3-Clause
//
// How two convex sets that overlap can be parted by the least translation.
#ifndef FCL_CCD_SHAPES_PENETRATION_H
#define FCL_CCD_SHAPES_PENETRATION_H

#include "shapes/posed_convex.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief A translation of the second set that parts it from the first one: the sets have
/// no point in common, but for their borders, when b has moved by depth * direction.
struct Penetration {
  /// A unit vector.
  Vec direction;
  double depth;
};

/// @brief Finds the least translation that parts two sets that overlap. Its depth is
/// where the search ended; no other translation is shorter by more than 2^-14 of the size
/// of the sets, or 2^-34 if neither of them is curved. If very many directions are as
/// good as the best one up to that, the search stops before it has proved it.
/// @pre they overlap; none is a flat
Penetration penetrationOf(const PosedConvex& a, const PosedConvex& b);

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
