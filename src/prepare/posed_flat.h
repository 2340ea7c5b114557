// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_PREPARE_POSED_FLAT_H
#define FCL_CCD_PREPARE_POSED_FLAT_H

#include "curved/flat_contacts.h"
#include "prepare/query_arguments.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief A plane or a halfspace in its place.
/// @param name  of the object, for errors
/// @pre it is isUnbounded(); the poses are finite
/// @throws fcl::Exception  as convexShapeOf() and requireRotations()
template <typename S>
PosedFlat posedFlatOf(const PlacedGeometry<S>& placed, const char* name);

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
