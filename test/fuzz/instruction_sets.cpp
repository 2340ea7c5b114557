// SPDX-License-Identifier: BSD-3-Clause
#include "instruction_sets.h"

#include <cstdint>

#if defined(FCL_CCD_USE_HIGHWAY)
#include "hwy/targets.h"
#endif

namespace fcl {
namespace test {

bool chooseInstructionSet(int n) {
#if defined(FCL_CCD_USE_HIGHWAY)
  // The best one has the lowest bit.
  std::int64_t left = hwy::SupportedTargets();
  for (int i = 0; i < n; ++i) left &= left - 1;
  if (left == 0) return false;
  if (n > 0) hwy::SetSupportedTargetsForTest(left);
  return true;
#else
  return n == 0;
#endif
}

}  // namespace test
}  // namespace fcl
