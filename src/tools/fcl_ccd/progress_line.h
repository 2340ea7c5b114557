// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_PROGRESS_LINE_H
#define FCL_CCD_PROGRESS_LINE_H

#include <chrono>
#include <cstddef>
#include <string>

namespace fcl_ccd {

/// @brief Shows the progress of the work on stderr: on a terminal a line that is
/// overwritten; otherwise a new line every half minute, for a log. No line is longer than
/// 79 characters, or than the terminal is wide.
class ProgressLine {
 public:
  ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;
  ~ProgressLine() { clear(); }

  /// @brief Shows a text on a terminal.
  void show(const std::string& text);

  /// @brief Starts to count steps, and tells how many were done by an earlier run.
  void begin(std::size_t num_steps, std::size_t num_done);

  /// @brief Changes the number of steps.
  void expect(std::size_t num_steps) { num_steps_ = num_steps; }

  /// @brief Shows a bar, the number of contacts, time per step and time left, unless it
  /// did so a moment ago.
  void step(std::size_t num_done, std::size_t num_contacts);

  /// @brief Clears the line, before other text is printed.
  void clear();

 private:
  using Clock = std::chrono::steady_clock;

  std::string text(std::size_t num_done, std::size_t num_contacts,
                   Clock::time_point now) const;

  bool is_terminal_;
  bool shown_{false};
  std::size_t num_steps_{0};
  std::size_t num_done_before_{0};
  Clock::time_point begin_{};
  Clock::time_point last_{};
};

}  // namespace fcl_ccd

#endif
