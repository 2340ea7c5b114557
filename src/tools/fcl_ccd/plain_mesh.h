// SPDX-License-Identifier: BSD-3-Clause
//
// CGAL's readers trust the text they are given: they allocate what a header promises,
// read a missing coordinate as 0, drop what follows a number they cannot read, and let
// ids out of range through. So a file is first checked and brought to the plainest form
// of its own format, from which nothing is left to misread.
#ifndef FCL_CCD_PLAIN_MESH_H
#define FCL_CCD_PLAIN_MESH_H

#include <string>
#include <string_view>

namespace fcl_ccd {

// Each of these takes the contents of a file and throws std::runtime_error with the place
// and the cause (but not the file's name) when it is not a mesh of that format.

/// @brief The `v` and `f` statements alone, three coordinates and bare vertex ids; tabs
/// become spaces, continued lines are joined.
std::string plainObj(std::string_view file);

/// @brief Header `OFF`, three coordinates a vertex, vertex ids of each face; no comments,
/// normals or colours.
std::string plainOff(std::string_view file);

/// @brief The same body under a header whose properties, but for the coordinates and the
/// vertex ids, have lost their names. The body has exactly the length that the header
/// promises.
std::string plainPly(std::string_view file);

}  // namespace fcl_ccd

#endif
