// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_STEP_RECORD_H
#define FCL_CCD_STEP_RECORD_H

#include <optional>
#include <string>

#include "run_report.h"

namespace fcl_ccd {

/// @brief The results of a step, ready for the outputs. A text is empty if its output is
/// not written.
struct StepRecord {
  std::size_t number{0};
  RunSummary summary;
  std::string row;
  std::string contact_lines;
  std::string step_line;
  std::string json;
  std::string painted;       ///< a PLY
  std::string picture;       ///< a PNG
  std::string page;          ///< elements of the page
  std::string page_picture;  ///< a PNG, if the step may be that of the first contact
};

/// @brief What comes next of the steps of one process: a step, or their end.
struct StepOutcome {
  std::optional<StepRecord> record;
  int end_code{0};    ///< without a record: 0 or an exit code of the program
  std::string cause;  ///< of an exit code that is not 0
};

/// @brief The end after a signal.
StepOutcome endBySignal();

/// @brief An outcome as a message to another process, and back.
std::string toBytes(const StepOutcome& outcome);
StepOutcome outcomeOf(const std::string& bytes);

}  // namespace fcl_ccd

#endif
