// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_BENCHMARK_TIMING_H
#define FCL_BENCHMARK_TIMING_H

#include <algorithm>
#include <chrono>
#include <ctime>
#include <limits>

namespace fcl {
namespace test {

/// @brief Milliseconds that a call takes.
template <typename Call>
double millisecondsOf(Call&& call) {
  const auto start = std::chrono::steady_clock::now();
  call();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() -
                                                   start)
      .count();
}

/// @brief Milliseconds of processor time of this thread that a call takes: other programs
/// count less.
template <typename Call>
double cpuMillisecondsOf(Call&& call) {
  const auto now = [] {
    timespec time;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return 1e3 * double(time.tv_sec) + 1e-6 * double(time.tv_nsec);
  };
  const double start = now();
  call();
  return now() - start;
}

/// @brief The least of `repeats` runs.
template <typename Call>
double leastMilliseconds(int repeats, Call&& call) {
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < std::max(1, repeats); ++i)
    least = std::min(least, millisecondsOf(call));
  return least;
}

}  // namespace test
}  // namespace fcl

#endif
