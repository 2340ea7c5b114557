// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_SCENE_SHAPE_H
#define FCL_CCD_SCENE_SHAPE_H

#include <memory>
#include <string>

#include "fcl/geometry/collision_geometry.h"
#include "json_tree.h"

namespace fcl_ccd {

/// @brief One of FCL's shapes, with its name in scene files.
struct SceneShape {
  std::string type;
  std::shared_ptr<fcl::CollisionGeometryd> geometry;
};

/// @brief Reads {"type": "sphere", "radius": 1} and so on.
/// @throws std::runtime_error of JsonFile
SceneShape readShape(const JsonFile& file, const JsonValue& value);

}  // namespace fcl_ccd

#endif
