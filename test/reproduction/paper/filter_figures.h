// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_BENCHMARK_PAPER_FILTER_FIGURES_H
#define FCL_BENCHMARK_PAPER_FILTER_FIGURES_H

#include <cstddef>

#include "errors.h"
#include "speed_error/operation_count.h"
#include "speed_error/query_set.h"

namespace fcl {
namespace test {

/// @brief The plain filter and Interval-Newton on pairs that a filter is asked.
struct FilterFigures {
  std::size_t pairs{0};
  /// those that the filter leaves to the solver
  std::size_t left{0};
  double filter_ns{0};
  double newton_ns{0};       // without the filter, a pair
  double newton_left_ns{0};  // a pair that the filter leaves
  OperationCount filter_operations{};
  OperationCount newton_operations{};
  /// contacts that are culled
  Errors filter_errors{};
  Errors newton_errors{};
};

/// @param repeats  times are the least of this number
FilterFigures measureFilter(const QuerySet& pairs, int repeats);

}  // namespace test
}  // namespace fcl

#endif
