// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_DEMO_TABLE_H
#define FCL_CCD_DEMO_TABLE_H

#include <string>
#include <vector>

#include "cloth_over_ball.h"

namespace fcl {
namespace test {

/// @brief A line a frame, a line of sums, and what the columns mean.
std::string formatTable(const std::vector<DemoFrame>& frames);

/// @brief The same with every digit and every count, as CSV with a header.
std::string formatCsv(const std::vector<DemoFrame>& frames);

}  // namespace test
}  // namespace fcl

#endif
