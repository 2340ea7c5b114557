// SPDX-License-Identifier: BSD-3-Clause
//
// The version of fcl_ccd, the extension of FCL. FCL's own version is in <fcl/config.h>. A
// program knows by FCL_CCD_VERSION that it is compiled with this package. The macro is
// defined after <fcl/fcl.h>, <fcl/narrowphase/continuous_collision.h>,
// <fcl/narrowphase/distance.h>, and after each header that this package adds.
#ifndef FCL_CCD_VERSION_H
#define FCL_CCD_VERSION_H

#define FCL_CCD_VERSION "0.3.0"
#define FCL_CCD_MAJOR_VERSION 0
#define FCL_CCD_MINOR_VERSION 3
#define FCL_CCD_PATCH_VERSION 0

#define FCL_CCD_VERSION_AT_LEAST(x, y, z) \
  (FCL_CCD_MAJOR_VERSION > x ||           \
   (FCL_CCD_MAJOR_VERSION == x &&         \
    (FCL_CCD_MINOR_VERSION > y ||         \
     (FCL_CCD_MINOR_VERSION == y && FCL_CCD_PATCH_VERSION >= z))))

#endif
