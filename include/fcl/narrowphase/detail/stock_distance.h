// SPDX-License-Identifier: BSD-3-Clause
//
// FCL's own <fcl/narrowphase/distance.h>, which ours stands in front of. A system header:
// #include_next is an extension that a pedantic compiler would report in a user's build.
#ifndef FCL_NARROWPHASE_DETAIL_STOCK_DISTANCE_H
#define FCL_NARROWPHASE_DETAIL_STOCK_DISTANCE_H
#pragma GCC system_header

#include_next <fcl/narrowphase/distance.h>

#endif
