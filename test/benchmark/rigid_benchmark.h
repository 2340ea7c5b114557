// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_BENCHMARK_RIGID_BENCHMARK_H
#define FCL_BENCHMARK_RIGID_BENCHMARK_H

namespace fcl {
namespace test {

/// @brief Two rigid bumpy spheres of 100,000 triangles in translation: apart (side by
/// side and with interlocking boxes) and touching.
void benchmarkRigid(int repeats);

}  // namespace test
}  // namespace fcl

#endif
