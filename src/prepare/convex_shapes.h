// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_PREPARE_CONVEX_SHAPES_H
#define FCL_CCD_PREPARE_CONVEX_SHAPES_H

#include <string>

#include "fcl/geometry/collision_geometry.h"
#include "shapes/convex_shape.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief Whether convexShapeOf() knows the geometry: one of FCL's ten shapes. A class of
/// the program is known by its node type, as in FCL.
template <typename S>
bool isConvexShape(const CollisionGeometry<S>& geometry);

/// @brief Whether the shape is a plane or a halfspace.
template <typename S>
bool isUnbounded(const CollisionGeometry<S>& shape);

/// @brief One of FCL's shapes.
/// @param name  the name of the shape in errors, for example "o1"
/// @param other_radius  of a plane or halfspace: how far from the origin of its frame the
/// other object may come
/// @throws fcl::Exception  it is not isConvexShape(), a size is negative or not finite, a
/// convex has no vertices, or a plane has no direction
template <typename S>
ConvexShape convexShapeOf(const CollisionGeometry<S>& shape, const std::string& name,
                          double other_radius);

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
