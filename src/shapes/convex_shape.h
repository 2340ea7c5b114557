// SPDX-License-Identifier: BSD-3-Clause
//
// Convex shapes by their support functions.
#ifndef FCL_CCD_SHAPES_CONVEX_SHAPE_H
#define FCL_CCD_SHAPES_CONVEX_SHAPE_H

#include <cassert>
#include <optional>
#include <utility>
#include <vector>

#include "numerics/moving_vector.h"
#include "shapes/body_boxes.h"
#include "shapes/cores.h"

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
/// Queries are about cores; what is asked about the whole shape has the radius in it
/// already, and coreDistance() has it for pairs.
class ConvexShape {
 public:
  /// @param core  one of AnyCore
  template <typename OneCore>
  explicit ConvexShape(OneCore core, double radius = 0)
      : core_(std::move(core)), radius_(radius) {
    assert(radius >= 0);
    setBox();
  }

  /// @brief The hull of points.
  /// @pre there is a point; all are finite
  static ConvexShape hull(std::vector<Vec> points) {
    return ConvexShape(HullCore(std::move(points)));
  }
  /// @brief The points within `radius` of the edge of the z axis from -half_length to
  /// half_length.
  static ConvexShape capsule(double radius, double half_length) {
    return ConvexShape(EdgeCore(half_length), radius);
  }
  static ConvexShape cuboid(const Vec& half_sides) {
    return ConvexShape(BoxCore(half_sides));
  }
  static ConvexShape ellipsoid(const Vec& half_axes) {
    return ConvexShape(EllipsoidCore(half_axes));
  }
  static ConvexShape cone(double radius, double height) {
    return ConvexShape(ConeCore(radius, height));
  }
  static ConvexShape cylinder(double radius, double height) {
    return ConvexShape(CylinderCore(radius, height));
  }
  /// @brief A plane or a halfspace. It has no support function and no reach. Its box is
  /// its foot; the ball around that contains the other object.
  /// @param other_radius  how far from the origin of its frame the other object may come
  static ConvexShape flat(const FlatShape& flat, double other_radius);

  /// @brief All lengths times a power of two, with which none overflows or underflows.
  /// @param other_radius  of a flat, after that: as for flat()
  ConvexShape scaled(double factor, double other_radius) const;

  /// @brief The largest of the lengths that define it.
  double largestLength() const;

  /// @brief Null: another shape.
  const FlatShape* flat() const { return flat_ ? &*flat_ : nullptr; }

  /// @brief A point of the core that is farthest along a direction, up to rounding by
  /// 2^-50 of the size.
  Vec support(const Vec& direction) const;

  /// @brief The same, and the number of its piece.
  Vec support(const Vec& direction, int& piece) const;

  /// @brief The number of the piece of the core (struct Core) along a direction.
  int pieceAt(const Vec& direction) const;

  /// @brief The point of a piece that is farthest along a direction. support() is that of
  /// pieceAt().
  Vec supportOf(int piece, const Vec& direction) const;

  /// @brief The derivative of supportOf() along a change of the direction.
  Vec supportChange(int piece, const Vec& direction, const Vec& change) const;

  /// @brief Whether the derivative of a piece is not 0.
  bool isCurved() const;

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
  bool containsCenter() const;

  /// @brief Whether the core is a ball around the origin of its frame.
  bool isBall() const;
  /// @brief Whether the core is a body of revolution about axisOfRevolution(), an axis of
  /// its frame: 0, 1 or 2. A ball has any axis.
  bool isRound() const { return axisOfRevolution() >= 0; }
  int axisOfRevolution() const;

  /// @brief The middle of the box of the core.
  Vec center() const { return {box_.center[0], box_.center[1], box_.center[2]}; }

  /// @name The whole shape: the core and the radius
  /// @{

  /// @brief A box that contains the shape.
  BodyBox outerBox() const;
  /// @brief The radius of a ball around the center that contains the shape.
  double outerRadius() const { return box_.radius + radius_; }
  /// @brief The radius of a ball around the center inside of the shape, where a pose
  /// makes the lengths of the core shorter by this factor.
  double innerRadius(double factor) const;
  /// @brief The largest coordinate of the shape along a unit direction.
  double outerReach(const Vec& direction) const { return reach(direction) + radius_; }

  /// @}

 private:
  void setBox();

  AnyCore core_;
  /// Of a plane or halfspace, whose core has no points.
  std::optional<FlatShape> flat_;
  double radius_;
  BodyBox box_{};
  bool fills_box_{false};
};

/// @brief The distance of the cores at which the surfaces of two shapes are at a
/// distance. Null: what has no radius.
inline double coreDistance(const ConvexShape* a, const ConvexShape* b, double distance) {
  assert(!(distance < 0));
  return distance + (a ? a->radius() : 0) + (b ? b->radius() : 0);
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
