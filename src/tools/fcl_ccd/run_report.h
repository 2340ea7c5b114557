// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_RUN_REPORT_H
#define FCL_CCD_RUN_REPORT_H

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "contact_text.h"
#include "json.h"
#include "mesh_io.h"
#include "scene.h"

namespace fcl_ccd {

/// @brief The report of a step.
struct StepReport {
  std::size_t number{0};
  std::size_t vertices{0};         ///< of all meshes
  std::size_t triangles{0};        ///< of all meshes
  std::vector<std::string> files;  ///< of both frames of A, then of those of B
  StepResult result;
};

/// @brief The summary of a run, added up from its steps.
struct RunSummary {
  std::size_t steps{0};
  std::size_t vf{0};
  std::size_t ee{0};
  bool at_distance{false};  ///< whether the next two mean something
  std::size_t ve{0};
  std::size_t vv{0};
  std::size_t crossings{0};           ///< of an edge and a face
  std::size_t crossing_steps{0};      ///< steps that began crossing
  bool is_any{false};                 ///< whether the query was for any contact
  std::size_t undecided_steps{0};     ///< may have begun crossing; only with is_any
  std::optional<FirstContact> first;  ///< of the first step with a contact or crossing
  std::size_t slowest_step{0};
  double slowest_ms{-1};  ///< of steps that have a time; negative: none has

  /// @brief The contacts and crossings: the rows of the contact list.
  std::size_t contacts() const { return vf + ee + ve + vv + crossings; }

  /// @brief Adds a step that is after all others.
  void add(const RunSummary& step);
};
RunSummary summaryOf(const StepReport& report);

/// @brief Head and rows of the table for the terminal, each with its line end. A line has
/// at most 80 characters, unless a number is longer than its column.
/// @param at_distance  whether there are contacts of a vertex and an edge, and of two
/// vertices
std::string tableHead(bool at_distance, fcl::ContinuousQuery query);
std::string tableRow(const StepReport& report);

/// @brief The summary as lines for the terminal.
std::string summaryLines(const RunSummary& summary, fcl::ContinuousQuery query);

/// @brief A line of the list of steps. It has only values that do not depend on the
/// machine, the number of threads, or the previous steps.
std::string stepLine(const StepReport& report);

/// @brief Names of files as JSON has them. A byte that is not part of valid UTF-8 becomes
/// U+FFFD, since JSON is UTF-8.
Json namesInJson(const std::vector<std::string>& files);

/// @brief The content of a line of the list of steps.
RunSummary summaryOf(const Json& step_line);

/// @brief The summary without times: the end of the list of steps.
Json toJson(const RunSummary& summary);

/// @brief One entry of "steps" in the JSON report.
Json toJson(const StepReport& report);

/// @brief The scene as one mesh at a time of the step, with B's vertices after A's.
/// Vertices of contacts up to this time have a colour: vertex-face red, edge-edge orange,
/// all crossings violet.
struct PaintedMesh {
  Mesh mesh;
  std::vector<Colour> colours;
};
PaintedMesh paint(const SceneTriangles& triangles, const SceneFrame& from,
                  const SceneFrame& to, double time, const StepResult& result);

}  // namespace fcl_ccd

#endif
