// SPDX-License-Identifier: BSD-3-Clause
//
// The options of `fcl-ccd run` that show contacts: --report, --picture, --paint.
#ifndef FCL_CCD_SHOW_OPTIONS_H
#define FCL_CCD_SHOW_OPTIONS_H

#include <CLI/CLI.hpp>

#include "run_command.h"

namespace fcl_ccd {

/// @brief A validator of names of output files.
CLI::Validator namedFile();

void addShowOptions(CLI::App& run, RunOptions& options);

/// @brief After the command line was read: a folder of --report names the files in it
/// that have no other name.
/// @throws CLI::ValidationError if options contradict each other.
void expandReport(RunOptions& options);

}  // namespace fcl_ccd

#endif
