// SPDX-License-Identifier: BSD-3-Clause
//
// Contact at a distance: what boxes are enlarged by, and the contact of a pair of
// features that comes near enough.
#ifndef FCL_CCD_QUERY_DISTANCE_CONTACT_H
#define FCL_CCD_QUERY_DISTANCE_CONTACT_H

#include <cstddef>
#include <limits>
#include <vector>

#include "elementary/distance_advance.h"
#include "kernels/kernels.h"
#include "mesh/moving_kdop.h"
#include "query/contact_sink.h"
#include "tree/mesh_instance.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief Pairs of features that stay further apart are no contacts at a distance of d.
/// Infinity where the size of the meshes is beyond the range of double.
double cullDistanceOf(const MeshInstance& a, const MeshInstance& b, double d);

/// @brief Adds a distance to what is added to boxes: boxes that come within it overlap.
void enlarge(double cull_distance, KdopShift& shift);

/// @brief How near features have to be at t = 0 to matter to a query, and what is added
/// to boxes of mesh a, so that boxes of features that are as near overlap.
///
/// Where pairs that are nearer than d at t = 0 are ignored, a pair is in contact when it
/// comes nearer than it is then, by more than a share of its distance. In the beginning
/// of a step only pairs that nearly touch do: the others need more time.
class BoxShifts {
 public:
  /// @brief Without a distance.
  /// @param between  relativeShift(a, b); null for a mesh with itself
  explicit BoxShifts(const KdopShift* between = nullptr);
  /// @param distance  0: features that touch
  BoxShifts(const MeshInstance& a, const MeshInstance& b, const KdopShift* between,
            double distance, bool ignores_initially_closer);

  /// @brief Moves all boxes so far apart at t = 0 that those which overlap at some time
  /// do so at t = 1, except for boxes of extreme size. So pairs that are near at an
  /// earlier time only are left out.
  /// @pre initially closer pairs are not ignored, and the query looks at the whole step
  void leaveOutStart();

  /// @brief Whether nothing is added.
  bool isEmpty() const { return is_empty_; }
  /// @brief Features further apart at t = 0 have no contact until `latest`, which comes
  /// from here on.
  double cullDistance(double latest) const;
  /// @param cull_distance  of cullDistance()
  KdopShift shift(double cull_distance) const;

 private:
  bool is_empty_;
  KdopShift between_{};
  double cull_distance_{0}, almost_{0};
  /// Infinity: the distance is always the same.
  double speed_{std::numeric_limits<double>::infinity()};
};

/// @brief The contact of a pair: of the features that are nearest at its time. Their
/// vertices have ascending ids; those that are not used have the largest number.
/// @param pair  a pair and the triangles that the contact names
/// @param is_self  a vertex and an edge are named with the vertex on mesh a, of two
/// vertices the one with the lower id
FeatureContact contactOf(const FeatureIds& pair, const DistanceContact& found,
                         bool is_self);

PointIds idsOf(const FeatureIds& pair);

/// @brief The contact of a VF or EE pair, as advanceToDistance() has it.
/// @param found  with the answer kYes
DistanceContact contactOf(ContinuousContactKind kind, const Approach& found);

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
