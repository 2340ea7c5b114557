// SPDX-License-Identifier: BSD-3-Clause
//
// The readers of the text formats, and of every PLY that parseBinaryPly() leaves. Each
// reads a file once, from the front to the back, in time and memory in proportion to its
// length: a number in a header is never a reason to allocate.
#ifndef FCL_CCD_MESH_READERS_H
#define FCL_CCD_MESH_READERS_H

#include <string_view>

#include "mesh_io.h"

namespace fcl_ccd {

// Each of these functions takes the contents of a file. If it is not a mesh of that
// format, the function throws std::runtime_error with the place and the cause (but not
// the file's name). Ids of the mesh are in range, its coordinates finite.

/// @brief `v`, `f`, `l` and `p`; what else describes a look is skipped. Free-form curves
/// and surfaces are refused.
PolygonMesh parseObj(std::string_view file);

/// @brief Text OFF with any of the prefixes ST, C and N. Normals, colours and texture
/// coordinates are skipped.
PolygonMesh parseOff(std::string_view file);

/// @brief PLY of all three formats, with faces, tristrips and edges.
PolygonMesh parsePly(std::string_view file);

/// @brief STL, ascii or binary. Each facet has three vertices of its own; its normal, its
/// colour and the names of solids are skipped. Bytes behind the facets of a binary file
/// are skipped, too.
PolygonMesh parseStl(std::string_view file);

}  // namespace fcl_ccd

#endif
