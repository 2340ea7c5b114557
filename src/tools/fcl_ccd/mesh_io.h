// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_MESH_IO_H
#define FCL_CCD_MESH_IO_H

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace fcl_ccd {

using Vertices = std::vector<std::array<double, 3>>;
using Triangles = std::vector<std::array<int, 3>>;

/// @brief Vertex ids of edges that belong to no face: pieces of cables.
using FreeEdges = std::vector<std::array<int, 2>>;

/// @brief What a mesh has beside its faces: cables, rods and points.
struct FreeElements {
  FreeEdges edges;
  std::vector<int> points;  ///< vertices that are points of their own

  bool empty() const { return edges.empty() && points.empty(); }
  bool operator==(const FreeElements& other) const {
    return edges == other.edges && points == other.points;
  }
  bool operator!=(const FreeElements& other) const { return !(*this == other); }
};

/// @brief A triangle mesh, perhaps with free edges.
struct Mesh {
  Vertices vertices;
  Triangles triangles;
  FreeEdges edges{};
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
  FreeElements free;
};

using Colour = std::array<std::uint8_t, 3>;

/// @brief The part of a file's name after the last point, in lower case.
std::string extensionOf(const std::string& path);

/// @brief Whether readPolygonMesh() reads files with this extension.
bool isMeshFormat(const std::string& extension);

/// @brief Reads a mesh; the extension names the format: .obj, .ply (ascii, binary of
/// either byte order), .off (text) or .stl (ascii, binary). Lines of text end with LF,
/// CR LF or CR.
/// (1) Vertices keep their order. Their coordinates are the nearest doubles to the
/// numbers of the file, or the nearest floats where a PLY says so. The vertices of an STL
/// are the corners of its facets, three for each, in their order.
/// (2) A returned mesh has at least one face, free edge or free point (`l` and `p` of
/// OBJ, the element `edge` of PLY). Each face has at least three vertices, coordinates
/// are finite and vertex ids in range.
/// (3) Time and memory are in proportion to the length of the file.
/// @throws std::runtime_error that names the file and the error.
PolygonMesh readPolygonMesh(const std::string& path);

/// @brief The same for a file whose contents were read before.
PolygonMesh parsePolygonMesh(const std::string& path, std::string_view bytes);

/// @brief The bytes of a binary little-endian PLY of the mesh, with coordinates in double
/// and one colour per vertex. Free edges are its element `edge`.
/// @throws std::invalid_argument if the number of colours is not the number of vertices.
std::string encodePaintedPly(const Mesh& mesh, const std::vector<Colour>& colours);

}  // namespace fcl_ccd

#endif
