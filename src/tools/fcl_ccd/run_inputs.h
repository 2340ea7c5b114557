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

  std::size_t numSteps() const { return a.size() - 1; }

  /// @brief The files of a step: both frames of A, then both of B, or the only one of B
  /// if it stands still.
  std::vector<std::string> filesOf(std::size_t step) const;
};

/// @throws std::runtime_error if a frame has no counterpart.
FramePaths listFrames(const RunOptions& options);

/// @brief The meshes of a run.
struct RunInputs {
  MeshSequence a;
  std::optional<MeshSequence> b;

  SceneTriangles triangles() const {
    return {&a.triangles(), b ? &b->triangles() : nullptr, &a.free(),
            b ? &b->free() : nullptr};
  }
};

/// @brief Reads the first frames, checks all others on `num_workers` threads, and joins
/// vertices if this is requested.
/// @param[out] notes  lines for the user.
/// @throws std::runtime_error that names the first file that does not fit;
/// StoppedBySignal.
RunInputs openInputs(const FramePaths& paths, const RunOptions& options,
                     std::size_t num_workers, std::vector<std::string>& notes);

}  // namespace fcl_ccd

#endif
