// SPDX-License-Identifier: BSD-3-Clause
//
// Binary PLY is the format of long sequences. What they have in common is read here, in
// blocks; parsePly() reads any PLY, one value after the other.
#ifndef FCL_CCD_BINARY_PLY_H
#define FCL_CCD_BINARY_PLY_H

#include <cstddef>
#include <optional>
#include <string_view>

#include "mesh_io.h"
#include "ply_header.h"

namespace fcl_ccd {

/// @brief The position of the vertices in a binary PLY. All offsets are in bytes.
struct PlyVertexBlock {
  std::size_t begin{0};  ///< offset in the file
  std::size_t count{0};
  std::size_t stride{0};
  std::size_t offsets[3]{};  ///< offsets of x, y, z in a vertex
  PlyType types[3]{};
  bool big_endian{false};
  std::size_t end() const { return begin + count * stride; }
};

/// @brief The vertex block of a file that begins with it: a binary PLY whose vertex
/// element is the first one and has no lists. Nothing for any other file.
std::optional<PlyVertexBlock> findVertexBlock(std::string_view file);

/// @brief A value of any type, without rounding.
double loadPlyValue(const char* at, PlyType type, bool big_endian);

/// @brief The vertices of the block, without rounding.
Vertices decodeVertices(std::string_view file, const PlyVertexBlock& block);

/// @brief Throws std::runtime_error that names the first vertex that is not finite, if
/// there is one.
void requireFinite(const Vertices& vertices);

/// @brief Reads a binary PLY that is complete, whose vertices have no lists and whose
/// faces have ids of 32 bits, and no strips and edges.
/// @return false for any other file; the content of `mesh` is then undefined
bool parseBinaryPly(std::string_view file, PolygonMesh& mesh);

}  // namespace fcl_ccd

#endif
