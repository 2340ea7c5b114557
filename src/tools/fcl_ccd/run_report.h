// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_RUN_REPORT_H
#define FCL_CCD_RUN_REPORT_H

#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "mesh_io.h"
#include "scene.h"

namespace fcl_ccd {

/// @brief What is reported about the pair of frames `index`, `index` + 1.
struct StepReport {
  std::size_t index{0};
  std::size_t vertices{0};   ///< of all meshes
  std::size_t triangles{0};  ///< of all meshes
  StepResult result;
};

/// @brief Head and rows of the table for the terminal, each with its line end.
std::string tableHead();
std::string tableRow(const StepReport& report);

/// @brief Head and lines of the contact list, each with its line end.
std::string contactsHead();
std::string contactLines(const StepReport& report);

/// @brief One entry of "steps".
nlohmann::ordered_json toJson(const StepReport& report);

/// @brief A frame of the scene as one mesh, B's vertices after A's, with the vertices of
/// the contacts in colour: vertex-face red, edge-edge orange, initial crossing violet.
struct PaintedMesh {
  Mesh mesh;
  std::vector<Colour> colours;
};
PaintedMesh paint(const SceneFrame& frame, const StepResult& result);

}  // namespace fcl_ccd

#endif
