// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_PREPARE_PREPARED_SHAPES_H
#define FCL_CCD_PREPARE_PREPARED_SHAPES_H

#include <cassert>

#include "curved/overlap_at_start.h"
#include "prepare/convex_shapes.h"
#include "prepare/query_arguments.h"
#include "prepare/query_range.h"

namespace fcl {
namespace detail {

/// @brief What two objects were converted to, to be taken; null: it was not, or it is no
/// shape.
struct PreparedShapes {
  deformable::ConvexShape* shape[2]{nullptr, nullptr};
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

/// @brief Whether the path of a shape begins in its first pose as it is given, and
/// nothing about the path has to be checked but its size.
template <typename S>
bool beginsAsGiven(const PlacedGeometry<S>& o) {
  if (!o.isShape() || !o.areRotations() || o.hasReplacedRotation()) return false;
  const MovingGeometry<S>& moving = o.moving();
  if (moving.path == PathKind::kTurn)
    return moving.reference[0] == 0 && moving.reference[1] == 0 &&
           moving.reference[2] == 0;
  return moving.path == PathKind::kStraight || moving.path == PathKind::kScrew;
}

/// @brief Looks at the first poses of two objects. Many programs ask about shapes that
/// overlap at t = 0, and the rest of a query costs more.
/// @param otherwise  called with PreparedShapes when nothing is known yet
/// @return whether they are known to overlap; if not, `otherwise` was called
/// @pre one of them is bounded; the poses are finite; the floating-point mode is the
/// default one
/// @throws fcl::Exception  as PreparedMotion
template <typename S, typename Otherwise>
bool areFoundToOverlap(const PlacedGeometry<S>& o1, const PlacedGeometry<S>& o2,
                       const Otherwise& otherwise) {
  using deformable::ConvexShape;
  using deformable::convexShapeOf;
  assert(!deformable::isUnbounded(o1.geometry()) ||
         !deformable::isUnbounded(o2.geometry()));
  PreparedShapes shapes;
  if (!beginsAsGiven(o1) || !beginsAsGiven(o2)) {
    otherwise(shapes);
    return false;
  }
  const int first = firstOf(o1), second = 1 - first;
  const PlacedGeometry<S>&object = first == 0 ? o1 : o2, &other = first == 0 ? o2 : o1;
  ConvexShape x = convexShapeOf(object.geometry(), nameOf(first), 0);
  shapes.shape[first] = &x;
  // PreparedMotion refuses some of the others.
  if (!isWellInRange(object, x)) {
    otherwise(shapes);
    return false;
  }
  ConvexShape y = convexShapeOf(other.geometry(), nameOf(second), 0);
  shapes.shape[second] = &y;
  if (isWellInRange(other, y) &&
      deformable::overlapDeeplyAtStart(x, object.beginning(), y, other.beginning()))
    return true;
  otherwise(shapes);
  return false;
}

}  // namespace detail
}  // namespace fcl

#endif
