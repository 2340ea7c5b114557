// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_OUTPUT_SET_H
#define FCL_CCD_OUTPUT_SET_H

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "output_file.h"

namespace fcl_ccd {

/// @brief Prints to stdout and sees to it that it arrives.
/// @throws WriteError when it does not.
void print(std::string_view text);

/// @brief The files of one run of the program, none of them named twice: those that it
/// opens appear all of them, or none.
class OutputSet {
 public:
  /// @param inputs  files that must not be overwritten.
  explicit OutputSet(std::vector<std::string> inputs) : taken_(std::move(inputs)) {}

  /// @brief Takes a name for an output that is opened later; nothing for an empty path.
  /// @throws std::runtime_error as open(); no file is made or changed.
  void reserve(const std::string& path);

  /// @brief Opens a file to write to; null for an empty path.
  /// @throws std::runtime_error when it cannot be written, or is an input or an output.
  OutputFile* open(const std::string& path);

  /// @brief Completes every file, then lets them all appear.
  void publish();

 private:
  std::vector<std::string> taken_;
  std::vector<std::unique_ptr<OutputFile>> files_;
};

}  // namespace fcl_ccd

#endif
