// SPDX-License-Identifier: BSD-3-Clause
//
// CGAL's readers do not check their input: they allocate as much as a header promises,
// read a missing coordinate as 0, ignore the text after a number that they cannot read,
// and accept ids out of range. So each file is first checked and converted to the
// plainest form of its own format, which can be read in one way only.
#ifndef FCL_CCD_PLAIN_MESH_H
#define FCL_CCD_PLAIN_MESH_H

#include <string>
#include <string_view>

namespace fcl_ccd {

// Each of these functions takes the contents of a file. If it is not a mesh of that
// format, the function throws std::runtime_error with the place and the cause (but not
// the file's name).

/// @brief The `v` and `f` statements only, with three coordinates and bare vertex ids.
/// Tabs become spaces, continued lines are joined.
std::string plainObj(std::string_view file);

/// @brief Header `OFF`, three coordinates for each vertex, the vertex ids of each face;
/// no comments, normals or colours.
std::string plainOff(std::string_view file);

/// @brief The same body with a header in which only coordinates and vertex ids keep the
/// names of their properties. The body has exactly the length that the header promises.
std::string plainPly(std::string_view file);

}  // namespace fcl_ccd

#endif
