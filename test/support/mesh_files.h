// SPDX-License-Identifier: BSD-3-Clause
//
// Whole meshes in files, by the functions of the program.
#ifndef FCL_CCD_TEST_MESH_FILES_H
#define FCL_CCD_TEST_MESH_FILES_H

#include <string>
#include <utility>
#include <vector>

#include "mesh_io.h"
#include "output_file.h"
#include "triangulate.h"

namespace fcl {
namespace test {

/// @brief The mesh of a file, with faces divided by triangulate().
inline fcl_ccd::Mesh readMesh(const std::string& path) {
  fcl_ccd::PolygonMesh mesh = fcl_ccd::readPolygonMesh(path);
  fcl_ccd::Triangles triangles = fcl_ccd::triangulate(mesh.vertices, mesh.faces);
  return {std::move(mesh.vertices), std::move(triangles)};
}

/// @brief Writes encodePaintedPly() to a file. If it fails, the file stays as it was.
inline void writePaintedPly(const std::string& path, const fcl_ccd::Mesh& mesh,
                            const std::vector<fcl_ccd::Colour>& colours) {
  const std::string bytes = fcl_ccd::encodePaintedPly(mesh, colours);
  fcl_ccd::OutputFile file(path);
  file.write(bytes);
  file.finish();
  file.publish();
}

}  // namespace test
}  // namespace fcl

#endif
