// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_SCENE_COMMAND_H
#define FCL_CCD_SCENE_COMMAND_H

#include <string>

#include "fcl/narrowphase/continuous_contact.h"
#include "frame_list.h"

namespace fcl_ccd {

struct SceneOptions {
  std::string path;  ///< of the scene file
  fcl::ContinuousQuery query{fcl::ContinuousQuery::kAll};
  double toc_err{1e-4};
  int threads{0};  ///< 0: as many as cores
  FrameRange range;
  std::string contacts_path;  ///< empty: not written
  std::string json_path;      ///< empty: not written
};

/// @brief `fcl-ccd run scene.json`: tests all objects with each other step by step,
/// prints a table to stdout, and writes files when all steps are done.
/// @return the exit code, as runCommand(). After a stop no file is written.
/// @throws std::runtime_error with the file, the line and the cause, if nothing was
/// begun.
int sceneCommand(const SceneOptions& options);

}  // namespace fcl_ccd

#endif
