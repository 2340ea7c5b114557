// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_TEST_BENCHMARK_APPROACH_LARGE_MESHES_H
#define FCL_TEST_BENCHMARK_APPROACH_LARGE_MESHES_H

namespace fcl {
namespace test {

/// @brief Prints the times of the least distance and of the first contact of two large
/// meshes that turn, for several gaps, and how often the bracket does not hold the
/// distance at a time.
/// @param motions  of each gap
/// @return how often it does not
int measureLargeMeshes(int motions);

}  // namespace test
}  // namespace fcl

#endif
