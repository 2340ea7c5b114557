// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_BASE_STOPWATCH_H
#define FCL_CCD_BASE_STOPWATCH_H

#include <chrono>

namespace fcl {
namespace detail {
namespace deformable {

/// @brief Measures wall time from its construction on.
class Stopwatch {
 public:
  double seconds() const {
    return std::chrono::duration<double>(Clock::now() - start_).count();
  }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point start_{Clock::now()};
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
