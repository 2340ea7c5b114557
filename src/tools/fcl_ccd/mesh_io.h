// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_MESH_IO_H
#define FCL_CCD_MESH_IO_H

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace fcl_ccd {

using Vertices = std::vector<std::array<double, 3>>;
using Triangles = std::vector<std::array<int, 3>>;

/// @brief A triangle mesh.
struct Mesh {
  Vertices vertices;
  Triangles triangles;
};

/// @brief The faces of a mesh as a file has them.
struct Faces {
  /// @brief Vertex ids of all faces, one face after the other.
  std::vector<int> corners;
  /// @brief For each face where its corners end; empty when all faces are triangles.
  std::vector<std::size_t> ends;

  /// @brief Whether the face ends where the corners end now, with at least three of them.
  bool endFace();
  std::size_t size() const { return ends.empty() ? corners.size() / 3 : ends.size(); }
  bool operator==(const Faces& other) const {
    return corners == other.corners && ends == other.ends;
  }
  bool operator!=(const Faces& other) const { return !(*this == other); }

 private:
  std::size_t last_end_{0};
};

/// @brief A mesh as a file has it.
struct PolygonMesh {
  Vertices vertices;
  Faces faces;
};

using Colour = std::array<std::uint8_t, 3>;

/// @brief What follows the last point of a file's name, in lower case.
std::string extensionOf(const std::string& path);

/// @brief Whether readPolygonMesh() reads files with this extension.
bool isMeshFormat(const std::string& extension);

/// @brief Reads a mesh; the extension names the format: .obj, .ply (ascii, binary of
/// either byte order, coordinates float or double), .off (text) or .stl (ascii, binary).
/// (1) Vertices keep their order and their full double precision. Those of STL are the
/// corners of its facets, three each, in their order.
/// (2) A mesh that is returned has a face, each face three vertices or more, finite
/// coordinates and no vertex id out of range.
/// @throws std::runtime_error that names the file and what is wrong with it.
PolygonMesh readPolygonMesh(const std::string& path);

/// @brief readPolygonMesh(), its faces divided by triangulate().
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
