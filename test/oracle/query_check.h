// SPDX-License-Identifier: BSD-3-Clause
//
// One elementary query, every stage of the library against the oracle.
#ifndef FCL_TEST_ORACLE_QUERY_CHECK_H
#define FCL_TEST_ORACLE_QUERY_CHECK_H

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>

#include "feature_pair_generators.h"

namespace fcl {
namespace test {

/// @brief What a series of checked queries consisted of.
struct CheckTally {
  std::size_t queries{0};
  std::size_t contacts{0};
  std::size_t contacts_at_start{0};
  /// By the stage of elementaryTest() that answered, as DecidedBy.
  std::array<std::size_t, 4> decided_by{};
};

/// @brief Asks the oracle, and of the library elementaryTest() at several tolerances,
/// decideExactly(), narrowWindow(), mayBecomeCoplanar() and solveCoplanarity().
/// @param number  of the query; chooses a tolerance and windows
/// @return what contradicts the oracle, with the query in hexadecimal; empty if nothing.
std::string disagreement(const MovingPair& pair, std::uint64_t number, CheckTally& tally);

/// @brief Generated query `number`: every even one is of a degenerate family.
MovingPair generatedQuery(std::uint64_t number);

}  // namespace test
}  // namespace fcl

#endif
