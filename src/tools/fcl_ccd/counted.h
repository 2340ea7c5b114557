// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_COUNTED_H
#define FCL_CCD_COUNTED_H

#include <cstddef>
#include <string>

namespace fcl_ccd {

/// @brief A number and its noun: "1 step", "2 steps".
/// @param noun  its plural ends in s.
inline std::string counted(std::size_t number, const char* noun) {
  return std::to_string(number) + ' ' + noun + (number == 1 ? "" : "s");
}

}  // namespace fcl_ccd

#endif
