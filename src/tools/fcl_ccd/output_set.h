// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_OUTPUT_SET_H
#define FCL_CCD_OUTPUT_SET_H

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "output_file.h"
#include "output_lock.h"

namespace fcl_ccd {

/// @brief Prints to stdout and flushes it.
/// @throws WriteError if the text was not written.
void print(std::string_view text);

/// @brief Prints to stdout, or to stderr if stdout has an output.
void print(std::string_view text, bool to_stderr);

/// @brief Throws WriteError if an output that is written at the end is a file that came
/// as an input meanwhile.
void requireNotAmong(const std::vector<std::string>& inputs, const std::string& output);

/// @brief The output files of one run of the program. Each file has one name. Either all
/// files that it opens appear, or none.
class OutputSet {
 public:
  /// @param inputs  files that must not be overwritten.
  explicit OutputSet(std::vector<std::string> inputs) : taken_(std::move(inputs)) {}

  /// @brief Reserves the name of an output that is opened later, and locks it; does
  /// nothing for an empty path.
  /// @throws std::runtime_error for the same reasons as open(); makes or changes no file.
  void reserve(const std::string& path);

  /// @brief Refuses outputs that are files of the set. There may be many: each file is
  /// looked up once.
  /// @throws std::runtime_error that names the first one.
  void requireNotTaken(const std::vector<std::string>& outputs) const;

  /// @brief The lock of an output that was reserved.
  const OutputLock& lockOf(const std::string& path) const;

  /// @brief Whether an output goes to stdout, so that nothing else can.
  bool hasStandardOutput() const;

  /// @brief Opens a file for writing; null for an empty path.
  /// @throws std::runtime_error when it cannot be written, is an input or an output, or
  /// another run writes it.
  OutputFile* open(const std::string& path);

  /// @brief Completes all files, then makes all of them appear.
  void publish();

 private:
  std::vector<std::string> taken_;
  std::vector<std::unique_ptr<OutputLock>> locks_;
  std::vector<std::unique_ptr<OutputFile>> files_;
};

}  // namespace fcl_ccd

#endif
