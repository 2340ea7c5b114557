// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_MESH_IO_H
#define FCL_CCD_MESH_IO_H

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace fcl_ccd {

/// @brief A triangle mesh as a file holds it.
struct Mesh {
  std::vector<std::array<double, 3>> vertices;
  std::vector<std::array<int, 3>> triangles;
};

using Colour = std::array<std::uint8_t, 3>;

/// @brief Reads a mesh; the extension names the format: .obj, .ply (ascii, binary of
/// either byte order, coordinates float or double) or .off (text).
/// (1) Vertices keep their order and their full double precision.
/// (2) A polygon p0 p1 p2 p3 ... becomes the fan (p0 p1 p2), (p0 p2 p3), ...
/// (3) A mesh that is returned has a triangle, finite coordinates and no vertex id out of
/// range.
/// @throws std::runtime_error that names the file and what is wrong with it.
Mesh readMesh(const std::string& path);

/// @brief The bytes of a binary little-endian PLY of the mesh, coordinates in double, one
/// colour a vertex.
/// @throws std::invalid_argument unless there are as many colours as vertices.
std::string encodePaintedPly(const Mesh& mesh, const std::vector<Colour>& colours);

/// @brief Writes encodePaintedPly() to a file, which is left whole or as it was.
/// @throws std::runtime_error that names the file and the cause.
void writePaintedPly(const std::string& path, const Mesh& mesh,
                     const std::vector<Colour>& colours);

}  // namespace fcl_ccd

#endif
