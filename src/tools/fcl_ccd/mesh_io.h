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

/// @brief The faces of a mesh as they are in a file.
struct Faces {
  /// @brief Vertex ids of all faces, one face after the other.
  std::vector<int> corners;
  /// @brief For each face the end of its corners; empty if all faces are triangles.
  std::vector<std::size_t> ends;

  /// @brief Ends a face at the current end of the corners. Returns whether it has at
  /// least three corners.
  bool endFace();
  std::size_t size() const { return ends.empty() ? corners.size() / 3 : ends.size(); }
  bool operator==(const Faces& other) const {
    return corners == other.corners && ends == other.ends;
  }
  bool operator!=(const Faces& other) const { return !(*this == other); }

 private:
  std::size_t last_end_{0};
};

/// @brief A mesh as it is in a file.
struct PolygonMesh {
  Vertices vertices;
  Faces faces;
};

using Colour = std::array<std::uint8_t, 3>;

/// @brief The part of a file's name after the last point, in lower case.
std::string extensionOf(const std::string& path);

/// @brief Whether readPolygonMesh() reads files with this extension.
bool isMeshFormat(const std::string& extension);

/// @brief Reads a mesh; the extension names the format: .obj, .ply (ascii, binary of
/// either byte order, coordinates float or double), .off (text) or .stl (ascii, binary).
/// (1) Vertices keep their order and their full double precision. The vertices of an STL
/// are the corners of its facets, three for each, in their order.
/// (2) A returned mesh has at least one face, each face has at least three vertices,
/// coordinates are finite and vertex ids in range.
/// @throws std::runtime_error that names the file and the error.
PolygonMesh readPolygonMesh(const std::string& path);

/// @brief The bytes of a binary little-endian PLY of the mesh, with coordinates in double
/// and one colour per vertex.
/// @throws std::invalid_argument if the number of colours is not the number of vertices.
std::string encodePaintedPly(const Mesh& mesh, const std::vector<Colour>& colours);

}  // namespace fcl_ccd

#endif
