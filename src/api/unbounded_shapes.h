// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_API_UNBOUNDED_SHAPES_H
#define FCL_CCD_API_UNBOUNDED_SHAPES_H

#include "api/query_arguments.h"
#include "motion/shape_contacts.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief Two planes, two halfspaces, or one of each. They meet at once unless they are
/// parallel during the whole step, which means here: up to 2^-48, and no rotation
/// changes.
/// @pre both are isUnbounded(); the poses are finite
/// @throws fcl::Exception  as convexShapeOf() and requireRotations()
template <typename S>
ShapeAnswer queryUnbounded(const PlacedGeometry<S>& o1, const PlacedGeometry<S>& o2,
                           const QueryOptions& options);

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
