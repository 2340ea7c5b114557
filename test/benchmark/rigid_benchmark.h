// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_BENCHMARK_RIGID_BENCHMARK_H
#define FCL_BENCHMARK_RIGID_BENCHMARK_H

namespace fcl {
namespace test {

/// @brief Two rigid bumpy spheres of 100,000 triangles in translation: apart (side by
/// side and with interlocking boxes) and touching.
void benchmarkRigid(int repeats);

/// @brief A ball along rigid models of OBBRSSs, of 5,000 and of 100,000 triangles, whose
/// trees FCL made in different ways: all contacts against those of a DeformableBVHModel,
/// and the time of the first contact and of FCL's own query.
void benchmarkRigidTrees(int repeats);

}  // namespace test
}  // namespace fcl

#endif
