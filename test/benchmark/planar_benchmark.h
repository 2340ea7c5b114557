// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_BENCHMARK_PLANAR_BENCHMARK_H
#define FCL_BENCHMARK_PLANAR_BENCHMARK_H

namespace fcl {
namespace test {

/// @brief Flat and static scenes, where every volume is zero, beside a general one; one
/// CSV row each, with the errors
/// against the exact stage on every candidate.
void benchmarkPlanar(int repeats);

}  // namespace test
}  // namespace fcl

#endif
