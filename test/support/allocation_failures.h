// SPDX-License-Identifier: BSD-3-Clause
//
// Memory that runs out when a test says so. Only for programs that are made with
// allocation_failures.cpp, which replaces operator new.
#ifndef FCL_TEST_SUPPORT_ALLOCATION_FAILURES_H
#define FCL_TEST_SUPPORT_ALLOCATION_FAILURES_H

namespace fcl {
namespace test {

/// @brief So many allocations of this thread succeed before all fail; none does if
/// negative.
extern thread_local int allocations_left;

}  // namespace test
}  // namespace fcl

#endif
