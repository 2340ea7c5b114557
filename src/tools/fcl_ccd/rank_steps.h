// SPDX-License-Identifier: BSD-3-Clause
//
// The steps of one run on several ranks. Each rank makes the steps of its StepShare and
// sends them to rank 0 in order. Rank 0 makes its own, and has the outputs.
//
// Messages. Each rank but 0: a Readiness; then, if rank 0 begins, a StepOutcome for each
// of its steps and one for their end. Rank 0: to all others the first step and the end of
// the steps, or nothing if the run is refused; at the end of the run nothing.
#ifndef FCL_CCD_RANK_STEPS_H
#define FCL_CCD_RANK_STEPS_H

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "own_steps.h"
#include "ranks.h"
#include "step_record.h"

namespace fcl_ccd {

/// @brief What a rank tells rank 0 before a run. All ranks must have the same command and
/// number of steps.
struct Readiness {
  std::string command;       ///< the command line
  std::size_t num_steps{0};  ///< of its frames
  std::string cause;         ///< why the rank cannot begin; empty if it can
  /// Steps of frames that are whole; another program may still be writing the last ones.
  std::size_t num_whole_steps{0};
  std::string unfinished;  ///< which frame is not whole, and why
};

/// @brief The steps [first, end) of a run.
struct StepRange {
  std::size_t first{0}, end{0};
};

/// @brief Rank 0's side of a run.
class RankGatherer {
 public:
  explicit RankGatherer(Ranks& ranks)
      : ranks_(ranks), has_ended_(static_cast<std::size_t>(ranks.size()), false) {}

  /// @brief Begins the run on all ranks.
  /// @param firstStepOf  the first step, if all ranks have so many whole steps and no
  /// more. It may throw.
  /// @throws std::runtime_error that names a rank which cannot begin, and the cause. Then
  /// no rank begins.
  StepRange begin(const Readiness& own,
                  const std::function<std::size_t(const Readiness&)>& firstStepOf);

  /// @brief Instead of begin(): no rank begins.
  void refuse();

  /// @brief Takes the steps of all ranks in order.
  /// @param share  of rank 0.
  /// @return the end that came instead of a step; an end without a cause if all were
  /// taken.
  StepOutcome take(OwnSteps& own, const StepShare& share,
                   const std::function<void(std::size_t, const StepRecord&)>& take);

  /// @brief Stops the steps of all ranks and waits for their ends.
  void end(OwnSteps& own);

 private:
  Ranks& ranks_;
  std::vector<bool> has_ended_;  ///< for each rank
};

/// @brief Another rank: asks to begin.
/// @return the steps of the run, or nothing if the run is refused.
std::optional<StepRange> awaitBegin(Ranks& ranks, const Readiness& own);

/// @brief Another rank: sends its steps until their end, and waits for the end of the
/// run.
void sendSteps(Ranks& ranks, OwnSteps& own);

}  // namespace fcl_ccd

#endif
