// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_CANDIDATES_COMMAND_H
#define FCL_CCD_CANDIDATES_COMMAND_H

#include <optional>
#include <string>
#include <vector>

#include "csv_columns.h"
#include "run_command.h"

namespace fcl_ccd {

struct CandidatesOptions {
  RunOptions step;  ///< used: frames, against, weld, settings.self, settings.min_distance
  std::string output_path{"-"};
  std::optional<ColumnNumbers> columns;
};

/// @brief The columns that candidates can have.
std::vector<std::string> candidateColumns();

/// @brief `fcl-ccd candidates`: writes the pairs of features of a step that a query would
/// test.
/// @throws std::runtime_error that names the file and the cause.
void candidatesCommand(const CandidatesOptions& options);

}  // namespace fcl_ccd

#endif
