// SPDX-License-Identifier: BSD-3-Clause
//
// Representative triangles (Curtis, Tamstorf, Manocha 2008): every vertex, edge and face
// is owned by exactly one triangle, so that each VF and EE pair of a scene is met once.
#ifndef FCL_NARROWPHASE_DETAIL_DEFORMABLE_MESH_TOPOLOGY_H
#define FCL_NARROWPHASE_DETAIL_DEFORMABLE_MESH_TOPOLOGY_H

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <type_traits>
#include <vector>

#include "fcl/math/triangle.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief Vertex ids of a triangle and the features that it owns. Edge k joins vertices k
/// and (k + 1) % 3.
struct MeshTriangle {
  std::uint32_t v[3];
  std::uint32_t owned;

  bool ownsVertex(unsigned k) const { return (owned >> k) & 1U; }
  bool ownsEdge(unsigned k) const { return (owned >> (3 + k)) & 1U; }
  bool ownsFace() const { return (owned >> 6) & 1U; }
};

/// @brief Three vertices; the fourth number does not count.
typedef std::uint32_t ThreeIds __attribute__((vector_size(16)));

/// All six border features and the face.
constexpr std::uint32_t kOwnsAll = 0x7f;

/// @brief The vertex ids of a triangle, which are below 2^32; FCL's operator[] is a call
/// into its library for each.
inline void vertexIds(const Triangle& triangle, std::uint32_t (&out)[3]) {
  std::size_t ids[3];
  static_assert(
      std::is_trivially_copyable<Triangle>::value && sizeof(Triangle) == sizeof(ids),
      "a triangle is its three ids");
  std::memcpy(ids, &triangle, sizeof(ids));
  for (int k = 0; k < 3; ++k) out[k] = static_cast<std::uint32_t>(ids[k]);
}

/// @brief No mesh has more triangles, or vertices. Numbers of 32 bits then hold four for
/// each triangle, and the spokes of all fans, of which there are six a triangle where no
/// two share a vertex; numbers with a sign hold nodes and ~leaf.
constexpr std::size_t kMaxMeshSize = std::size_t{1} << 29;

/// @brief What of a mesh is more than kMaxMeshSize, for example "536870913 triangles are
/// more than 536870912"; empty if nothing is.
std::string findTooMany(std::size_t num_triangles, std::size_t num_vertices);

/// @brief The first corner, 3 * triangle + k, whose vertex id is not below num_vertices;
/// 3 * num_triangles if there is none.
std::size_t findOutOfRange(const Triangle* triangles, std::size_t num_triangles,
                           std::size_t num_vertices);

/// @brief The lowest-numbered triangle that has a feature owns it. A vertex without a
/// triangle is not a feature; of several faces with the same vertex set only the first
/// owns its face; an edge whose two ids are equal is owned by nobody.
/// @param triangles indices below num_vertices (not checked here).
std::vector<MeshTriangle> assignFeatures(const Triangle* triangles,
                                         std::size_t num_triangles,
                                         std::size_t num_vertices);

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
