// SPDX-License-Identifier: BSD-3-Clause
//
// How far two convex sets are apart, and in which direction (Gilbert, Johnson, Keerthi
// 1988). A direction proves a gap; the nearest points only propose one.
#ifndef FCL_CCD_MOTION_CONVEX_DISTANCE_H
#define FCL_CCD_MOTION_CONVEX_DISTANCE_H

#include "mesh/vertex_frames.h"
#include "motion/convex_shape.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief A convex set at a time, in the world: the core of a shape or a box in its pose,
/// or a triangle.
struct PosedConvex {
  /// If both are null: a triangle.
  const ConvexShape* shape;
  const MotionBox* box;
  Pose pose;
  Vec corner[3];

  /// @brief A farthest point along a direction.
  /// @param[out] id  of a triangle: the number of the corner
  Vec support(const Vec& direction, int& id) const;

  /// @brief The largest coordinate along a direction.
  double reach(const Vec& direction) const;

  /// @brief The direction among the axes of the shape's box, or the normal of the
  /// triangle, that is nearest to a direction up to its sign. Flat sides are at right
  /// angles to one. Not a unit vector.
  Vec flatNormal(const Vec& direction) const;
};

/// @brief The distance of two convex sets.
struct ConvexGap {
  /// A unit direction from a to b, or 0; and the gap along it: b's least minus a's
  /// greatest coordinate. The sets are not nearer than that.
  Vec direction;
  double gap;
  /// The distance of a point of a from a point of b, and the points. 0 if the sets are
  /// found to overlap.
  double distance;
  Vec point[2];
  /// The corners of a triangle whose hull contains the point, as bits.
  unsigned corners[2];
  /// How deep the origin is inside the simplex that shows that the sets overlap; 0: there
  /// is none.
  double depth;
};

/// @brief Finds the gap of two convex sets.
/// @param guess  a direction from a to b
/// @param enough  ends when the gap minus this distance is at least half of the distance
/// of the points minus this distance. 0 or more.
/// @param contact  ends when the points are not further apart than this
ConvexGap convexGap(const PosedConvex& a, const PosedConvex& b, const Vec& guess,
                    double enough, double contact);

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
