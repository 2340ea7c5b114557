// SPDX-License-Identifier: BSD-3-Clause
//
// Checks that kernels give the same bits on every instruction set of the machine.
#ifndef FCL_TEST_SUPPORT_KERNEL_CHECKS_H
#define FCL_TEST_SUPPORT_KERNEL_CHECKS_H

#include <gtest/gtest.h>

#include <cstddef>
#include <cstring>
#include <vector>

#include "kernels/kernels.h"

namespace fcl {
namespace test {

/// @brief The kernels for each instruction set of the machine, the best first.
inline const std::vector<const detail::deformable::Kernels*>& allSets() {
  static const std::vector<const detail::deformable::Kernels*> all =
      detail::deformable::allKernels();
  return all;
}

/// @brief The same bits, in the lanes whose bits are set in the mask.
template <typename T, std::size_t kCount>
void expectSameBits(unsigned mask, const T (&x)[kCount], const T (&y)[kCount]) {
  for (std::size_t i = 0; i < kCount; ++i)
    if (mask >> i & 1U) {
      EXPECT_EQ(std::memcmp(&x[i], &y[i], sizeof(T)), 0) << i;
    }
}

}  // namespace test
}  // namespace fcl

#endif
