// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_QUERIES_COMMAND_H
#define FCL_CCD_QUERIES_COMMAND_H

#include <optional>
#include <string>
#include <vector>

#include "csv_columns.h"
#include "fcl/narrowphase/continuous_contact_kind.h"

namespace fcl_ccd {

struct QueriesOptions {
  std::vector<std::string> files;  ///< or folders, in the form of listQueryFiles()
  std::optional<fcl::ContinuousContactKind> kind;
  double toc_err{1e-4};
  int repeat{1};
  bool print_answers{false};
  std::optional<ColumnNumbers> columns;  ///< of the answers; with them a first line
  std::string json_path;                 ///< empty: not written
};

/// @brief The columns that the answers can have.
std::vector<std::string> answerColumns();

/// @brief `fcl-ccd queries`: runs the elementary test on every query of the files.
/// @throws std::runtime_error that names the file and the cause.
void queriesCommand(const QueriesOptions& options);

}  // namespace fcl_ccd

#endif
