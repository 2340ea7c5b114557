// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_ELEMENTARY_LEAST_DISTANCE_H
#define FCL_CCD_ELEMENTARY_LEAST_DISTANCE_H

#include "elementary/feature_points.h"
#include "numerics/error_bounds.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief Numbers of leastDistance(), which its vector form has too
/// (kernels/advance_kernels.cpp).
struct LeastDistance {
  /// A product of a direction with a corner is off by 5 u L, the corner by u L, and the
  /// direction is at most 1 + 5 u long: 16 u L and 8 u of the gap are more.
  static constexpr double kOfGap = 8 * kUnit, kOfSize = 16 * kUnit;
  /// Another direction could prove little more than this share of the distance.
  static constexpr double kEnough = 1 - 0x1p-40;
};

/// @brief A proved lower bound on the distance of two features; 0 if nothing is proved.
/// @param kind  kVertexFace, kEdgeEdge, kVertexEdge or kVertexVertex
/// @param x  paths whose both ends are the same
double leastDistance(ContinuousContactKind kind, const FeaturePoints& x);

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
