// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_BENCHMARK_SCENE_BENCHMARK_H
#define FCL_BENCHMARK_SCENE_BENCHMARK_H

#include <string>

namespace fcl {
namespace test {

/// @brief Where a frame pair and its true contacts lie.
struct SceneFiles {
  std::string name;
  std::string folder;
  std::string previous;
  std::string current;
};

void printSceneHeader();

/// @brief Self-collision of a frame pair: all contacts and the first one with moving
/// boxes, all contacts with the paper's swept-union boxes; FCL's own tree for comparison.
void benchmarkScene(const SceneFiles& files, int repeats);

}  // namespace test
}  // namespace fcl

#endif
