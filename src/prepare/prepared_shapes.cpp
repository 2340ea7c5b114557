// SPDX-License-Identifier: BSD-3-Clause
#include "prepare/prepared_shapes.h"

#include <utility>

#include "curved/overlap_at_start.h"
#include "prepare/convex_shapes.h"
#include "prepare/query_range.h"

namespace fcl {
namespace detail {
namespace {

using deformable::ConvexShape;
using deformable::convexShapeOf;

/// Whether the path of a shape begins in its first pose as it is given, and nothing about
/// the path has to be checked but its size.
template <typename S>
bool beginsAsGiven(const PlacedGeometry<S>& o) {
  if (!o.isShape() || !o.areRotations() || o.hasReplacedRotation()) return false;
  const MovingGeometry<S>& moving = o.moving();
  if (moving.path == PathKind::kTurn)
    return moving.reference[0] == 0 && moving.reference[1] == 0 &&
           moving.reference[2] == 0;
  return moving.path == PathKind::kStraight || moving.path == PathKind::kScrew;
}

}  // namespace

template <typename S>
bool areFoundToOverlap(const PlacedGeometry<S>& o1, const PlacedGeometry<S>& o2,
                       PreparedShapes& shapes) {
  if (!beginsAsGiven(o1) || !beginsAsGiven(o2)) return false;
  const int first = firstOf(o1), second = 1 - first;
  const PlacedGeometry<S>& object = first == 0 ? o1 : o2;
  const PlacedGeometry<S>& other = first == 0 ? o2 : o1;
  ConvexShape x = convexShapeOf(object.geometry(), nameOf(first), 0);
  // PreparedMotion refuses some of the others.
  if (!isWellInRange(object, x)) {
    shapes.shape[first].emplace(std::move(x));
    return false;
  }
  ConvexShape y = convexShapeOf(other.geometry(), nameOf(second), 0);
  if (isWellInRange(other, y) &&
      deformable::overlapDeeplyAtStart(x, object.beginning(), y, other.beginning()))
    return true;
  shapes.shape[first].emplace(std::move(x));
  shapes.shape[second].emplace(std::move(y));
  return false;
}

template bool areFoundToOverlap(const PlacedGeometry<double>&,
                                const PlacedGeometry<double>&, PreparedShapes&);
template bool areFoundToOverlap(const PlacedGeometry<float>&,
                                const PlacedGeometry<float>&, PreparedShapes&);

}  // namespace detail
}  // namespace fcl
