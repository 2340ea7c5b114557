// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_ONE_STEP_H
#define FCL_CCD_ONE_STEP_H

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "run_inputs.h"

namespace fcl_ccd {

/// @brief The meshes of a command that has one step, from the first frame to the second.
class OneStep {
 public:
  /// @brief Names the frames.
  /// @param options  frames, against, weld and settings are used; must outlive this
  /// @throws std::runtime_error if A has not two frames
  explicit OneStep(const RunOptions& options);

  /// @brief The files of the frames.
  std::vector<std::string> files() const { return paths_.filesOf(0); }

  /// @brief Reads them and builds the models. Prints notes for the user to stderr.
  /// @throws std::runtime_error that names the file and the cause
  void read();

  // After read().

  const RunInputs& inputs() const { return *inputs_; }

  /// @brief The candidates, and the answer of a query.
  /// @throws std::runtime_error that names the frames and the cause
  std::vector<SceneCandidate> candidates();
  StepResult query();

 private:
  SceneFrame from() const { return {&inputs_->a.firstVertices(), fromB()}; }
  SceneFrame to() const { return {&to_a_, inputs_->bMoves() ? &to_b_ : fromB()}; }
  const Vertices* fromB() const {
    return inputs_->b ? &inputs_->b->firstVertices() : nullptr;
  }
  template <typename Work>
  auto namingFrames(Work work);

  const RunOptions& options_;
  FramePaths paths_;
  std::optional<RunInputs> inputs_;
  Vertices to_a_, to_b_;
  std::unique_ptr<Scene> scene_;
};

}  // namespace fcl_ccd

#endif
