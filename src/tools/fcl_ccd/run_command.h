// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_RUN_COMMAND_H
#define FCL_CCD_RUN_COMMAND_H

#include <string>
#include <vector>

#include "scene.h"

namespace fcl_ccd {

struct RunOptions {
  std::vector<std::string> frames;   ///< files of mesh A, at least two
  std::vector<std::string> against;  ///< files of mesh B, none or as many
  QuerySettings settings;
  std::string contacts_path;  ///< empty: not written, as for the others
  std::string json_path;
  std::string paint_path;
};

/// @brief `fcl-ccd run`: every consecutive pair of frames, a table on stdout, files when
/// everything has succeeded.
/// @throws std::runtime_error that names the file and the cause.
void runCommand(const RunOptions& options);

}  // namespace fcl_ccd

#endif
