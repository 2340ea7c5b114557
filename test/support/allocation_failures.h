// SPDX-License-Identifier: BSD-3-Clause
//
// Lets a test choose when memory runs out. Only for programs that are linked with
// allocation_failures.cpp, which replaces operator new.
#ifndef FCL_TEST_SUPPORT_ALLOCATION_FAILURES_H
#define FCL_TEST_SUPPORT_ALLOCATION_FAILURES_H

namespace fcl {
namespace test {

/// @brief This number of allocations of this thread succeed, then all fail. Negative:
/// none fails.
extern thread_local int allocations_left;

}  // namespace test
}  // namespace fcl

#endif
