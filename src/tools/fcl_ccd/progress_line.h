// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_PROGRESS_LINE_H
#define FCL_CCD_PROGRESS_LINE_H

#include <chrono>
#include <cstddef>
#include <string>

namespace fcl_ccd {

/// @brief How far the work is, on stderr. On a terminal a line that is overwritten; else
/// a line every half minute, so that a log tells it too.
class ProgressLine {
 public:
  ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;
  ~ProgressLine() { clear(); }

  /// @brief Shows a text on a terminal.
  void show(const std::string& text);

  /// @brief From here on steps are counted; so many were done at another time.
  void begin(std::size_t num_steps, std::size_t num_done);

  /// @brief Shows a bar, contacts, time a step and time left, unless that was just done.
  void step(std::size_t num_done, std::size_t num_contacts);

  /// @brief Wipes the line, before something else is printed.
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
