// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_SCENES_SCENE_PICTURES_H
#define FCL_CCD_SCENES_SCENE_PICTURES_H

#include <string>

#include "paper_scenes.h"
#include "pictures.h"

namespace fcl {
namespace test {

/// @brief Where a scene is seen from.
Camera sceneCamera(SceneKind kind);

/// @brief A picture of a frame's end; cloth in two colours, solids in one each.
Image drawFrame(SceneKind kind, const SceneFrame& frame, int width, int height);

/// @brief The bytes of a PLY of positions of a frame, in the same colours.
std::string encodeFrame(const SceneFrame& frame,
                        const std::vector<Vector3<double>>& positions);

}  // namespace test
}  // namespace fcl

#endif
