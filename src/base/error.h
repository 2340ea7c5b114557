// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_BASE_ERROR_H
#define FCL_CCD_BASE_ERROR_H

#include <string>

namespace fcl {
namespace detail {
namespace deformable {

/// @brief Throws for an input that cannot be used: fcl::Exception in the library that
/// extends FCL (api/error.cpp), std::invalid_argument in fcl_ccd_core (base/error.cpp).
[[noreturn]] void throwBadInput(const std::string& text);

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
