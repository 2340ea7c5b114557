// SPDX-License-Identifier: BSD-3-Clause
#include "scenes.h"

#include <algorithm>

namespace fcl {
namespace test {

ClothSimulator makeClothOverBall(int resolution, std::uint64_t seed) {
  const double cloth_side = 1.5;
  const double ball_radius = 0.25;
  const double spin_begin = 0.3;          // s
  const double spin_acceleration = 12.0;  // radians / s^2

  SimulatorOptions options;
  options.seed = seed;
  options.thickness = std::min(0.002, 0.25 * cloth_side / resolution);
  ClothSimulator simulator(options);

  const TestMesh rest = makeSheet(resolution, resolution, [&](double u, double v) {
    return Vector3<double>(cloth_side * (u - 0.5), cloth_side * (v - 0.5), 0);
  });
  Transform3<double> start = Transform3<double>::Identity();
  start.translation() = Vector3<double>(0.08, -0.05, 0.56);
  start.rotate(Eigen::AngleAxisd(0.4, Vector3<double>::UnitZ()));
  simulator.addCloth(rest, transformed(rest, start).vertices);

  const int ball_subdivisions = resolution < 64 ? 3 : 4;
  simulator.addObstacle(makeIcosphere(ball_subdivisions, ball_radius), [=](double time) {
    const double spinning = std::max(0.0, time - spin_begin);
    Transform3<double> pose = Transform3<double>::Identity();
    pose.translation() = Vector3<double>(0, 0, ball_radius + 0.02);
    pose.rotate(Eigen::AngleAxisd(0.5 * spin_acceleration * spinning * spinning,
                                  Vector3<double>::UnitZ()));
    return pose;
  });
  simulator.addObstacle(makeSheet(16, 16, [](double u, double v) {
    return Vector3<double>(3 * (u - 0.5), 3 * (v - 0.5), 0);
  }));
  return simulator;
}

}  // namespace test
}  // namespace fcl
