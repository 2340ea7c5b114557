// SPDX-License-Identifier: BSD-3-Clause
#include "progress_line.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "counted.h"

namespace fcl_ccd {
namespace {

// "Erase to the end of the line", so that a shorter text does not leave characters
// behind.
constexpr const char* kEraseRest = "\x1b[K";

/// Begins a line of a log.
constexpr char kName[] = "fcl-ccd: ";

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

/// The longest line that a terminal shows as one, and at most 79 characters.
std::size_t widthOfLine() {
  constexpr std::size_t kWidest = 80;
  winsize size{};
  std::size_t width = kWidest;
  if (ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0)
    width = std::min<std::size_t>(width, size.ws_col);
  return width - 1;
}

}  // namespace

ProgressLine::ProgressLine() : is_terminal_(isatty(STDERR_FILENO) != 0) {}

void ProgressLine::show(const std::string& text) {
  if (!is_terminal_) return;
  const std::string line = text.substr(0, widthOfLine());
  std::fprintf(stderr, "\r%s%s", line.c_str(), kEraseRest);
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
    std::fprintf(stderr, "%s%s\n", kName, text(num_done, num_contacts, now).c_str());
  }
  last_ = now;
}

std::string ProgressLine::text(std::size_t num_done, std::size_t num_contacts,
                               Clock::time_point now) const {
  std::string text = std::to_string(num_done) + " of " + counted(num_steps_, "step");
  std::vector<std::string> parts{counted(num_contacts, "contact")};
  if (num_done != num_done_before_) {
    const double seconds = std::chrono::duration<double>(now - begin_).count() /
                           static_cast<double>(num_done - num_done_before_);
    char rate[64];
    std::snprintf(rate, sizeof rate, "%.3g ms a step", 1e3 * seconds);
    parts.push_back(rate);
    parts.push_back(clockText(seconds * static_cast<double>(num_steps_ - num_done)) +
                    " left");
  }
  const std::size_t width = widthOfLine() - (is_terminal_ ? 0 : sizeof kName - 1);
  for (const std::string& part : parts)
    if (text.size() + 2 + part.size() <= width) text += ", " + part;
  // The bar takes what is left.
  constexpr std::size_t kMostBar = 24, kLeastBar = 8, kFrame = 3;
  if (!is_terminal_ || text.size() + kFrame + kLeastBar > width) return text;
  const std::size_t bar = std::min(kMostBar, width - text.size() - kFrame);
  const std::size_t full =
      std::min(num_done, num_steps_) * bar / std::max<std::size_t>(num_steps_, 1);
  return '[' + std::string(full, '#') + std::string(bar - full, '.') + "] " + text;
}

void ProgressLine::clear() {
  if (shown_) std::fprintf(stderr, "\r%s", kEraseRest);
  shown_ = false;
}

}  // namespace fcl_ccd
