// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_FILE_BYTES_H
#define FCL_CCD_FILE_BYTES_H

#include <string>

namespace fcl_ccd {

/// @brief The contents of a file. An empty file is an error.
/// @throws std::runtime_error with the cause (but not the file's name).
std::string readBytes(const std::string& path);

/// @brief readBytes() of a regular file. Anything else is an error: to read from a pipe
/// can take forever.
std::string readRegularFile(const std::string& path);

}  // namespace fcl_ccd

#endif
