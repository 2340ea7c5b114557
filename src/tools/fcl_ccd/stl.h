// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_STL_H
#define FCL_CCD_STL_H

#include <string_view>

#include "mesh_io.h"

namespace fcl_ccd {

/// @brief Reads an STL file, binary or ascii. Each facet has three vertices of its own;
/// its normal is ignored. A file is binary if its length is the one that its number of
/// facets promises. Any other file is read as ascii (some binary files begin with
/// "solid").
/// @throws std::runtime_error with the place and the cause (but not the file's name).
PolygonMesh parseStl(std::string_view file);

}  // namespace fcl_ccd

#endif
