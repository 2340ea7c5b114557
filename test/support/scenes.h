// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_TEST_SUPPORT_SCENES_H
#define FCL_TEST_SUPPORT_SCENES_H

#include "cloth_simulator.h"

namespace fcl {
namespace test {

/// @brief Bodies of the scene below, as ClothSimulator::bodyOf names them.
enum ClothOverBall { kCloth = 0, kBall = 1, kGround = 2 };

/// @brief A square cloth of 1.5 m falls over a ball of 0.25 m radius that stands on the
/// ground. From 0.3 s on the ball spins faster and faster. The cloth winds itself around
/// it, slides over the ground, and folds.
/// @param resolution  the cloth has 2 resolution^2 triangles
/// @param seed  see SimulatorOptions
ClothSimulator makeClothOverBall(int resolution, std::uint64_t seed = 1);

}  // namespace test
}  // namespace fcl

#endif
