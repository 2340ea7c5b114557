// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_TEST_BENCHMARK_MOTION_BENCHMARK_H
#define FCL_TEST_BENCHMARK_MOTION_BENCHMARK_H

namespace fcl {
namespace test {

/// @brief Prints how long the first contact of two meshes takes of which one turns,
/// beside FCL's sampling, with the errors of both.
void benchmarkMotions(int repeats);

}  // namespace test
}  // namespace fcl

#endif
