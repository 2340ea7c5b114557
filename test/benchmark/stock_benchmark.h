// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_BENCHMARK_STOCK_BENCHMARK_H
#define FCL_BENCHMARK_STOCK_BENCHMARK_H

#include "scene_benchmark.h"

namespace fcl {
namespace test {

/// @brief One half of a scene's bodies against the other half: first contact by our query
/// and by FCL's own continuous traversal node, which returns the first pair it meets.
void benchmarkAgainstStock(const SceneFiles& files, int repeats);

}  // namespace test
}  // namespace fcl

#endif
