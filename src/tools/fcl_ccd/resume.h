// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_RESUME_H
#define FCL_CCD_RESUME_H

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "frame_list.h"
#include "run_report.h"

namespace fcl_ccd {

/// @brief The files that grow with each step, and what a run would write to them.
struct GrowingOutputs {
  std::string contacts_path;  ///< empty: not written
  std::string contacts_head;
  std::size_t step_column{0};  ///< of the contacts
  std::string steps_path;      ///< empty: not written
  std::string steps_head;
  std::size_t num_steps{0};
  FrameNumbers numbers;                                          ///< of the steps
  std::function<std::vector<std::string>(std::size_t)> filesOf;  ///< the files of a step
};

/// @brief The point at which a run continues.
struct ResumePoint {
  std::size_t step{0};             ///< the first step that is not done
  std::uint64_t contacts_size{0};  ///< bytes of the files that are kept
  std::uint64_t steps_size{0};
  RunSummary summary;  ///< of the previous steps; only with a list of steps
  /// The first of the previous steps with a contact.
  std::optional<std::size_t> first_contact;
};

/// @brief Finds the steps whose output is complete. The run that wrote it may have been
/// ended at any time.
/// (1) The list of steps tells how many steps were done, and how many contacts each had.
/// (2) Without it the contact list tells this. Its last step may be incomplete, and is
/// done again.
/// (3) A missing or empty file has no step.
/// @param latest  the point is at most this step.
/// @throws std::runtime_error that names the file if it was not written by such a run.
ResumePoint findResumePoint(const GrowingOutputs& outputs, std::size_t latest);

}  // namespace fcl_ccd

#endif
