// SPDX-License-Identifier: BSD-3-Clause
#include "progress_line.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace fcl_ccd {
namespace {

// "Erase to the end of the line", so that a shorter text does not leave characters
// behind.
constexpr const char* kEraseRest = "\x1b[K";

constexpr std::chrono::milliseconds kTerminalPeriod{100};
constexpr std::chrono::seconds kLogPeriod{30};

/// A time in the form 1:02:03.
std::string clockText(double seconds) {
  const long long whole = std::llround(seconds);
  char text[64];
  std::snprintf(text, sizeof text, "%lld:%02lld:%02lld", whole / 3600, whole / 60 % 60,
                whole % 60);
  return text;
}

}  // namespace

ProgressLine::ProgressLine() : is_terminal_(isatty(STDERR_FILENO) != 0) {}

void ProgressLine::show(const std::string& text) {
  if (!is_terminal_) return;
  std::fprintf(stderr, "\r%s%s", text.c_str(), kEraseRest);
  std::fflush(stderr);
  shown_ = true;
}

void ProgressLine::begin(std::size_t num_steps, std::size_t num_done) {
  num_steps_ = num_steps;
  num_done_before_ = num_done;
  begin_ = last_ = Clock::now();
}

void ProgressLine::step(std::size_t num_done, std::size_t num_contacts) {
  const Clock::time_point now = Clock::now();
  if (is_terminal_) {
    if (shown_ && now - last_ < kTerminalPeriod) return;
    show(text(num_done, num_contacts, now));
  } else {
    if (now - last_ < kLogPeriod) return;
    std::fprintf(stderr, "fcl-ccd: %s\n", text(num_done, num_contacts, now).c_str());
  }
  last_ = now;
}

std::string ProgressLine::text(std::size_t num_done, std::size_t num_contacts,
                               Clock::time_point now) const {
  std::string text;
  if (is_terminal_) {
    constexpr std::size_t kWidth = 24;
    const std::size_t full = num_done * kWidth / std::max<std::size_t>(num_steps_, 1);
    text = '[' + std::string(full, '#') + std::string(kWidth - full, '.') + "] ";
  }
  text += std::to_string(num_done) + " of " + std::to_string(num_steps_) + " steps, " +
          std::to_string(num_contacts) + " contacts";
  if (num_done == num_done_before_) return text;
  const double seconds = std::chrono::duration<double>(now - begin_).count() /
                         static_cast<double>(num_done - num_done_before_);
  char rate[64];
  std::snprintf(rate, sizeof rate, ", %.3g ms a step, ", 1e3 * seconds);
  return text + rate + clockText(seconds * static_cast<double>(num_steps_ - num_done)) +
         " left";
}

void ProgressLine::clear() {
  if (shown_) std::fprintf(stderr, "\r%s", kEraseRest);
  shown_ = false;
}

}  // namespace fcl_ccd
