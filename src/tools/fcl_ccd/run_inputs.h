// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_RUN_INPUTS_H
#define FCL_CCD_RUN_INPUTS_H

#include <cstddef>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "mesh_sequence.h"
#include "run_command.h"

namespace fcl_ccd {

/// @brief A signal asked the program to stop before anything was begun.
struct StoppedBySignal : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// @brief The names of the frames of A and B.
struct FramePaths {
  std::vector<std::string> a, b;
  bool b_is_still{false};  ///< B has one frame, and does not move
  FrameNumbers numbers;    ///< of the frames of A, and of the steps that begin there

  std::size_t numSteps() const { return a.empty() ? 0 : a.size() - 1; }

  /// @brief Keeps the first frames only.
  void shorten(std::size_t num_frames);

  /// @brief The files of a step: both frames of A, then both of B, or the only one of B
  /// if it stands still.
  std::vector<std::string> filesOf(std::size_t step) const;
};

/// @brief Names the frames. If they may still grow in number (options.range), there may
/// be none, and frames without counterpart are left out.
/// @throws std::runtime_error if a frame has no counterpart.
FramePaths listFrames(const RunOptions& options);

/// @brief A frame that cannot be used.
struct FrameFault {
  std::size_t frame;
  std::string cause;  ///< names the file
};

/// @brief The meshes of a run.
struct RunInputs {
  MeshSequence a;
  std::optional<MeshSequence> b;
  /// The first of the frames at the end that are still being written. They were dropped.
  std::optional<FrameFault> unfinished;

  SceneTriangles triangles() const {
    return {&a.triangles(), b ? &b->triangles() : nullptr, &a.free(),
            b ? &b->free() : nullptr};
  }
  bool bMoves() const { return b && b->size() > 1; }
  void shorten(std::size_t num_frames);
};

/// @brief Reads the first frames, checks all others on `num_workers` threads, and joins
/// vertices if this is requested. Frames at the end that are still being written are
/// dropped, from `paths` too, as long as two frames are left (one if more may come).
/// @param[out] notes  lines for the user.
/// @throws std::runtime_error that names the first file that does not fit;
/// StoppedBySignal.
RunInputs openInputs(FramePaths& paths, const RunOptions& options,
                     std::size_t num_workers, std::vector<std::string>& notes);

/// @brief Adds the frames that came since. It ends before the first one that is still
/// being written, or does not fit; this one becomes inputs.unfinished. Adds nothing if a
/// signal came.
/// @param paths   of the run; is extended.
/// @param listed  all frames that there are now.
/// @throws std::runtime_error if the next frame does not fit and none is being written,
/// or if a file came among earlier ones or is gone.
void addFrames(FramePaths& paths, RunInputs& inputs, const FramePaths& listed,
               std::size_t num_workers);

}  // namespace fcl_ccd

#endif
