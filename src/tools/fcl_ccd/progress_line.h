// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_PROGRESS_LINE_H
#define FCL_CCD_PROGRESS_LINE_H

#include <string>

namespace fcl_ccd {

/// @brief A line on stderr that is overwritten while the work goes on. Silent unless
/// stderr is a terminal.
class ProgressLine {
 public:
  ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;
  ~ProgressLine() { clear(); }

  void show(const std::string& text);

  /// @brief Wipes the line, before something else is printed.
  void clear();

 private:
  bool is_terminal_;
  bool shown_{false};
};

}  // namespace fcl_ccd

#endif
