// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_WRITE_ERROR_H
#define FCL_CCD_WRITE_ERROR_H

#include <cerrno>
#include <stdexcept>
#include <string>
#include <system_error>

namespace fcl_ccd {

/// @brief An output cannot be written. The message names the file and the cause.
struct WriteError : std::runtime_error {
  using std::runtime_error::runtime_error;

  /// @param error  an errno.
  WriteError(const std::string& name, const std::string& what, int error)
      : std::runtime_error(
            name + ": " +
            (error == EPIPE ? "the program that reads it has ended"
                            : what + ": " + std::generic_category().message(error))) {}
};

}  // namespace fcl_ccd

#endif
