// SPDX-License-Identifier: BSD-3-Clause
#include "frame_watch.h"

#include <sys/stat.h>

#include <algorithm>
#include <stdexcept>
#include <thread>
#include <utility>

#include "number_text.h"
#include "stop_signal.h"

namespace fcl_ccd {
namespace {

/// Size and time of a file: they change when its writer goes on.
std::string stateOf(const std::string& path) {
  struct stat status {};
  if (path.empty() || stat(path.c_str(), &status) != 0) return path;
  return path + ' ' + std::to_string(status.st_size) + ' ' +
         std::to_string(status.st_mtim.tv_sec) + ' ' +
         std::to_string(status.st_mtim.tv_nsec);
}

}  // namespace

FrameWatch::FrameWatch(const RunOptions& options,
                       std::function<void(const std::string&)> tell)
    : options_(options), tell_(std::move(tell)) {}

FramePaths FrameWatch::waitForFirst() {
  while (true) {
    const Clock::time_point begin = Clock::now();
    FramePaths paths = listFrames(options_);
    if (paths.a.size() >= 2) return paths;
    if (stopSignal() != 0)
      throw StoppedBySignal(
          "stopped by a signal before the first step. No file was written");
    if (isIdle(paths.a.size(), ""))
      throw std::runtime_error(options_.frames[0] +
                               ": A needs two frames or more. There are " +
                               std::to_string(paths.a.size()) + ", and none came in " +
                               numberText(*options_.follow, 6) + " seconds");
    pause(begin);
  }
}

bool FrameWatch::waitForMore(FramePaths& paths, RunInputs& inputs,
                             std::size_t num_workers) {
  last_news_ = Clock::now();
  while (stopSignal() == 0 && !isLast(paths)) {
    const Clock::time_point begin = Clock::now();
    const FramePaths listed = listFrames(options_);
    const std::size_t before = paths.a.size();
    addFrames(paths, inputs, listed, num_workers);
    if (paths.a.size() > before) return true;
    if (inputs.unfinished) tellOnce(*inputs.unfinished);
    const std::size_t next = paths.a.size();
    std::string state;
    if (inputs.unfinished) {
      state = stateOf(listed.a[next]);
      if (!listed.b_is_still && next < listed.b.size())
        state += ' ' + stateOf(listed.b[next]);
    }
    if (isIdle(next, state)) return false;
    pause(begin);
  }
  return false;
}

bool FrameWatch::isIdle(std::size_t num_frames, const std::string& next) {
  const std::string state = std::to_string(num_frames) + ' ' + next;
  const Clock::time_point now = Clock::now();
  if (state != last_state_) {
    last_state_ = state;
    last_news_ = now;
  }
  const std::chrono::duration<double> idle = now - last_news_;
  return idle.count() >= *options_.follow;
}

bool FrameWatch::isLast(const FramePaths& paths) const {
  if (!options_.range.end) return false;
  return static_cast<long long>(paths.a.size()) >
         (*options_.range.end - paths.numbers.first) / options_.range.stride;
}

void FrameWatch::tellOnce(const FrameFault& fault) {
  // A solver that writes steadily is not mentioned.
  constexpr std::chrono::seconds kPatience(10);
  if (fault.cause == told_ || Clock::now() - last_news_ < kPatience) return;
  told_ = fault.cause;
  tell_(fault.cause + ". Waiting for the rest of it");
}

void FrameWatch::pause(Clock::time_point begin) const {
  // At most a tenth of the time is spent with looking.
  const Clock::duration time =
      std::clamp<Clock::duration>(10 * (Clock::now() - begin),
                                  std::chrono::milliseconds(50), std::chrono::seconds(2));
  const Clock::time_point end = Clock::now() + time;
  while (stopSignal() == 0 && Clock::now() < end)
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
}

}  // namespace fcl_ccd
