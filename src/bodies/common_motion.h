// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_BODIES_COMMON_MOTION_H
#define FCL_CCD_BODIES_COMMON_MOTION_H

#include "bodies/moving_body.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief Whether two bodies move as one, such as a gripper and what it holds: no two
/// points of them come nearer to each other, or part, by more than a part of the
/// tolerance of their query. Then what is not in contact at t = 0 never is.
///
/// It is known of bodies that do not deform, with paths that are a Turn. Others may move
/// as one where the answer is false.
/// @param distance  at which the bodies are in contact
bool moveAsOne(const MovingBody& a, const MovingBody& b, double distance);

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
