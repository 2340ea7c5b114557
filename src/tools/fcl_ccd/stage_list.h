// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_STAGE_LIST_H
#define FCL_CCD_STAGE_LIST_H

#include <cstdint>

#include "fcl/narrowphase/stage_counts.h"

namespace fcl_ccd {

/// @brief One count of fcl::StageCounts, with its name.
struct StageField {
  const char* name;
  std::uint64_t fcl::StageCounts::*count;
};

/// @brief All counts, in the order of the pipeline.
constexpr StageField kStages[] = {{"node_pairs", &fcl::StageCounts::node_pairs},
                                  {"triangle_pairs", &fcl::StageCounts::triangle_pairs},
                                  {"adjacent_pairs", &fcl::StageCounts::adjacent_pairs},
                                  {"fan_culled", &fcl::StageCounts::fan_culled},
                                  {"plane_culled", &fcl::StageCounts::plane_culled},
                                  {"feature_pairs", &fcl::StageCounts::feature_pairs},
                                  {"box_culled", &fcl::StageCounts::box_culled},
                                  {"mask_culled", &fcl::StageCounts::mask_culled},
                                  {"filter_culled", &fcl::StageCounts::filter_culled},
                                  {"solver_culled", &fcl::StageCounts::solver_culled},
                                  {"exact_culled", &fcl::StageCounts::exact_culled},
                                  {"exact_tests", &fcl::StageCounts::exact_tests},
                                  {"contacts", &fcl::StageCounts::contacts},
                                  {"crossing_tests", &fcl::StageCounts::crossing_tests}};
static_assert(sizeof kStages / sizeof *kStages * sizeof(std::uint64_t) ==
                  sizeof(fcl::StageCounts),
              "a stage is missing from the list");

}  // namespace fcl_ccd

#endif
