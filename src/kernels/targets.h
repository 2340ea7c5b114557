// SPDX-License-Identifier: BSD-3-Clause
//
// The instruction sets of this machine, for tests that compare their kernels.
#ifndef FCL_CCD_KERNELS_TARGETS_H
#define FCL_CCD_KERNELS_TARGETS_H

#include <cstddef>
#include <cstdint>
#include <vector>

#include "hwy/targets.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief The function of each instruction set that this machine has, the best first, and
/// the code without vector instructions last. The library makes its own choice, since
/// Highway's is valid for the whole process.
/// @param table  HWY_DISPATCH_TABLE of the function
template <typename Function, std::size_t kSize>
std::vector<Function> ofEachTarget(Function const (&table)[kSize]) {
  std::vector<Function> all;
  hwy::ChosenTarget choice;
  // The best target has the lowest bit. Without any bit the code without vector
  // instructions is used.
  for (std::int64_t left = hwy::SupportedTargets() & HWY_TARGETS; true;
       left &= left - 1) {
    choice.Update(left & -left);
    const Function function = table[choice.GetIndex()];
    if (all.empty() || all.back() != function) all.push_back(function);
    if (left == 0) return all;
  }
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
