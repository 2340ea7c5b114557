// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_SCENE_POSE_H
#define FCL_CCD_SCENE_POSE_H

#include <vector>

#include "fcl/common/types.h"
#include "json_tree.h"

namespace fcl_ccd {

/// @brief Three finite numbers.
fcl::Vector3d readPoint(const JsonFile& file, const JsonValue& value);

/// @brief A list of poses. A pose is an object with a translation and a rotation
/// [w, x, y, z], or a matrix of four rows.
/// @throws std::runtime_error of JsonFile; also if a rotation is none, by more than 2^-6
std::vector<fcl::Transform3d> readPoses(const JsonFile& file, const JsonValue& value);

}  // namespace fcl_ccd

#endif
