// SPDX-License-Identifier: BSD-3-Clause
//
// Includes FCL's own <fcl/narrowphase/continuous_collision.h>. The header of this package
// with the same name stands in front of it. This is a system header, since
// #include_next is an extension, which a pedantic compiler would report in a user's
// build.
#ifndef FCL_NARROWPHASE_DETAIL_STOCK_CONTINUOUS_COLLISION_H
#define FCL_NARROWPHASE_DETAIL_STOCK_CONTINUOUS_COLLISION_H
#pragma GCC system_header

#include_next <fcl/narrowphase/continuous_collision.h>

#endif
