// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_PREPARE_PREPARED_SHAPES_H
#define FCL_CCD_PREPARE_PREPARED_SHAPES_H

#include <optional>

#include "prepare/query_arguments.h"
#include "shapes/convex_shape.h"

namespace fcl {
namespace detail {

/// @brief What two objects were converted to; empty: it was not, or it is no shape.
struct PreparedShapes {
  std::optional<deformable::ConvexShape> shape[2];
};

/// @brief Which of two objects is prepared first: 0 or 1. The part of an unbounded shape
/// that matters depends on the other object.
/// @pre one of them is bounded, no plane or halfspace
template <typename S>
int firstOf(const PlacedGeometry<S>& o1) {
  return deformable::isUnbounded(o1.geometry()) ? 1 : 0;
}

/// @brief "o1" or "o2", for errors.
inline const char* nameOf(int k) { return k == 0 ? "o1" : "o2"; }

/// @brief Whether two objects are shapes that overlap at t = 0, as far as a look at their
/// first poses shows. Many programs ask about such pairs, and the rest of a query costs
/// more.
/// @param[out] shapes  what was converted, if it is false
/// @pre one of them is bounded; the poses are finite; the floating-point mode is the
/// default one
/// @throws fcl::Exception  as PreparedMotion
template <typename S>
bool areFoundToOverlap(const PlacedGeometry<S>& o1, const PlacedGeometry<S>& o2,
                       PreparedShapes& shapes);

}  // namespace detail
}  // namespace fcl

#endif
