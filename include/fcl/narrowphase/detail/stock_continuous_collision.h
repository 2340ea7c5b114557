// SPDX-License-Identifier: BSD-3-Clause
//
// FCL's own <fcl/narrowphase/continuous_collision.h>, which ours stands in front of. A
// system header: #include_next is an extension that a pedantic compiler would report in a
// user's build.
#ifndef FCL_NARROWPHASE_DETAIL_STOCK_CONTINUOUS_COLLISION_H
#define FCL_NARROWPHASE_DETAIL_STOCK_CONTINUOUS_COLLISION_H
#pragma GCC system_header

#include_next <fcl/narrowphase/continuous_collision.h>

#endif
