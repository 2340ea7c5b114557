// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_TEST_BENCHMARK_MOTIONS_ROW_H
#define FCL_TEST_BENCHMARK_MOTIONS_ROW_H

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <ostream>
#include <string>
#include <vector>

#include "machine.h"
#include "number.h"

namespace fcl {
namespace test {

/// @brief A time that no query answers: there is no contact.
constexpr double kNever = 2;
constexpr double kTocErr = 1e-4;

/// @brief A row of motions.csv: the queries of a scene that a method answered.
struct Row {
  int contacts{0}, missed{0}, late{0}, wrong{0}, early{0};
  double max_early{0}, max_late{0};
  std::vector<double> ms;

  void add(double time, double truth, double milliseconds) {
    // A time that is later than the true one by less is not late: both round.
    constexpr double kTimeRounding = 1e-9;
    ms.push_back(milliseconds);
    const bool found = time < kNever, is_there = truth < kNever;
    contacts += is_there;
    missed += is_there && !found;
    wrong += found && !is_there;
    if (!found || !is_there) return;
    late += time > truth + kTimeRounding;
    early += time < truth - kTocErr;
    max_early = std::max(max_early, truth - time);
    max_late = std::max(max_late, time - truth);
  }

  double quantile(double share) const {
    std::vector<double> sorted = ms;
    std::sort(sorted.begin(), sorted.end());
    const auto last = static_cast<double>(sorted.size() - 1);
    return sorted[static_cast<std::size_t>(std::ceil(share * last))];
  }

  /// @brief Writes the row, and prints what it says.
  void write(const std::string& scene, const std::string& motion,
             const std::string& method, std::ostream& csv) const {
    csv << scene << ',' << motion << ',' << method << ',' << ms.size() << ',' << contacts
        << ',' << missed << ',' << late << ',' << wrong << ',' << early << ','
        << number(max_early, "%.2g") << ',' << number(max_late, "%.2g") << ','
        << number(quantile(0.5)) << ',' << number(quantile(0.99)) << ',' << machineName()
        << std::endl;
    std::fprintf(stderr, "%s, %s, %s: missed %d, late %d, false %d, %.3f ms\n",
                 scene.c_str(), motion.c_str(), method.c_str(), missed, late, wrong,
                 quantile(0.5));
  }
};

}  // namespace test
}  // namespace fcl

#endif
