// SPDX-License-Identifier: BSD-3-Clause
//
// How far each vertex may move from its place at t = 1 before any two features can come
// within a distance.
#ifndef FCL_CCD_QUERY_SAFE_DISPLACEMENT_H
#define FCL_CCD_QUERY_SAFE_DISPLACEMENT_H

#include <vector>

#include "tree/mesh_instance.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief Lowers the bounds of the vertices so that, if no vertex moves further than its
/// bound, all VF and EE pairs stay further apart than min_distance. Vertices of a pair
/// that may be within min_distance already get 0.
/// @param a, b  one object twice: the pairs of a mesh with itself
/// @param most  finite, above 0: bounds that are larger are not needed
/// @param bounds_a, bounds_b  one for each vertex, at most `most`; a single vector for
/// one mesh
/// @pre a and b have owners
/// @throws NonFiniteVertex
void lowerToSafe(const MeshInstance& a, const MeshInstance& b, double min_distance,
                 double most, std::vector<double>& bounds_a,
                 std::vector<double>& bounds_b);

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
