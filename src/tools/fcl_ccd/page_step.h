// SPDX-License-Identifier: BSD-3-Clause
//
// What the page of a run has of its mesh and of each step: script elements, which hold
// JSON or a block of page_block.h. report_page/blocks.js reads them.
#ifndef FCL_CCD_PAGE_STEP_H
#define FCL_CCD_PAGE_STEP_H

#include <cstddef>
#include <string>

#include "json.h"
#include "page_block.h"
#include "run_report.h"
#include "scene.h"

namespace fcl_ccd {

/// @brief The number of contacts of a step that the page names. It colours the triangles
/// of all.
constexpr std::size_t kMostContactsOnPage = 64;

/// @brief The grid for a run: finer for short runs, so that long ones stay small.
ViewGrid viewGrid(const SceneFrame& first, std::size_t num_steps);

/// @brief The triangles, and the first frame.
std::string pageMesh(const SceneTriangles& triangles, const SceneFrame& first,
                     const ViewGrid& grid);

/// @brief A step: its counts and times, its first contacts, the first time of each
/// triangle in contact, and how the vertices move.
/// @param is_key  whether it also has the frame where it begins, so that a reader need
/// not add up the motion of all steps before
std::string pageStep(const StepReport& report, const SceneTriangles& triangles,
                     const SceneFrame& from, const SceneFrame& to, const ViewGrid& grid,
                     bool is_key);

/// @brief JSON that may stand in a script element.
std::string scriptText(const Json& json);

}  // namespace fcl_ccd

#endif
