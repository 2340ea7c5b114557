// SPDX-License-Identifier: BSD-3-Clause
//
// The headers of FCL that most files of model/, prepare/ and api/ read, for the
// precompiled header (src/CMakeLists.txt). No file includes this one: each names what it
// needs, and compiles without.
#ifndef FCL_CCD_PREPARE_FCL_HEADERS_H
#define FCL_CCD_PREPARE_FCL_HEADERS_H

#include "fcl/common/exception.h"
#include "fcl/config.h"
#include "fcl/geometry/bvh/BVH_model.h"
#include "fcl/geometry/shape/halfspace.h"
#include "fcl/geometry/shape/plane.h"
#include "fcl/math/bv/OBBRSS.h"
#include "fcl/math/bv/kIOS.h"
#include "fcl/math/bv/utility.h"
#include "fcl/math/motion/motion_base.h"
#include "fcl/narrowphase/collision_object.h"
#include "fcl/narrowphase/contact.h"
#include "fcl/narrowphase/continuous_collision_request.h"
#include "fcl/narrowphase/continuous_collision_result.h"
#if FCL_HAVE_OCTOMAP
#include "fcl/geometry/octree/octree.h"
#endif

#endif
