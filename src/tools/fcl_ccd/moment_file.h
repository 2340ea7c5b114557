// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_MOMENT_FILE_H
#define FCL_CCD_MOMENT_FILE_H

#include <cstddef>
#include <optional>
#include <string>

#include "output_file.h"

namespace fcl_ccd {

/// @brief The output of --picture or --paint: one file, or a file a step if its name has
/// a number. All functions throw WriteError.
class MomentFile {
 public:
  /// @param is_of_first  whether the one file is for the step of the first contact
  MomentFile(const std::string& path, bool is_of_first);

  /// @brief Takes the content for a step, in the order of the steps. A file a step
  /// appears at once.
  /// @param bytes  empty: none is for this step
  void add(std::size_t number, const std::string& bytes, bool has_contact);

  /// @brief Writes the one file, if there is something for it; it appears when it is
  /// published.
  OutputFile* finish();

 private:
  std::string path_;
  bool is_of_first_;
  std::optional<OutputFile> file_;  ///< the one file
  std::string bytes_;
  bool has_contact_{false};
};

}  // namespace fcl_ccd

#endif
