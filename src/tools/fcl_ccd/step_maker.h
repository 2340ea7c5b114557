// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_STEP_MAKER_H
#define FCL_CCD_STEP_MAKER_H

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "frame_store.h"
#include "page_block.h"
#include "run_command.h"
#include "run_inputs.h"
#include "scene.h"
#include "shown_steps.h"
#include "step_record.h"
#include "step_share.h"

namespace fcl_ccd {

struct Parallelism {
  std::size_t jobs{1};  ///< steps at the same time
  int threads{1};       ///< of each step
};

/// @brief Makes the records of the steps of a share. Several threads may make different
/// records at the same time. The arguments must outlive it.
class StepMaker {
 public:
  StepMaker(const RunOptions& options, const FramePaths& paths, const RunInputs& inputs,
            const Parallelism& parallelism, const StepShare& share);

  /// @param i       of the share: its i-th step.
  /// @param worker  the calling thread, below the number of jobs.
  /// @throws std::runtime_error that names the frames and the cause.
  StepRecord make(std::size_t i, std::size_t worker);

  const StepShare& share() const { return share_; }

  /// @brief Goes on with other steps, between two calls of make(). Trees are kept.
  void setShare(const StepShare& share);

  std::size_t numJobs() const { return scenes_.size(); }

 private:
  void announce(std::size_t i) const;
  StepResult query(const SceneFrame& from, const SceneFrame& to,
                   std::unique_ptr<Scene>& scene, std::size_t step) const;
  StepRecord record(const StepReport& report) const;
  void show(const StepReport& report, std::size_t step, bool may_be_first,
            const SceneFrame& from, const SceneFrame& to, StepRecord& record) const;

  const RunOptions& options_;
  const FramePaths& paths_;
  const RunInputs& inputs_;
  StepSettings settings_;
  StepShare share_;
  std::size_t first_step_;  ///< of the run
  ViewGrid grid_;           ///< of the page
  FirstContactGuess first_contact_;
  FrameStore frames_a_;
  std::optional<FrameStore> frames_b_;
  std::vector<std::unique_ptr<Scene>> scenes_;  ///< one for each worker
};

}  // namespace fcl_ccd

#endif
