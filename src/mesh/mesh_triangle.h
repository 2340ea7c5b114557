// SPDX-License-Identifier: BSD-3-Clause
//
// A triangle as vertex ids and owned features; see mesh_topology.h for what owning is.
#ifndef FCL_CCD_MESH_MESH_TRIANGLE_H
#define FCL_CCD_MESH_MESH_TRIANGLE_H

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>

#include "base/short_vector.h"

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
using ThreeIds = Word4;

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

/// @brief Triangles as the caller has them: three vertex ids of type std::size_t each,
/// one triangle after the other. FCL's Triangle is such a type; its operator[] is a call
/// into FCL's library for each id. Does not own the array.
class TriangleArray {
 public:
  TriangleArray() = default;
  template <typename T>
  TriangleArray(const T* triangles)  // not explicit: an array of triangles is one
      : bytes_(reinterpret_cast<const unsigned char*>(triangles)) {
    static_assert(std::is_trivially_copyable<T>::value && sizeof(T) == kSize,
                  "a triangle is its three ids");
  }

  explicit operator bool() const { return bytes_ != nullptr; }
  const void* address(std::size_t i) const { return bytes_ + i * kSize; }

  void copyIds(std::size_t i, std::size_t (&out)[3]) const {
    std::memcpy(out, address(i), kSize);
  }
  /// @pre the ids are below 2^32
  void copyIds(std::size_t i, std::uint32_t (&out)[3]) const {
    std::size_t ids[3];
    copyIds(i, ids);
    for (int k = 0; k < 3; ++k) out[k] = static_cast<std::uint32_t>(ids[k]);
  }
  std::size_t id(std::size_t i, int k) const {
    std::size_t ids[3];
    copyIds(i, ids);
    return ids[k];
  }

 private:
  static constexpr std::size_t kSize = 3 * sizeof(std::size_t);

  const unsigned char* bytes_{nullptr};
};

/// @brief The largest number of triangles, and of vertices, of a mesh. With it 32 bits
/// are enough for four numbers a triangle, and for the number of the spokes of all fans
/// (six a triangle in a mesh without common vertices). A signed number is enough for a
/// node or ~leaf.
constexpr std::size_t kMaxMeshSize = std::size_t{1} << 29;

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
