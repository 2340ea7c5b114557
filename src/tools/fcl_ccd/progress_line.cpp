// SPDX-License-Identifier: BSD-3-Clause
#include "progress_line.h"

#include <unistd.h>

#include <cstdio>

namespace fcl_ccd {

// "Erase to the end of the line", so that a shorter text leaves nothing behind.
constexpr const char* kEraseRest = "\x1b[K";

ProgressLine::ProgressLine() : is_terminal_(isatty(STDERR_FILENO) != 0) {}

void ProgressLine::show(const std::string& text) {
  if (!is_terminal_) return;
  std::fprintf(stderr, "\r%s%s", text.c_str(), kEraseRest);
  std::fflush(stderr);
  shown_ = true;
}

void ProgressLine::clear() {
  if (shown_) std::fprintf(stderr, "\r%s", kEraseRest);
  shown_ = false;
}

}  // namespace fcl_ccd
