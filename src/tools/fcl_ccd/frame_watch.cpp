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
  // A run that is started together with its solver is not mentioned. A wrong name is.
  constexpr std::chrono::seconds kPatience(1);
  const Clock::time_point start = Clock::now();
  bool is_told = false;
  while (true) {
    const Clock::time_point begin = Clock::now();
    FramePaths paths = listFrames(options_);
    if (endsBeforeTwo(paths))
      throw std::runtime_error(options_.frames[0] +
                               ": A needs two frames or more, but not more than one is "
                               "between --start and --end");
    const bool has_two = paths.a.size() >= 2;
    const std::optional<FrameFault> unfinished =
        has_two ? firstUnfinished(paths) : std::nullopt;
    if (has_two && !unfinished) return paths;
    if (stopSignal() != 0)
      throw StoppedBySignal(
          "stopped by a signal before the first step. No file was written");
    const std::string cause = unfinished ? unfinished->cause : shortage(paths);
    const std::string state =
        unfinished
            ? stateOf(paths.a[0]) + (paths.b.empty() ? "" : ' ' + stateOf(paths.b[0]))
            : cause;
    if (isIdle(paths.a.size(), state))
      throw std::runtime_error(
          cause + (unfinished ? ", and nothing came in " : ", and none came in ") +
          numberText(*options_.follow, 6) + " seconds");
    if (unfinished) tellOnce(*unfinished);
    if (!has_two && !is_told && Clock::now() - start >= kPatience) {
      is_told = true;
      tell_("waiting for frames: " + cause);
    }
    pause(begin);
  }
}

bool FrameWatch::endsBeforeTwo(const FramePaths& paths) const {
  const FrameRange& range = options_.range;
  if (!range.end) return false;
  const long long first = paths.a.empty() ? range.start.value_or(0) : paths.numbers.first;
  return *range.end - first < range.stride;
}

std::string FrameWatch::shortage(const FramePaths& paths) const {
  // The lists of A and B are as long as the shorter one.
  const auto count = [&](const std::vector<std::string>& words) {
    return listFrames(words, options_.range).size();
  };
  std::size_t number = count(options_.frames);
  const bool is_b = number >= 2 && !options_.against.empty() && !paths.b_is_still;
  if (is_b) number = count(options_.against);
  const std::string& word = is_b ? options_.against[0] : options_.frames[0];
  return word + ": " + (is_b ? "B" : "A") + " needs two frames or more. There " +
         (number == 1 ? "is " : "are ") + std::to_string(number);
}

std::optional<FrameFault> FrameWatch::firstUnfinished(const FramePaths& paths) const {
  const auto faultOf = [](const std::string& path) -> std::optional<FrameFault> {
    try {
      readPolygonMesh(path);
    } catch (const std::runtime_error& error) {
      return FrameFault{0, error.what()};
    }
    return std::nullopt;
  };
  const auto isRegularMesh = [](const std::string& path) {
    struct stat status {};
    return stat(path.c_str(), &status) == 0 && S_ISREG(status.st_mode) &&
           isMeshFormat(extensionOf(path));
  };
  for (const auto* frames : {&paths.a, &paths.b}) {
    if (frames->size() < 2) continue;  // B stands still, or there is none
    std::optional<FrameFault> fault = faultOf((*frames)[0]);
    if (!fault) continue;
    // A frame with a whole one behind it is not half-written.
    if (!isRegularMesh((*frames)[0]) || !faultOf((*frames)[1]))
      throw std::runtime_error(fault->cause);
    return fault;
  }
  return std::nullopt;
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
