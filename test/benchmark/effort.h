// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_BENCHMARK_EFFORT_H
#define FCL_BENCHMARK_EFFORT_H

#include <chrono>

namespace fcl {
namespace test {

/// @brief How often something is measured.
struct Effort {
  int repeats{5};
  /// no further repeat once so much time is spent on it
  double seconds{20};
};

/// @brief Calls measure() as the effort says, once at least.
template <typename Measure>
void repeat(const Effort& effort, Measure&& measure) {
  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  int done = 0;
  do {
    measure();
  } while (++done < effort.repeats &&
           std::chrono::duration<double>(Clock::now() - start).count() < effort.seconds);
}

}  // namespace test
}  // namespace fcl

#endif
