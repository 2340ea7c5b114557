// SPDX-License-Identifier: BSD-3-Clause
//
// Two features as one set: the differences of their points, a convex polygon of one to
// four corners. Its distance from the origin is the distance of the features. The corners
// move on straight lines as the vertices do.
#ifndef FCL_CCD_ELEMENTARY_NEAREST_POINT_H
#define FCL_CCD_ELEMENTARY_NEAREST_POINT_H

#include <cassert>
#include <cmath>

#include "elementary/feature_points.h"
#include "numerics/moving_vector.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief The points of a pair whose difference a corner is.
struct CornerPoints {
  int first, second;
};

/// @brief The differences of the points of two features, second minus first. In a circle:
/// VF f_k - v; EE b0 - a0, b1 - a0, b1 - a1, b0 - a1; VE e_k - v; VV one point.
class DifferencePolygon {
 public:
  static constexpr int kMaxCorners = 4;

  /// @param kind  kVertexFace, kEdgeEdge, kVertexEdge or kVertexVertex
  DifferencePolygon(ContinuousContactKind kind, const FeaturePoints& x);

  int count() const { return count_; }
  /// @brief The number of sides; a segment has one, a point none.
  int sides() const { return count_ > 2 ? count_ : count_ - 1; }
  int next(int corner) const {
    assert(isCorner(corner));
    return corner + 1 < count_ ? corner + 1 : 0;
  }
  const Vec& t0(int corner) const {
    assert(isCorner(corner));
    return t0_[corner];
  }
  const Vec& t1(int corner) const {
    assert(isCorner(corner));
    return t1_[corner];
  }
  Vec at(int corner, double t) const { return (1 - t) * t0(corner) + t * t1(corner); }

  /// @brief Bound on the length of every corner, at every time; not right if squares of
  /// lengths leave the range of double.
  double size() const { return size_; }

  /// @brief The points whose difference the corner is, as numbers in FeaturePoints.
  static CornerPoints pointsOf(ContinuousContactKind kind, int corner);

 private:
  bool isCorner(int corner) const { return 0 <= corner && corner < count_; }
  bool isSizeBound() const;
  void add(const VertexPath& from, const VertexPath& to);

  int count_{0};
  Vec t0_[kMaxCorners], t1_[kMaxCorners];
  double size_{0};
};

/// @brief The point of a polygon that is nearest to the origin, up to rounding.
struct NearestPoint {
  Vec point;
  double square;  ///< of its distance
  double distance;
  /// The side that it is on, or the corner that it is; both -1: neither.
  int side{-1}, corner{-1};
  /// The point is corner 0 plus `along` times the way to the next corner plus `across`
  /// times the way to the last corner (inside); the corner where the side begins plus
  /// `along` times the side (on a side).
  double along{0}, across{0};
  /// Inside: perpendicular to the polygon.
  Vec normal;
};

/// @brief Whether n is a unit vector, up to rounding, or zero: no direction was found. A
/// NaN, of lengths that overflow, is none that proves anything.
inline bool isDirection(const Vec& n) {
  return !(std::abs(dot(n, n) - 1) > 0x1p-46) || (n.x == 0 && n.y == 0 && n.z == 0);
}

/// A polygon with a square of its area below this share of those of its sides is a
/// sliver: rounding is large there.
constexpr double kSliver = 0x1p-20;

/// @param corners  at one time
NearestPoint nearestPoint(const DifferencePolygon& polygon, const Vec* corners);

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
