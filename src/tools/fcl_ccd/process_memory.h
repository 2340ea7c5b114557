// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_PROCESS_MEMORY_H
#define FCL_CCD_PROCESS_MEMORY_H

#include <sys/resource.h>
#include <unistd.h>

#include <fstream>

namespace fcl_ccd {

/// @brief The memory that this process has now, in MB of 10^6 bytes. Where the system
/// does not tell it, the most that it has had.
inline double processMemory() {
  long pages = 0;
  if (std::ifstream("/proc/self/statm").ignore(64, ' ') >> pages)
    return static_cast<double>(pages) * static_cast<double>(sysconf(_SC_PAGESIZE)) / 1e6;
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
#ifdef __APPLE__
  constexpr double kUnit = 1;  // bytes
#else
  constexpr double kUnit = 1024;  // bytes
#endif
  return static_cast<double>(usage.ru_maxrss) * kUnit / 1e6;
}

}  // namespace fcl_ccd

#endif
