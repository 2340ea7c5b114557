// SPDX-License-Identifier: BSD-3-Clause
//
// Families of random elementary queries: what scenes are made of, and every kind of
// degenerate case that could be thought of. All are made of doubles as they stand: what
// is said to touch touches exactly.
#ifndef FCL_TEST_SUPPORT_QUERY_GENERATORS_H
#define FCL_TEST_SUPPORT_QUERY_GENERATORS_H

#include <string>
#include <vector>

#include "feature_pair_generators.h"

namespace fcl {
namespace test {

struct QueryFamily {
  const char* name;
  /// Touching, flat or zero by construction, or one rounding away from it.
  bool is_degenerate;
  MovingPair (*generate)(Random&);
};

/// @brief All families, in a fixed order.
const std::vector<QueryFamily>& queryFamilies();

/// @throws std::invalid_argument if there is no such family
const QueryFamily& queryFamily(const std::string& name);

}  // namespace test
}  // namespace fcl

#endif
