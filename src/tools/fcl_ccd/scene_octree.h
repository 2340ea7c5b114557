// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_SCENE_OCTREE_H
#define FCL_CCD_SCENE_OCTREE_H

#include <memory>
#include <string>

#include "fcl/geometry/collision_geometry.h"

namespace fcl_ccd {

/// @brief Reads a file of octomap, .bt or .ot.
/// @throws std::runtime_error that names the file and the cause, also if FCL was built
/// without octomap.
std::shared_ptr<fcl::CollisionGeometryd> readOctree(const std::string& path);

}  // namespace fcl_ccd

#endif
