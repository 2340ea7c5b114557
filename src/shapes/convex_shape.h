// SPDX-License-Identifier: BSD-3-Clause
//
// Convex shapes by their support functions.
#ifndef FCL_CCD_SHAPES_CONVEX_SHAPE_H
#define FCL_CCD_SHAPES_CONVEX_SHAPE_H

#include <vector>

#include "numerics/moving_vector.h"
#include "shapes/body_boxes.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief A plane in the frame of its body, all x with normal . x = offset; or the
/// halfspace below it. The normal is a unit vector, up to rounding.
struct FlatShape {
  Vec normal;
  double offset;
  bool is_solid;

  /// The point of the plane that is nearest to the origin.
  Vec foot() const { return offset * normal; }
};

/// @brief A convex solid in the frame of its body: all points within `radius` of a core.
/// The core of a sphere is a point, that of a capsule an edge.
class ConvexShape {
 public:
  /// @brief The hull of points.
  /// @pre there is a point; all are finite
  static ConvexShape hull(std::vector<Vec> points);
  /// @brief The points within `radius` of the edge of the z axis from -half_length to
  /// half_length.
  static ConvexShape capsule(double radius, double half_length);
  /// @brief From minus these sizes to these sizes.
  static ConvexShape cuboid(const Vec& half_sides);
  /// @brief All points with (x / a)^2 + (y / b)^2 + (z / c)^2 <= 1.
  static ConvexShape ellipsoid(const Vec& half_axes);
  /// @brief Around the z axis, from the base at -height / 2 to the tip at height / 2.
  static ConvexShape cone(double radius, double height);
  /// @brief Around the z axis, from -height / 2 to height / 2.
  static ConvexShape cylinder(double radius, double height);
  /// @brief A plane or a halfspace. It has no support function and no reach. Its box is
  /// its foot; the ball around that contains the other object.
  /// @param reach  how far from the origin of its frame the other object may come
  static ConvexShape flat(const FlatShape& flat, double reach);

  /// @brief All lengths times a power of two, with which none overflows or underflows.
  /// @param reach  of a flat, after that: as for flat()
  ConvexShape scaled(double factor, double reach) const;

  /// @brief The largest of the lengths that define it.
  double largestLength() const;

  /// @brief Null: another shape.
  const FlatShape* flat() const { return kind_ == Kind::kFlat ? &flat_ : nullptr; }

  /// @brief A point of the core that is farthest along a direction, up to rounding by
  /// 2^-50 of the size.
  Vec support(const Vec& direction) const;

  /// @brief The support function is the largest of those of smooth pieces: the points of
  /// a hull, the ends of a capsule, the corners of a box, all of an ellipsoid, the tip
  /// and the base of a cone, the ends of a cylinder. This is the number of the piece
  /// along a direction.
  int pieceAt(const Vec& direction) const;

  /// @brief The point of a piece that is farthest along a direction. support() is that of
  /// pieceAt().
  Vec supportOf(int piece, const Vec& direction) const;

  /// @brief The derivative of supportOf() along a change of the direction.
  Vec supportChange(int piece, const Vec& direction, const Vec& change) const;

  /// @brief Whether the derivative of a piece is not 0.
  bool isCurved() const {
    return kind_ == Kind::kEllipsoid || kind_ == Kind::kCone || kind_ == Kind::kCylinder;
  }

  /// @brief The largest coordinate of the core along a direction that is not longer than
  /// 2, up to rounding by 2^-49 of the size.
  double reach(const Vec& direction) const;

  /// @brief How far the shape stands out from its core.
  double radius() const { return radius_; }

  /// @brief A box that contains the core.
  const BodyBox& box() const { return box_; }

  /// @brief Whether the core is its box, up to the box's pad.
  bool fillsBox() const { return fills_box_; }

  /// @brief Whether the center is certainly a point of the core. That of a hull may be
  /// outside.
  bool containsCenter() const { return kind_ != Kind::kHull; }

  /// @brief Whether the core is a ball around the origin of its frame.
  bool isBall() const;
  /// @brief Whether the core is a body of revolution about axisOfRevolution(), an axis of
  /// its frame: 0, 1 or 2. A ball has any axis.
  bool isRound() const { return axisOfRevolution() >= 0; }
  int axisOfRevolution() const;

  /// @brief The radius of a ball around the center inside of the core; 0: none is known.
  double innerRadius() const;

  /// @brief The middle of the box of the core.
  Vec center() const { return {box_.center[0], box_.center[1], box_.center[2]}; }

 private:
  enum class Kind { kHull, kCapsule, kCuboid, kEllipsoid, kCone, kCylinder, kFlat };

  ConvexShape(Kind kind, const Vec& size) : kind_(kind), size_(size) {}
  void setBox(const Vec& center, const Vec& half_sides);
  void setBoxOfHull();
  bool hasCornersOfBox() const;

  Kind kind_;
  /// Half sides; half axes; or radius, radius and half height. Of a capsule that of the
  /// edge.
  Vec size_;
  FlatShape flat_{};
  std::vector<Vec> points_;
  double radius_{0};
  BodyBox box_{};
  bool fills_box_{false};
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
