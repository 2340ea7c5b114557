// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_RUN_COMMAND_H
#define FCL_CCD_RUN_COMMAND_H

#include <optional>
#include <string>
#include <vector>

#include "frame_list.h"
#include "run_report.h"
#include "scene.h"

namespace fcl_ccd {

struct RunOptions {
  std::vector<std::string> frames;   ///< of mesh A, as listFrames() takes them
  std::vector<std::string> against;  ///< of mesh B: none, one frame, or as many as of A
  FrameRange range;
  QuerySettings settings;      ///< but for num_threads
  std::optional<int> jobs;     ///< steps side by side; 0: as many as there are cores
  std::optional<int> threads;  ///< of a step; 0: as many as there are cores
  std::optional<double> weld;  ///< distance at which vertices are joined
  std::string contacts_path;   ///< empty: not written, as for the others
  ContactColumns columns;
  std::string steps_path;
  std::string json_path;
  std::string paint_path;
  bool resume{false};
};

// Exit codes of the program.
constexpr int kRefused = 2;     ///< nothing was begun, no file written or changed
constexpr int kBadFrame = 3;    ///< stopped on the way by a frame
constexpr int kNotWritten = 4;  ///< stopped on the way by an output
constexpr int kSignalled =
    128;  ///< stopped on the way by a signal, whose number is added

/// @brief `fcl-ccd run`: every consecutive pair of frames, a table on stdout, files.
/// @return the exit code; a run that was stopped on the way has said so on stderr.
/// @throws std::runtime_error that names the file and the cause, when nothing was begun.
int runCommand(const RunOptions& options);

}  // namespace fcl_ccd

#endif
