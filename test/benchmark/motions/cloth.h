// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_TEST_BENCHMARK_MOTIONS_CLOTH_H
#define FCL_TEST_BENCHMARK_MOTIONS_CLOTH_H

#include <ostream>

namespace fcl {
namespace test {

/// @brief All contacts of a cloth that deforms and a body that translates, or moves as
/// far and turns. Adds the rows of the scene "cloth".
void measureCloth(std::ostream& csv);

}  // namespace test
}  // namespace fcl

#endif
