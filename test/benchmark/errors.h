// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_BENCHMARK_ERRORS_H
#define FCL_BENCHMARK_ERRORS_H

#include <cstddef>
#include <vector>

#include "scene_data.h"

namespace fcl {
namespace test {

/// @brief Differences of a list of contacts to the true one.
struct Errors {
  std::size_t missed;
  std::size_t extra;
};

/// @brief Both lists sorted.
Errors errorsOf(const std::vector<PairName>& found, const std::vector<PairName>& truth);

}  // namespace test
}  // namespace fcl

#endif
