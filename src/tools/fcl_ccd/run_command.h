// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_RUN_COMMAND_H
#define FCL_CCD_RUN_COMMAND_H

#include <optional>
#include <string>
#include <vector>

#include "contact_list.h"
#include "frame_list.h"
#include "ranks.h"
#include "scene.h"
#include "shown_steps.h"

namespace fcl_ccd {

struct RunOptions {
  std::vector<std::string> frames;   ///< frames of mesh A, in the form of listFrames()
  std::vector<std::string> against;  ///< of mesh B: none, one frame, or as many as of A
  FrameRange range;
  StepSettings settings;       ///< num_threads is not used
  std::optional<int> jobs;     ///< steps at the same time; 0: as many as cores
  std::optional<int> threads;  ///< threads of a step; 0: as many as cores
  std::optional<double> weld;  ///< distance at which vertices are joined
  std::string contacts_path;   ///< empty: not written; also for the others
  ContactColumns columns;
  std::string steps_path;
  std::string json_path;
  std::string picture_path;
  std::string paint_path;
  ShownMoments shown;         ///< in the files of picture_path and paint_path
  std::string report_path;    ///< of the page
  std::string report_folder;  ///< is made if it is not there; may be empty
  bool resume{false};
  /// Whether the run waits for frames that come later (range.is_growing), and the
  /// seconds without a new one after which it ends; may be infinite.
  std::optional<double> follow;

  bool writesFiles() const {
    return !contacts_path.empty() || !steps_path.empty() || !json_path.empty() ||
           !picture_path.empty() || !paint_path.empty() || !report_path.empty();
  }
};

// Exit codes of the program.
constexpr int kRefused = 2;      ///< nothing was begun, no file was changed
constexpr int kBadFrame = 3;     ///< a frame stopped the run
constexpr int kNotWritten = 4;   ///< an output stopped the run
constexpr int kRankLost = 5;     ///< a process of mpirun died
constexpr int kUnfinished = 6;   ///< frames at the end are still being written
constexpr int kSignalled = 128;  ///< a signal stopped the run; its number is added

/// @brief `fcl-ccd run`: tests every pair of consecutive frames, prints a table to
/// stdout, and writes files. With several ranks the first one prints and writes.
/// @param command  the command line, which is the same on all ranks.
/// @return the exit code. If the run was stopped after its begin, stderr has the cause.
/// @throws std::runtime_error that names the file and the cause, if nothing was begun.
int runCommand(const RunOptions& options, Ranks& ranks, const std::string& command);

}  // namespace fcl_ccd

#endif
