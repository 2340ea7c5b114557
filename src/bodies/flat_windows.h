// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_BODIES_FLAT_WINDOWS_H
#define FCL_CCD_BODIES_FLAT_WINDOWS_H

#include "shapes/body_boxes.h"
#include "shapes/convex_shape.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief As BodyKernels::meetingWindows(), for boxes and a plane or a halfspace. The
/// only direction is its normal, which turns with it. It measures gaps.
/// @param boxes  those at both ends of the span are used
/// @param margin  a bound on how far the height of a point above the plane deviates from
/// a straight line, with pads, requested distance and rounding
void flatWindows(const FlatShape& flat, const SpanPoses& pose_flat,
                 const BodyBoxes* const (&boxes)[3], const SpanPoses& pose_boxes,
                 const double (&margin)[BodyBoxes::kWidth], int count,
                 MeetingWindows& out);

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
