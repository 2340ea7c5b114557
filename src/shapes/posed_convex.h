// SPDX-License-Identifier: BSD-3-Clause
//
// Convex sets in their places, and what is known of the gap of two.
#ifndef FCL_CCD_SHAPES_POSED_CONVEX_H
#define FCL_CCD_SHAPES_POSED_CONVEX_H

#include "mesh/vertex_frames.h"
#include "shapes/convex_shape.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief A convex set at a time, in the world: the core of a shape or a box in its pose,
/// or a triangle.
struct PosedConvex {
  /// If both are null: a triangle.
  const ConvexShape* shape;
  const BodyBox* box;
  Pose pose;
  Vec corner[3];

  /// @brief A farthest point along a direction.
  /// @param[out] piece  as pieceAt() of the direction; of a box 0
  Vec support(const Vec& direction, int& piece) const;

  /// @brief The piece of its support function along a direction: of a triangle a corner,
  /// of a shape ConvexShape::pieceAt().
  /// @pre it is no box
  int pieceAt(const Vec& direction) const;

  /// @brief The point of a piece that is farthest along a direction.
  /// @pre it is no box
  Vec supportOf(int piece, const Vec& direction) const;

  /// @brief The second derivatives of a piece of the support function along two axes, as
  /// the entries 00, 01 and 11 of a matrix.
  void setCurvature(int piece, const Vec& direction, const Vec (&axis)[2],
                    double (&out)[3]) const;

  bool isCurved() const { return shape && shape->isCurved(); }

  /// @brief The largest coordinate along a direction.
  double reach(const Vec& direction) const;

  /// @brief The direction among the axes of the shape's box, or the normal of the
  /// triangle, that is nearest to a direction up to its sign. Flat sides are at right
  /// angles to one. Not a unit vector.
  Vec flatNormal(const Vec& direction) const;
};

/// @brief Up to three pairs of corners, one of each set, whose differences hold that of
/// the nearest points. A search in a moment near to this one begins with them.
struct NearestCorners {
  int count;
  int corner[3][2];
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
  /// None of curved sets.
  NearestCorners nearest;
};

/// @brief How deep the sets overlap, at least; negative: how far they are apart, at most.
/// (They overlap by at most -gap.gap.)
inline double overlapOf(const ConvexGap& gap) {
  return gap.depth > 0 ? gap.depth : -gap.distance;
}

/// @brief How deep the origin is inside a tetrahedron, less what its faces round by; 0 if
/// it is not inside by more.
/// @param[out] weight  of the corners whose mean the origin is, if it is inside
double depthInside(const Vec (&corner)[4], double (&weight)[4]);

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
