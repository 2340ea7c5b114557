// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_PREPARE_OVERLAPPING_SHAPES_H
#define FCL_CCD_PREPARE_OVERLAPPING_SHAPES_H

#include "fcl/narrowphase/detail/query_numbers.h"

namespace fcl {
namespace detail {

/// @brief Whether two shapes overlap at t = 0, as far as a look at their first poses
/// shows. Many programs ask about such pairs, and the rest of a query costs more.
/// @return false also where the query might throw for another reason than its request, or
/// might not be answered here
/// @pre the floating-point mode is the default one
template <typename S>
bool areOverlappingShapes(const MovingGeometry<S>& o1, const MovingGeometry<S>& o2);

}  // namespace detail
}  // namespace fcl

#endif
