// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_QUERY_CROSSING_H
#define FCL_CCD_QUERY_CROSSING_H

#include <cstdint>
#include <vector>

namespace fcl {
namespace detail {
namespace deformable {

/// @brief An edge of one mesh that passes through a face of the other at t = 0.
struct Crossing {
  /// True: the edge belongs to mesh a and the face to mesh b. False: the other way round.
  bool first_on_a;
  std::uint32_t edge[2];
  std::uint32_t face[3];
  /// A triangle of mesh a that holds its feature, and one of mesh b.
  std::int32_t triangles[2];
};

/// @brief Sorts crossings by side and vertex ids. Of several crossings of the same edge
/// and face it keeps the one with the lowest triangles. Two faces with the same three
/// vertices are one face.
void sortCrossings(std::vector<Crossing>& crossings);

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
