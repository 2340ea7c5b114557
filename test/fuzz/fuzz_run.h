// SPDX-License-Identifier: BSD-3-Clause
//
// Runs the cases of a family in threads and adds up what they find.
#ifndef FCL_FUZZ_FUZZ_RUN_H
#define FCL_FUZZ_FUZZ_RUN_H

#include <cstdio>
#include <map>
#include <string>

#include "family.h"

namespace fcl {
namespace test {

struct RunOptions {
  std::uint64_t seed{1};
  /// The number of cases of each family, times its share.
  std::uint64_t cases{100};
  /// Of each family, in place of the number of cases, if above 0.
  double seconds{0};
  /// 0: as many as there are cores.
  unsigned threads{0};
  /// Only this seed of a case, if not null.
  const std::uint64_t* only{nullptr};
};

/// @brief A row of the table.
struct FamilyRow {
  const char* name;
  /// Sums, and the slowest of all calls.
  Outcome sum;
  double seconds{0};
  /// The first of them, by the seed of the case.
  std::map<std::uint64_t, std::string> complaints;
};

/// @brief The result does not depend on the number of threads, but for times. With a time
/// limit the number of cases does.
/// @param digests  gets a line a case, unless it is null
FamilyRow runFamily(const Family& family, const RunOptions& options, std::FILE* digests);

/// @brief The case that the calling thread is at.
struct CurrentCase {
  const char* family{"none"};
  std::uint64_t seed{0};
};
CurrentCase& currentCase();

}  // namespace test
}  // namespace fcl

#endif
