// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_BENCHMARK_MEASUREMENT_H
#define FCL_BENCHMARK_MEASUREMENT_H

#include <array>
#include <cstddef>
#include <vector>

#include "methods.h"
#include "query_set.h"

namespace fcl {
namespace test {

/// @brief Wrong answers, and by how much the time of contact is wrong in pairs that touch
/// and are found to.
struct AnswerErrors {
  std::size_t contacts{0};  ///< true ones
  std::size_t false_negatives{0};
  std::size_t false_positives{0};
  double max_late{0};
  double max_early{0};

  void add(const Truth& truth, bool contact, double toc);
};

struct Times {
  double ns_mean;
  double ns_median;
  double ns_p999;
};

/// @brief What a method answered and how long it took.
struct Run {
  std::vector<MethodAnswer> answers;
  Times times;
};

/// @brief ns_mean: loops over a thousand queries each, the least time of `repeats` for
/// each (or of as many as a time budget allows), summed.
/// Median and 99.9th percentile: over a sample of the queries, of the least of `repeats`
/// times of that query between two looks at the clock, less what these cost, with its
/// points in the cache (in the loop they are fetched ahead). The least of several,
/// because what an interrupt costs is not the method's; a query that is slow for its own
/// sake is slow each time.
Run run(const Method& method, const QuerySet& set, int repeats);

AnswerErrors errorsOf(const std::vector<MethodAnswer>& answers, const QuerySet& set);

/// @brief Share of the queries that each stage decided.
std::array<double, 4> stageShares(const std::vector<MethodAnswer>& answers);

}  // namespace test
}  // namespace fcl

#endif
