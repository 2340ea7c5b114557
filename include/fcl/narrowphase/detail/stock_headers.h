// SPDX-License-Identifier: BSD-3-Clause
//
// Includes FCL's own headers behind those headers of this package that have the same
// names and stand in front of them. A header of this package asks for its namesake by its
// include guard; so this one has no guard. It is a system header, since #include_next is
// an extension, which a pedantic compiler would report in a user's build.
#pragma GCC system_header

#ifdef FCL_NARROWPHASE_CONTINUOUS_COLLISION_OVERLAY_H
#include_next <fcl/narrowphase/continuous_collision.h>
#endif
#ifdef FCL_NARROWPHASE_DISTANCE_OVERLAY_H
#include_next <fcl/narrowphase/distance.h>
#endif
