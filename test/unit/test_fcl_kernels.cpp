// SPDX-License-Identifier: BSD-3-Clause
//
// The kernels decide as the scalar functions do, with the same bits on every instruction
// set of the machine. This file checks the list of instruction sets. Each kernel has a
// file of its own.
#include "kernels/kernels.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

namespace fcl {
namespace detail {
namespace deformable {
namespace {

TEST(FCL_KERNELS, everyInstructionSetOnceTheBestFirst) {
  const auto all = allKernels();
  ASSERT_FALSE(all.empty());
  EXPECT_EQ(all.front(), &kernels());
  std::set<std::string> names;
  for (const Kernels* k : all) EXPECT_TRUE(names.insert(k->name).second) << k->name;
    // The last set needs no special instructions, if the compiler may not assume any.
#if defined(__x86_64__) && !defined(__SSSE3__)
  const std::string last = all.back()->name;
  EXPECT_TRUE(last == "EMU128" || last == "SCALAR" || last == "SSE2" || last == "plain")
      << last;
  EXPECT_EQ(all.size() == 1, last == "plain");
#endif
}

TEST(FCL_KERNELS, listingChoosesNothing) {
  const Kernels& before = kernels();
  allKernels();
  EXPECT_EQ(&kernels(), &before);
}

}  // namespace
}  // namespace deformable
}  // namespace detail
}  // namespace fcl
