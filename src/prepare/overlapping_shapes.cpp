// SPDX-License-Identifier: BSD-3-Clause
#include "prepare/overlapping_shapes.h"

#include <algorithm>
#include <cmath>

#include "curved/overlap_at_start.h"
#include "prepare/convex_shapes.h"
#include "prepare/prepared_motion.h"
#include "prepare/query_arguments.h"

namespace fcl {
namespace detail {
namespace {

using deformable::ConvexShape;

/// Paths of numbers up to this are in the range of PreparedMotion.
constexpr double kMostPlainSize = 0x1p40, kLeastPlainSize = 0x1p-140;

template <typename S>
bool isPlainSize(const PoseNumbers<S>& pose) {
  bool is_plain_size = true;
  for (const S x : pose.rotation) is_plain_size &= std::abs(x) <= S(kMostPlainSize);
  for (const S x : pose.translation) is_plain_size &= std::abs(x) <= S(kMostPlainSize);
  return is_plain_size;
}

/// Whether nothing about the path can be wrong: see PreparedMotion.
template <typename S>
bool isPlain(const MovingGeometry<S>& o) {
  const bool turns = o.path == PathKind::kTurn;
  if (!turns && o.path != PathKind::kStraight && o.path != PathKind::kScrew) return false;
  if (turns && (o.reference[0] != 0 || o.reference[1] != 0 || o.reference[2] != 0))
    return false;
  for (const PoseNumbers<S>& pose : o.pose)
    if (!isPlainSize(pose) || !isRotationAsGiven(pose.rotation) ||
        deformable::determinantOf(toPose(pose).rotation) <= 0)
      return false;
  return true;
}

/// Squares of sizes are in the range of doubles; a flat has no size that counts.
bool isPlainSize(const ConvexShape& shape) {
  if (const auto* flat = shape.flat()) return std::abs(flat->offset) <= kMostPlainSize;
  const double size = shape.outerRadius();
  return size >= kLeastPlainSize && size <= kMostPlainSize;
}

}  // namespace

template <typename S>
bool areOverlappingShapes(const MovingGeometry<S>& o1, const MovingGeometry<S>& o2) {
  using deformable::isConvexShape;
  using deformable::isUnbounded;
  if (!isConvexShape(*o1.geometry) || !isConvexShape(*o2.geometry) ||
      (isUnbounded(*o1.geometry) && isUnbounded(*o2.geometry)) || !isPlain(o1) ||
      !isPlain(o2))
    return false;
  try {
    const ConvexShape a = deformable::convexShapeOf(*o1.geometry, "o1", 0),
                      b = deformable::convexShapeOf(*o2.geometry, "o2", 0);
    return isPlainSize(a) && isPlainSize(b) &&
           deformable::overlapDeeplyAtStart(a, toPose(o1.pose[0]), b, toPose(o2.pose[0]));
  } catch (const Exception&) {
    // The query tells first what is wrong with the request.
    return false;
  }
}

template bool areOverlappingShapes(const MovingGeometry<double>&,
                                   const MovingGeometry<double>&);
template bool areOverlappingShapes(const MovingGeometry<float>&,
                                   const MovingGeometry<float>&);

}  // namespace detail
}  // namespace fcl
