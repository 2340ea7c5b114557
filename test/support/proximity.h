// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_TEST_SUPPORT_PROXIMITY_H
#define FCL_TEST_SUPPORT_PROXIMITY_H

#include <vector>

#include "fcl/common/types.h"
#include "fcl/math/triangle.h"

namespace fcl {
namespace test {

/// @brief A vertex close to a triangle that it is no corner of.
struct NearPair {
  int vertex;
  int triangle;
  /// Barycentric weights of the triangle's point closest to the vertex.
  Vector3<double> weights;
  /// Distance to that point, metres.
  double distance;
};

/// @brief Barycentric weights of the point of triangle abc closest to p.
Vector3<double> closestWeights(const Vector3<double>& p, const Vector3<double>& a,
                               const Vector3<double>& b, const Vector3<double>& c);

/// @brief All vertex-triangle pairs closer than `distance` metres, ordered by triangle,
/// of which the vertex or the triangle is movable.
/// @param is_movable  one entry a vertex; a triangle is movable when its first corner is.
/// @param cell_size  edge of the hash grid's cells in metres; any value is right, about
/// the length of an edge is fast.
std::vector<NearPair> findNearPairs(const std::vector<Vector3<double>>& vertices,
                                    const std::vector<Triangle>& triangles,
                                    const std::vector<char>& is_movable, double distance,
                                    double cell_size);

}  // namespace test
}  // namespace fcl

#endif
