// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_QUERIES_COMMAND_H
#define FCL_CCD_QUERIES_COMMAND_H

#include <string>
#include <vector>

#include "elementary/elementary.h"

namespace fcl_ccd {

struct QueriesOptions {
  std::vector<std::string> files;
  fcl::ContinuousContactKind kind{fcl::ContinuousContactKind::kVertexFace};
  double toc_err{1e-4};
  int repeat{1};
  bool print_answers{false};
  std::string json_path;  ///< empty: not written
};

/// @brief `fcl-ccd queries`: runs the elementary test on every query of the files.
/// @throws std::runtime_error that names the file and the cause.
void queriesCommand(const QueriesOptions& options);

}  // namespace fcl_ccd

#endif
