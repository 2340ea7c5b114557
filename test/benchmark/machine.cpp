// SPDX-License-Identifier: BSD-3-Clause
#include "machine.h"

#ifdef __GLIBC__
#include <malloc.h>
#endif

#include <cstdlib>
#include <fstream>
#include <thread>

#include "kernels/kernels.h"

namespace fcl {
namespace test {
namespace {

/// What follows `key` and ": " or ":" in the first line of the file that starts with key.
std::string valueIn(const char* file, const std::string& key) {
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    const auto colon = line.find(':');
    if (line.rfind(key, 0) != 0 || colon == std::string::npos) continue;
    const auto value = line.find_first_not_of(" \t", colon + 1);
    return value == std::string::npos ? "" : line.substr(value);
  }
  return "";
}

}  // namespace

std::string machineName() {
  std::string name = valueIn("/proc/cpuinfo", "model name");
  if (name.empty()) name = "unknown processor";
  name += "; " + std::to_string(std::thread::hardware_concurrency()) + " cores; ";
#ifdef __clang__
  name += "clang " + std::to_string(__clang_major__);
#else
  name += "gcc " + std::to_string(__GNUC__);
#endif
  for (char& c : name)
    if (c == ',' || c == '"') c = ' ';
  return name;
}

std::string libraryKernels() {
  return areScalar(detail::deformable::kernels().name) ? "scalar" : "vector";
}

void resetPeakMemory() {
#ifdef __GLIBC__
  malloc_trim(0);
#endif
  // 5: the peak becomes what is resident now (proc(5)).
  std::ofstream("/proc/self/clear_refs") << 5;
}

double peakMegabytes() {
  const std::string kilobytes = valueIn("/proc/self/status", "VmHWM");
  return kilobytes.empty() ? -1 : std::atof(kilobytes.c_str()) / 1024;
}

}  // namespace test
}  // namespace fcl
