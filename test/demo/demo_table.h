// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_DEMO_TABLE_H
#define FCL_CCD_DEMO_TABLE_H

#include <cstddef>
#include <string>
#include <vector>

#include "cloth_simulator.h"

namespace fcl {
namespace test {

/// @brief A line a frame, a line of sums, and what the columns mean.
std::string formatTable(const std::vector<FrameReport>& reports, std::size_t triangles);

/// @brief The same with every digit and every count, as CSV with a header.
std::string formatCsv(const std::vector<FrameReport>& reports, std::size_t triangles);

}  // namespace test
}  // namespace fcl

#endif
