// SPDX-License-Identifier: BSD-3-Clause
//
// Bodies that overlap where they begin.
#ifndef FCL_CCD_CURVED_OVERLAP_AT_START_H
#define FCL_CCD_CURVED_OVERLAP_AT_START_H

#include "bodies/moving_body.h"
#include "mesh/vertex_frames.h"
#include "shapes/convex_shape.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief Whether an overlap is more than 2^-16 of a size, 1.5e-5. Then discrete queries
/// find it: FCL's GJK has a tolerance of 1e-6.
inline bool isDeepOverlap(double overlap, double size) {
  return overlap > 0x1p-16 * size;
}

/// @brief Whether two shapes in their poses are found to overlap deeply, by the size of
/// the smaller one. Then a query of any motions that begin there has its first
/// contact at t = 0, and needs no path, no bound and no tolerance.
/// @pre one of them is no plane or halfspace; the floating-point mode is the default one
bool overlapDeeplyAtStart(const ConvexShape& a, const Pose& pose_a, const ConvexShape& b,
                          const Pose& pose_b);

/// @brief Whether a mesh and a plane or halfspace are found to overlap deeply at t = 0,
/// by the size of the mesh: at one triangle, to which the tree leads. Nothing
/// else is looked at, neither other triangles nor later times. false for other bodies.
/// @pre the floating-point mode is the default one
bool overlapDeeplyAtStart(const MovingBody& a, const MovingBody& b);

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
