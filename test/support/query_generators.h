// SPDX-License-Identifier: BSD-3-Clause
//
// Families of random elementary queries: queries as in scenes, and all kinds of
// degenerate cases that we know. Their doubles are exact: features that touch by
// construction touch exactly.
#ifndef FCL_TEST_SUPPORT_QUERY_GENERATORS_H
#define FCL_TEST_SUPPORT_QUERY_GENERATORS_H

#include <string>
#include <vector>

#include "feature_pair_generators.h"

namespace fcl {
namespace test {

struct QueryFamily {
  const char* name;
  /// Features that are touching, flat or zero by construction, or one rounding away from
  /// that.
  bool is_degenerate;
  MovingPair (*generate)(Random&);
};

/// @brief All families, in a fixed order.
const std::vector<QueryFamily>& queryFamilies();

/// @throws std::invalid_argument if the family does not exist
const QueryFamily& queryFamily(const std::string& name);

}  // namespace test
}  // namespace fcl

#endif
