// SPDX-License-Identifier: BSD-3-Clause
//
// One elementary query with a distance: the library against the oracle.
#ifndef FCL_TEST_ORACLE_DISTANCE_CHECK_H
#define FCL_TEST_ORACLE_DISTANCE_CHECK_H

#include <cstddef>
#include <cstdint>
#include <string>

#include "feature_pair_generators.h"

namespace fcl {
namespace test {

struct DistanceQuery {
  MovingPair pair;
  double distance;
};

/// @brief What a series of checked queries consisted of.
struct DistanceTally {
  std::size_t queries{0};
  /// As the library answers.
  std::size_t contacts{0}, contacts_at_start{0};
  /// Contacts without a proof of the upper end, and pairs that were given up.
  std::size_t grazes{0}, given_up{0};
  std::size_t steps{0}, most_steps{0};
};

/// @brief Generated query `number`, of all four kinds. Every even one has degenerate
/// features. In half of them the distance is that at some time, or the least one of the
/// step, or differs from it by 1e-9 of itself or by a rounding.
DistanceQuery distanceQuery(std::uint64_t number);

/// @brief Asks the oracle and the library.
/// @return what contradicts the oracle, with the query in hexadecimal; empty if nothing.
std::string distanceDisagreement(const DistanceQuery& query, DistanceTally& tally);

}  // namespace test
}  // namespace fcl

#endif
