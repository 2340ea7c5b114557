// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_RESUME_H
#define FCL_CCD_RESUME_H

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "run_report.h"

namespace fcl_ccd {

/// @brief The files that grow with each step, and what a run would write into them.
struct GrowingOutputs {
  std::string contacts_path;  ///< empty: not written
  std::string contacts_head;
  std::string steps_path;  ///< empty: not written
  std::string steps_head;
  std::size_t num_steps{0};
  std::function<std::vector<std::string>(std::size_t)> filesOf;  ///< of a step
};

/// @brief Where a run goes on.
struct ResumePoint {
  std::size_t step{0};             ///< the first that is to be done
  std::uint64_t contacts_size{0};  ///< bytes of the files that stay
  std::uint64_t steps_size{0};
  RunSummary summary;  ///< of the steps before; only with a list of steps
};

/// @brief Finds the steps whose output is whole, whenever the run was ended that wrote
/// it. (1) The list of steps tells how many were done, and how many contacts each had.
/// (2) Without it the contact list does: its last step may be cut short and is done
/// again. (3) A file that is missing or empty has no step.
/// @param latest  the point is not after this step.
/// @throws std::runtime_error that names the file when it was not written by such a run.
ResumePoint findResumePoint(const GrowingOutputs& outputs, std::size_t latest);

}  // namespace fcl_ccd

#endif
