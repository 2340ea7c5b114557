// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_RUN_REPORT_H
#define FCL_CCD_RUN_REPORT_H

#include <cstddef>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "mesh_io.h"
#include "scene.h"

namespace fcl_ccd {

/// @brief What is reported about the step `index`.
struct StepReport {
  std::size_t index{0};
  std::size_t vertices{0};         ///< of all meshes
  std::size_t triangles{0};        ///< of all meshes
  std::vector<std::string> files;  ///< of the two frames of A, then of those of B
  StepResult result;
};

/// @brief Columns of the contact list that are there when they are asked for.
struct ContactColumns {
  bool triangles{false};
  bool position{false};
  bool normal{false};
};

/// @brief What is told at the end, added up from steps.
struct RunSummary {
  std::size_t steps{0};
  std::size_t vf{0};
  std::size_t ee{0};
  std::size_t crossing_steps{0};  ///< steps that began crossing
  struct First {
    std::size_t step;
    double toc_lo;
  };
  std::optional<First> first;  ///< of the first step with a contact or crossing
  std::size_t slowest_step{0};
  double slowest_ms{-1};  ///< of steps with a time; negative without one

  /// @brief Adds a step that comes after all others.
  void add(const RunSummary& step);
};
RunSummary summaryOf(const StepReport& report);

/// @brief Head and rows of the table for the terminal, each with its line end.
std::string tableHead();
std::string tableRow(const StepReport& report);

/// @brief The summary as lines for the terminal.
std::string summaryLines(const RunSummary& summary);

/// @brief Head and lines of the contact list, each with its line end.
std::string contactsHead(const ContactColumns& columns);
std::string contactLines(const StepReport& report, const ContactColumns& columns);

/// @brief A line of the list of steps: what does not depend on the machine, the number of
/// threads, or the steps before.
std::string stepLine(const StepReport& report);

/// @brief What a line of the list of steps says.
RunSummary summaryOf(const nlohmann::ordered_json& step_line);

/// @brief The summary without times: what the list of steps ends with.
nlohmann::ordered_json toJson(const RunSummary& summary);

/// @brief One entry of "steps".
nlohmann::ordered_json toJson(const StepReport& report);

/// @brief A frame of the scene as one mesh, B's vertices after A's, with the vertices of
/// the contacts in colour: vertex-face red, edge-edge orange, initial crossing violet.
struct PaintedMesh {
  Mesh mesh;
  std::vector<Colour> colours;
};
PaintedMesh paint(const SceneTriangles& triangles, const SceneFrame& frame,
                  const StepResult& result);

}  // namespace fcl_ccd

#endif
