// SPDX-License-Identifier: BSD-3-Clause
//
// Figures of rigid parts that move like a doll's limbs, and what they wear.
#ifndef FCL_TEST_SUPPORT_FIGURES_H
#define FCL_TEST_SUPPORT_FIGURES_H

#include <vector>

#include "cloth_simulator.h"

namespace fcl {
namespace test {

/// @brief A number of divisions, for a mesh with `scale` times the triangles.
int scaled(int divisions, double scale, int at_least = 4);

struct FigurePart {
  TestMesh mesh;
  ObstacleMotion motion;
};

/// @brief Parts that never touch each other; the first is the trunk.
using Figure = std::vector<FigurePart>;

/// @brief A woman of 1.7 m on the z axis who turns to and fro, sways and steps. Her trunk
/// is 0.13 m wide at the waist, 1.06 m above the ground.
Figure makeDancer(double scale);

/// @brief A woman of 1.7 m who stands on the z axis, looks along -y and sits down on the
/// ground from 0.2 s to 1.4 s, knees bent.
Figure makeSittingFigure(double scale);

/// @brief A cone around the z axis.
struct Skirt {
  double height;  // of the upper border, metres
  double radius;  // of the upper border, metres
  double slope;   // from the vertical, radians
  double length;  // metres
  int columns, rows;
};

/// @brief The skirt's vertices begin with those of the upper border.
TestMesh makeSkirt(const Skirt& skirt, double scale);

}  // namespace test
}  // namespace fcl

#endif
