// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_BENCHMARK_OPERATION_COUNT_H
#define FCL_BENCHMARK_OPERATION_COUNT_H

#include <cstddef>

#include "query_set.h"

namespace fcl {
namespace test {

/// @brief Floating-point operations of a method, on average over a set. Differences of
/// coordinates, which every method needs, and comparisons are left out. The paper's 29
/// additions and 40 multiplications of the filter leave out six more differences (those
/// of the velocities) and count four constant factors that a sign test does not need.
struct OperationCount {
  double additions;
  double multiplications;
  double divisions;
};

/// @brief The paper's filter.
OperationCount operationsOfFilter(const QuerySet& set);

/// @brief Interval-Newton without the filter.
OperationCount operationsOfIntervalNewton(const QuerySet& set, double resolution);

}  // namespace test
}  // namespace fcl

#endif
