// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_PREPARE_OCTREE_NODES_H
#define FCL_CCD_PREPARE_OCTREE_NODES_H

#include <string>

#include "fcl/geometry/collision_geometry.h"
#include "shapes/octree_cells.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief Whether the geometry is an fcl::OcTree. FCL may be built without it.
template <typename S>
bool isOctree(const CollisionGeometry<S>& geometry);

/// @brief The cells of an octree that FCL calls occupied: leaves whose log odds reach the
/// octree's threshold, below nodes that reach it too. The octree must outlive them.
/// @param name  the name of the octree in errors, for example "o1"
/// @pre isOctree(geometry)
/// @throws fcl::Exception  its resolution is not positive or not finite
template <typename S>
OctreeCells octreeCellsOf(const CollisionGeometry<S>& geometry, const std::string& name);

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
