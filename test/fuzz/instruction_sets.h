// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_FUZZ_INSTRUCTION_SETS_H
#define FCL_FUZZ_INSTRUCTION_SETS_H

namespace fcl {
namespace test {

/// @brief Makes the library use the n-th best instruction set of the processor. It makes
/// its choice once, so this comes before the first query.
/// @return false: there are not so many
bool chooseInstructionSet(int n);

}  // namespace test
}  // namespace fcl

#endif
