// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_ELEMENTARY_SCALED_POINTS_H
#define FCL_CCD_ELEMENTARY_SCALED_POINTS_H

#include "elementary/feature_points.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief The points of a pair times a power of two, with which the largest of its
/// lengths is about 1. For pairs whose squares and products of lengths would leave the
/// range of doubles.
///
/// If the size is not finite, the coordinates are near the largest number. If it is tiny,
/// so are the coordinates, since differences of doubles are multiples of their units;
/// or else all points coincide at rest. What underflows is below 2^-850 of the size.
class ScaledPoints {
 public:
  /// @param distance  another length that counts
  /// @pre x is in the order of the polygon, and stays where it is
  ScaledPoints(ContinuousContactKind kind, const FeaturePoints& x, double distance);
  ScaledPoints(const ScaledPoints&) = delete;
  ScaledPoints& operator=(const ScaledPoints&) = delete;

  const FeaturePoints& points() const { return points_; }
  double scale() const { return scale_; }

 private:
  VertexPath scaled_[4];
  FeaturePoints points_;
  double scale_;
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
