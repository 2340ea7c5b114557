// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_FRAME_WATCH_H
#define FCL_CCD_FRAME_WATCH_H

#include <chrono>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "run_inputs.h"

namespace fcl_ccd {

/// @brief Waits for frames that another program is still writing (RunOptions::follow).
///
/// Waiting ends at a signal, after the last frame (range.end), and when nothing has come
/// for the time of options.follow: no file, and no byte of the file that is next.
class FrameWatch {
 public:
  /// @param tell  is called with a line for the user if the first frames do not come, or
  /// if a frame is waited for that was begun and does not grow.
  FrameWatch(const RunOptions& options, std::function<void(const std::string&)> tell);

  /// @brief Waits for two frames, of which the first is whole.
  /// @throws std::runtime_error if they do not come, or cannot come (range.end), or if
  /// the first one cannot be read and the second one can; StoppedBySignal.
  FramePaths waitForFirst();

  /// @brief Waits for frames and adds those that are whole.
  /// @return false if the run ends.
  /// @throws std::runtime_error if a file does not fit, or came among earlier ones.
  bool waitForMore(FramePaths& paths, RunInputs& inputs, std::size_t num_workers);

 private:
  using Clock = std::chrono::steady_clock;

  /// @brief Notes what there is now. Returns whether it is time to give up.
  bool isIdle(std::size_t num_frames, const std::string& next);
  bool isLast(const FramePaths& paths) const;
  bool endsBeforeTwo(const FramePaths& paths) const;
  /// @brief Why the first frames are not there yet: "A needs two frames or more ...".
  std::string shortage(const FramePaths& paths) const;
  /// @brief The first frame that is still being written.
  std::optional<FrameFault> firstUnfinished(const FramePaths& paths) const;
  void tellOnce(const FrameFault& fault);
  void pause(Clock::time_point begin) const;

  const RunOptions& options_;
  std::function<void(const std::string&)> tell_;
  Clock::time_point last_news_{Clock::now()};
  std::string last_state_;
  std::string told_;  ///< the cause that the user knows
};

}  // namespace fcl_ccd

#endif
