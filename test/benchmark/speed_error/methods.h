// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_BENCHMARK_METHODS_H
#define FCL_BENCHMARK_METHODS_H

#include <string>
#include <vector>

#include "feature_pair_generators.h"

namespace fcl {
namespace test {

/// @brief toc: a time that the method gives out as the first, for our stages the lower
/// end of the bracket. stage: 0 box, 1 filter, 2 solver, 3 exact; for methods that have
/// stages.
struct MethodAnswer {
  bool contact;
  double toc;
  int stage;
};

/// @brief A way to answer elementary queries. All are called in the same way, through a
/// pointer, so that their times differ by what they do.
struct Method {
  std::string name;
  /// How the number is written in the report; empty if the method has none.
  std::string setting;
  double number;
  bool has_stages;
  MethodAnswer (*answer)(const MovingPair& query, double number);
};

/// @brief FCL's test, the plain solvers, our certified stages and our whole test, each
/// with its settings.
std::vector<Method> allMethods();

/// @brief The filters as methods: `contact` says that the filter does not cull. The
/// paper's, ours over the whole step, and ours as it is used, with the window of the
/// boxes.
std::vector<Method> filters();

}  // namespace test
}  // namespace fcl

#endif
