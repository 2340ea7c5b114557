// SPDX-License-Identifier: BSD-3-Clause
//
// What the cores of convex shapes have in common.
#ifndef FCL_CCD_SHAPES_CORE_H
#define FCL_CCD_SHAPES_CORE_H

#include <algorithm>
#include <cassert>
#include <cmath>

#include "numerics/moving_vector.h"
#include "shapes/body_boxes.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief The box around a core, whose sides are parallel to the axes of its frame.
struct CoreBox {
  Vec center, half_sides;
};

/// @brief What a core has unless it has its own. A core is a convex set of points, given
/// by its support function, which is the largest of those of smooth pieces. Each one also
/// has:
///  - `int pieceAt(d)`: the number of the piece along a direction;
///  - `Vec supportOf(piece, d)`: the point of that piece that is farthest along it;
///  - `double reach(d)`: the coordinate of that point along the direction, up to rounding
///    by 2^-49 of the size, if the direction is not longer than 2.
struct Core {
  /// @param half_sides  0 or more
  explicit Core(const Vec& half_sides) : size(half_sides) {
    assert(size.x >= 0 && size.y >= 0 && size.z >= 0);
  }

  /// Half the sides of the box, which is around the origin.
  Vec size;

  CoreBox box() const { return {{0, 0, 0}, size}; }
  /// Whether the core is its box, up to the box's pad.
  bool fills(const BodyBox&) const { return false; }
  /// Whether the center of the box is certainly a point of the core.
  bool containsCenter() const { return true; }

  /// Whether the derivative of a piece is not 0; and this derivative, along a change of
  /// the direction.
  bool isCurved() const { return false; }
  Vec supportChange(int, const Vec&, const Vec&) const { return {0, 0, 0}; }

  /// Whether it is a ball around the origin; and 0, 1 or 2 if it is a body of revolution
  /// about this axis of its frame, else -1.
  bool isBall() const { return false; }
  int axisOfRevolution() const { return -1; }
  /// The radius of a ball around the center inside of the core; 0: none is known.
  double innerRadius() const { return 0; }

  double largestLength() const { return maxNorm(size); }
  void scale(double factor) { size = factor * size; }
};

/// @brief As norm(), also where squares are too small or too large for doubles.
inline double anyNorm(const Vec& v) {
  const double square = dot(v, v);
  return square > 0x1p-900 && square < 0x1p900 ? std::sqrt(square)
                                               : std::hypot(v.x, v.y, v.z);
}

/// @brief The farthest point of a circle around the z axis; and its coordinate, if the
/// circle is in the plane of the origin.
inline Vec onCircle(double radius, double height, const Vec& d) {
  assert(radius >= 0);
  const double length = anyNorm({d.x, d.y, 0});
  if (!(length > 0)) return {0, 0, height};
  return {radius * (d.x / length), radius * (d.y / length), height};
}
inline double circleReach(double radius, const Vec& d) {
  return radius * anyNorm({d.x, d.y, 0});
}

/// @brief The derivative of the farthest point of an ellipsoid; of a circle if the scale
/// along z is 0.
inline Vec changeOnEllipsoid(const Vec& scale, const Vec& d, const Vec& change) {
  // The derivative of a unit vector, between two changes of scale.
  const Vec along = {scale.x * d.x, scale.y * d.y, scale.z * d.z},
            moved = {scale.x * change.x, scale.y * change.y, scale.z * change.z};
  const double length = anyNorm(along);
  if (!(length > 0)) return {0, 0, 0};
  const Vec n = (1 / length) * along, across = moved - dot(n, moved) * n;
  return {scale.x * (across.x / length), scale.y * (across.y / length),
          scale.z * (across.z / length)};
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
