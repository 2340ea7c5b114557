// SPDX-License-Identifier: BSD-3-Clause
//
// The two tables; doc/speed_error.md says what their columns mean.
#ifndef FCL_BENCHMARK_REPORT_H
#define FCL_BENCHMARK_REPORT_H

#include <fstream>
#include <string>

#include "outside_solver.h"
#include "query_set.h"

namespace fcl {
namespace test {

class Report {
 public:
  /// @brief Starts speed_error.csv and filter_ratio.csv in a folder.
  /// @throws std::runtime_error if they cannot be written
  Report(const std::string& folder, int repeats);

  /// @brief Rows of the outside solvers, of all our methods, and of the filters.
  void add(const QuerySet& set, const std::vector<OutsideSolver>& solvers);

  void finish();

 private:
  void addMethods(const QuerySet& set);
  void addSolver(const QuerySet& set, const OutsideSolver& solver);
  void addFilters(const QuerySet& set);

  std::string machine_;
  int repeats_;
  std::ofstream methods_, filters_;
};

}  // namespace test
}  // namespace fcl

#endif
