// SPDX-License-Identifier: BSD-3-Clause
//
// Another program's elementary test beside ours. It is run as `COMMAND FILE`, where FILE
// has a line that starts with '#' and then a line a query:
//   index,kind,x,y,z,...   kind vf (v, f0, f1, f2) or ee (ea0, ea1, eb0, eb1), then eight
// points: the four at t = 0, then the four at t = 1; 17 digits, which identify a double.
// It prints a line a query, in any order:
//   index,answer,toc       answer 1 or 0; toc, the first time of contact, only after 1
// It may print `ns_mean,NUMBER`, the time of a query by its own clock; otherwise the wall
// time of the whole run, which reads text for the most part, is divided by the queries.
#ifndef FCL_BENCHMARK_OUTSIDE_SOLVER_H
#define FCL_BENCHMARK_OUTSIDE_SOLVER_H

#include <string>
#include <vector>

#include "methods.h"
#include "query_set.h"

namespace fcl {
namespace test {

struct OutsideSolver {
  std::string name;
  std::string command;
};

struct OutsideAnswers {
  std::vector<MethodAnswer> answers;
  double ns_mean;
  bool own_clock;
};

/// @brief Takes `NAME=COMMAND` apart.
/// @throws std::runtime_error if it is something else
OutsideSolver parseOutsideSolver(const std::string& text);

/// @throws std::runtime_error if the program fails, or does not answer every query once
OutsideAnswers runOutsideSolver(const OutsideSolver& solver, const QuerySet& set);

}  // namespace test
}  // namespace fcl

#endif
