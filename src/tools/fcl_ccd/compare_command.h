// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_COMPARE_COMMAND_H
#define FCL_CCD_COMPARE_COMMAND_H

#include <optional>
#include <string>
#include <vector>

#include "fcl/narrowphase/continuous_contact_kind.h"

namespace fcl_ccd {

struct CompareOptions {
  /// Two frames; or files of queries or folders, in the form of listQueryFiles().
  std::vector<std::string> inputs;
  std::optional<fcl::ContinuousContactKind> kind;
  std::vector<std::string> truth;  ///< files of answers or of pairs
  double toc_err{1e-4};
  int repeat{1};
  std::string json_path;  ///< empty: not written
};

/// @brief `fcl-ccd compare`: compares answers with the truth, and prints one row.
/// @throws std::runtime_error that names the file and the cause.
void compareCommand(const CompareOptions& options);

}  // namespace fcl_ccd

#endif
