// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_BENCHMARK_MACHINE_H
#define FCL_BENCHMARK_MACHINE_H

#include <string>

namespace fcl {
namespace test {

/// @brief Processor, number of cores and compiler, without commas.
std::string machineName();

/// @brief Whether kernels of a name have no vector instructions. Some versions of Highway
/// leave them out where each processor has SSE2.
inline bool areScalar(const std::string& kernels) {
  return kernels == "plain" || kernels == "SCALAR" || kernels == "EMU128";
}

/// @brief What the library's kernels are here: "vector" or "scalar".
std::string libraryKernels();

/// @brief From here on peakMegabytes() counts anew; memory that was freed is given back
/// to the system first.
void resetPeakMemory();

/// @brief Largest resident memory of the program since the last reset, in MiB; a negative
/// number where the system does not tell (both need Linux's /proc).
double peakMegabytes();

}  // namespace test
}  // namespace fcl

#endif
