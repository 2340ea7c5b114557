// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_OWN_STEPS_H
#define FCL_CCD_OWN_STEPS_H

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <mutex>
#include <optional>
#include <thread>

#include "step_maker.h"
#include "step_record.h"

namespace fcl_ccd {

/// @brief Makes the steps of one process on other threads, while the caller's thread
/// exchanges messages.
///
/// next() gives the records in order, then one outcome without a record: the end. After a
/// signal or stop() no new step is begun, and the end follows the steps that were begun.
class OwnSteps {
 public:
  explicit OwnSteps(StepMaker& maker);
  OwnSteps(const OwnSteps&) = delete;
  OwnSteps& operator=(const OwnSteps&) = delete;
  ~OwnSteps();

  /// @brief The next outcome, or nothing if there is none in this time.
  std::optional<StepOutcome> next(std::chrono::milliseconds time);

  void stop();

 private:
  void run();
  StepOutcome makeAll();
  void put(StepOutcome outcome);

  StepMaker& maker_;
  std::atomic<bool> stopped_{false};
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<StepOutcome> outcomes_;
  std::thread thread_;  ///< the last: it uses all others
};

}  // namespace fcl_ccd

#endif
