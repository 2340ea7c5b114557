// SPDX-License-Identifier: BSD-3-Clause
//
// Vertices of a triangle soup that coincide in all frames.
#ifndef FCL_GEOMETRY_BVH_WELD_VERTICES_H
#define FCL_GEOMETRY_BVH_WELD_VERTICES_H

#include <cstddef>
#include <vector>

#include "fcl/export.h"

namespace fcl {

/// @brief Finds the vertices that coincide in all frames of a mesh.
///
/// In a triangle soup (STL files, exports with split vertices) no two triangles have a
/// common vertex. Each triangle then touches its neighbours in every step, and a
/// self-collision reports these contacts; it says so by
/// ContinuousContacts::is_triangle_soup. Replace each vertex id of the triangles by its
/// entry in the map, and build the model with these triangles and all vertices. Contacts
/// have the ids of the file then. A triangle whose corners are joined stays, with a
/// repeated id.
///
/// Properties:
/// (1) map[i] <= i and map[map[i]] == map[i].
/// (2) Vertex i and vertex map[i] coincide in every frame: no coordinate differs by more
/// than eps.
/// (3) With eps = 0 all vertices that coincide in every frame have the same entry, the
/// lowest of their ids. With eps > 0 vertices may form a chain in which each coincides
/// with the next one, but not with all. Some of the chain are joined then, so that (2)
/// holds.
///
/// The cost is O(n) for n coordinates of all frames; the memory O(num_vertices). With
/// eps > 0 the frames are read again if vertices of a chain part in a later frame.
///
/// Thread-safety: concurrent calls are safe.
///
/// @param frames  one array for each frame, of num_vertices x 3 coordinates (x y z x y z
/// ...). A list of one frame is enough for a mesh that only moves rigidly.
/// @param eps  the distance, in the unit of the coordinates
/// @return for each vertex the id that it is replaced by, or its own
/// @throws fcl::Exception  there is no frame, a frame is null, a coordinate is not
/// finite, there are more than 2^29 vertices, or eps is negative or not finite
/// @tparam S  double or float
template <typename S>
FCL_EXPORT std::vector<int> weldVertices(const std::vector<const S*>& frames,
                                         std::size_t num_vertices, S eps = S{0});

extern template std::vector<int> weldVertices(const std::vector<const double*>&,
                                              std::size_t, double);
extern template std::vector<int> weldVertices(const std::vector<const float*>&,
                                              std::size_t, float);

}  // namespace fcl

#endif
