// SPDX-License-Identifier: BSD-3-Clause
//
// Bodies that touch where they begin.
#ifndef FCL_CCD_MOTION_OVERLAP_AT_START_H
#define FCL_CCD_MOTION_OVERLAP_AT_START_H

#include "mesh/vertex_frames.h"
#include "motion/convex_shape.h"
#include "motion/motion_body.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief Whether two shapes in their poses are found to touch or to overlap, up to the
/// rounding of their points. Then a query of any motions that begin there has its first
/// contact at t = 0, and needs no path, no bound and no tolerance.
/// @pre one of them is no plane or halfspace; the floating-point mode is the default one
bool overlapAtStart(const ConvexShape& a, const Pose& pose_a, const ConvexShape& b,
                    const Pose& pose_b);

/// @brief Whether a mesh and a plane or halfspace are found to touch at t = 0, up to the
/// rounding of their points: at one triangle, to which the tree leads. Nothing else is
/// looked at, neither other triangles nor later times. false for other bodies.
/// @pre the floating-point mode is the default one
bool overlapAtStart(const MotionBody& a, const MotionBody& b);

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
