// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_TEST_BENCHMARK_MOTIONS_DEEP_H
#define FCL_TEST_BENCHMARK_MOTIONS_DEEP_H

#include <ostream>

namespace fcl {
namespace test {

/// @brief All contacts of two bodies that are deep in each other while one turns, by
/// several angles. Adds the rows of the scene "deep".
void measureDeep(std::ostream& csv);

}  // namespace test
}  // namespace fcl

#endif
