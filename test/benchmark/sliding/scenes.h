// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_BENCHMARK_SLIDING_SCENES_H
#define FCL_BENCHMARK_SLIDING_SCENES_H

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "fcl/geometry/collision_geometry.h"

namespace fcl {
namespace test {

/// @brief A time of contact: there is none.
constexpr double kNever = 2;

/// @brief A body turns about the z axis and slides along it, close to one at rest.
struct Scene {
  std::string name;
  std::shared_ptr<CollisionGeometry<double>> moving, still;
  double angle{0}, way{0};
  /// The distance at which they are in contact.
  double distance{0};
  /// The first time of contact, by the shapes alone. kNever: the gap keeps them apart.
  /// NaN: they touch at some time.
  double truth{kNever};
  /// Whether FCL's own query can answer it.
  bool is_for_stock{true};
  /// Gives the frames at two times of the step to both models. Empty: they do not deform.
  std::function<void(double from, double to)> deform;
};

/// @brief What makes each scene. They need much memory together.
std::vector<std::function<Scene()>> slidingScenes();

}  // namespace test
}  // namespace fcl

#endif
