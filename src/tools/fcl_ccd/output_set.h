// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_OUTPUT_SET_H
#define FCL_CCD_OUTPUT_SET_H

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "output_file.h"

namespace fcl_ccd {

/// @brief Prints to stdout and flushes it.
/// @throws WriteError if the text was not written.
void print(std::string_view text);

/// @brief The output files of one run of the program. Each file has one name. Either all
/// files that it opens appear, or none.
class OutputSet {
 public:
  /// @param inputs  files that must not be overwritten.
  explicit OutputSet(std::vector<std::string> inputs) : taken_(std::move(inputs)) {}

  /// @brief Reserves the name of an output that is opened later; does nothing for an
  /// empty path.
  /// @throws std::runtime_error for the same reasons as open(); makes or changes no file.
  void reserve(const std::string& path);

  /// @brief Opens a file for writing; null for an empty path.
  /// @throws std::runtime_error when it cannot be written, or is an input or an output.
  OutputFile* open(const std::string& path);

  /// @brief Completes all files, then makes all of them appear.
  void publish();

 private:
  std::vector<std::string> taken_;
  std::vector<std::unique_ptr<OutputFile>> files_;
};

}  // namespace fcl_ccd

#endif
