// SPDX-License-Identifier: BSD-3-Clause
//
// A triangle as vertex ids and owned features; see mesh_topology.h for what owning is.
#ifndef FCL_CCD_MESH_MESH_TRIANGLE_H
#define FCL_CCD_MESH_MESH_TRIANGLE_H

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>

#include "fcl/math/triangle.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief Vertex ids of a triangle and the features that it owns. A free edge is the
/// triangle v, w, w, and a free point the triangle v, v, v, both without a face.
struct MeshTriangle {
  std::uint32_t v[3];
  /// One bit for each feature that the triangle owns: bit k for vertex k; bit 3 + k for
  /// edge k, which joins vertices k and (k + 1) % 3; bit 6 for the face. kFreeLeaf.
  std::uint32_t owned;
};

/// @brief Three vertices; the fourth number does not count.
typedef std::uint32_t ThreeIds __attribute__((vector_size(16)));

/// All six border features and the face.
constexpr std::uint32_t kOwnsAll = 0x7f;

/// @brief Set for a free edge and a free point, whatever they own. A free edge owns edge
/// 0 or nothing, a free point vertex 0 or nothing: what triangles have belongs to them.
constexpr std::uint32_t kFreeLeaf = 0x80;
constexpr std::uint32_t kOwnsFirstEdge = 0x08;

/// @brief How many leaves of a tree are free edges and free points. They follow the
/// triangles, edges first.
struct FreeLeaves {
  std::size_t edges{0};
  std::size_t points{0};

  std::size_t count() const { return edges + points; }
};

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

/// @brief The largest number of triangles, and of vertices, of a mesh. With it 32 bits
/// are enough for four numbers a triangle, and for the number of the spokes of all fans
/// (six a triangle in a mesh without common vertices). A signed number is enough for a
/// node or ~leaf.
constexpr std::size_t kMaxMeshSize = std::size_t{1} << 29;

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
