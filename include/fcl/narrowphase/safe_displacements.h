// SPDX-License-Identifier: BSD-3-Clause
//
// How far each vertex may move before surfaces can touch: a bound in place of continuous
// collision detection.
#ifndef FCL_NARROWPHASE_SAFE_DISPLACEMENTS_H
#define FCL_NARROWPHASE_SAFE_DISPLACEMENTS_H

#include <vector>

#include "fcl/narrowphase/continuous_collision.h"
#include "fcl/narrowphase/detail/query_numbers.h"

namespace fcl {

/// @brief Bounds for the vertices of two meshes, in the unit of the coordinates.
struct SafeDisplacements {
  std::vector<double> of_o1;
  std::vector<double> of_o2;
};

namespace detail {

template <typename S>
FCL_EXPORT void findSafeDisplacements(const MovingGeometry<S>& o1,
                                      const MovingGeometry<S>& o2,
                                      double max_displacement, double min_distance,
                                      SafeDisplacements& bounds);

template <typename S>
FCL_EXPORT void findSafeSelfDisplacements(const CollisionGeometry<S>* o,
                                          double max_displacement, double min_distance,
                                          std::vector<double>& bounds);

}  // namespace detail

/// @defgroup safe_displacements Safe displacements
///
/// A bound b for each vertex of a mesh in its current frame. If every vertex moves by at
/// most its bound, in whatever direction and on whatever path within this radius, each
/// VF and EE pair of features without a common vertex stays further apart than
/// min_distance. Exception: the vertices of pairs that are not further apart now (or not
/// provably) have the bound 0, and such a pair stays as it is if its vertices do not
/// move.
///
/// b is half of the least distance, less min_distance, of all pairs that have the vertex
/// in one of their features, and at most max_displacement. This is the bound of offset
/// geometric contact (Chen et al. 2025, "Offset Geometric Contact", ACM Trans. Graph.
/// 44(4)), with a factor of exactly 1/2. Their factor of less than 1/2 leaves room for
/// rounding. Here distances are proved from below, and the rounding of the new position
/// is taken off.
///
/// The larger max_displacement, the more pairs are looked at: those within min_distance +
/// 2 max_displacement. Take the least bound of several calls, for example of one with the
/// mesh itself and one with each obstacle. Surfaces that cross already are not found:
/// only distances of VF and EE pairs count.
///
/// A DeformableBVHModel is read in its current frame; its previous frame does not count.
/// Models and thread-safety are those of the @ref continuous_queries; the call runs in
/// the caller's thread.
///
/// @param max_displacement  the largest bound, finite, above 0
/// @param min_distance  not negative, finite
/// @throws fcl::Exception when an argument is null, a number is not usable, a geometry is
/// not a triangle mesh, a mesh is not built or is in the middle of an update, a
/// coordinate or a transform is not finite, or a triangle index is out of range
/// @{

/// @brief The bounds of a mesh with itself, one for each vertex.
inline std::vector<double> safeSelfDisplacements(const CollisionGeometry<double>* o,
                                                 double max_displacement,
                                                 double min_distance = 0) {
  std::vector<double> bounds;
  detail::findSafeSelfDisplacements(o, max_displacement, min_distance, bounds);
  return bounds;
}

/// @overload
inline std::vector<double> safeSelfDisplacements(const CollisionGeometry<float>* o,
                                                 double max_displacement,
                                                 double min_distance = 0) {
  std::vector<double> bounds;
  detail::findSafeSelfDisplacements(o, max_displacement, min_distance, bounds);
  return bounds;
}

/// @brief The bounds of two meshes, which both may move.
/// @param tf1, tf2  their poses. Lengths are those of the world
inline SafeDisplacements safeDisplacements(const CollisionGeometry<double>* o1,
                                           const Transform3<double>& tf1,
                                           const CollisionGeometry<double>* o2,
                                           const Transform3<double>& tf2,
                                           double max_displacement,
                                           double min_distance = 0) {
  SafeDisplacements bounds;
  detail::findSafeDisplacements(detail::movingGeometry(o1, tf1, tf1),
                                detail::movingGeometry(o2, tf2, tf2), max_displacement,
                                min_distance, bounds);
  return bounds;
}

/// @overload
inline SafeDisplacements safeDisplacements(const CollisionGeometry<float>* o1,
                                           const Transform3<float>& tf1,
                                           const CollisionGeometry<float>* o2,
                                           const Transform3<float>& tf2,
                                           double max_displacement,
                                           double min_distance = 0) {
  SafeDisplacements bounds;
  detail::findSafeDisplacements(detail::movingGeometry(o1, tf1, tf1),
                                detail::movingGeometry(o2, tf2, tf2), max_displacement,
                                min_distance, bounds);
  return bounds;
}
/// @}

}  // namespace fcl

#endif
