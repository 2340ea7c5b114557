// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_TEST_REPRODUCTION_PROXIMITY_H
#define FCL_TEST_REPRODUCTION_PROXIMITY_H

#include <vector>

#include "fcl/common/types.h"
#include "fcl/math/triangle.h"

namespace fcl {
namespace test {

/// @brief A vertex close to a triangle of which it is not a corner.
struct NearPair {
  int vertex;
  int triangle;
  /// Barycentric weights of the triangle's point closest to the vertex.
  Vector3<double> weights;
  /// Distance to that point in metres.
  double distance;
};

/// @brief Barycentric weights of the point of triangle abc closest to p.
Vector3<double> closestWeights(const Vector3<double>& p, const Vector3<double>& a,
                               const Vector3<double>& b, const Vector3<double>& c);

/// @brief All pairs of a vertex and a triangle that are closer than `distance` metres and
/// of which at least one is movable, ordered by triangle.
/// @param is_movable  one entry per vertex; a triangle is movable if its first corner is.
/// @param cell_size  edge of the hash grid's cells in metres. Any value is right; about
/// the length of an edge is fast.
std::vector<NearPair> findNearPairs(const std::vector<Vector3<double>>& vertices,
                                    const std::vector<Triangle>& triangles,
                                    const std::vector<char>& is_movable, double distance,
                                    double cell_size);

}  // namespace test
}  // namespace fcl

#endif
