// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_QUERY_TRIANGLE_READER_H
#define FCL_CCD_QUERY_TRIANGLE_READER_H

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "base/prefetch.h"
#include "tree/mesh_instance.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief The triangles and vertices of a moving tree, read without a copy.
struct TrianglesInPlace {
  const TreeTriangle* triangles;
  const TreeVertex* vertices;

  /// @param[out] x  the vertices, which are prefetched
  const TreeTriangle* read(int i, const TreeVertex** x) const {
    const TreeTriangle& triangle = triangles[i];
    for (int k = 0; k < 3; ++k) {
      x[k] = vertices + triangle.place[k];
      for (int line = 0; line < 3; ++line)
        prefetchMemory(reinterpret_cast<const char*>(x[k]) + 64 * line);
    }
    return &triangle;
  }
  void prefetch(int i) const { prefetchMemory(triangles + i); }
};

/// @brief Reads the triangles of a mesh. A moving tree in place is read without a copy.
/// For other meshes the reader computes vertices and their boxes into a store of its own,
/// where it finds most of them again: pairs of triangles that are near in a block have
/// triangles in common.
class TriangleReader {
 public:
  /// @brief A result is valid until this number of later reads.
  static constexpr std::size_t kStored = 256;

  /// @param mesh  kept by reference
  explicit TriangleReader(const MeshInstance& mesh);

  /// @param i  number of the triangle in the tree of the mesh
  /// @param[out] x  its vertices
  /// @throws NonFiniteVertex
  const TreeTriangle* read(int i, const TreeVertex** x) {
    if (in_place_.triangles) return in_place_.read(i, x);
    if (i != index_) find(i);
    for (std::size_t k = 0; k < 3; ++k) x[k] = &vertices_[3 * slot_ + k];
    return &triangles_[slot_];
  }

  void prefetch(int i) const {
    if (in_place_.triangles) in_place_.prefetch(i);
  }

  /// @brief The triangles that read() reads without a copy; null pointers if it has to
  /// copy.
  const TrianglesInPlace& inPlace() const { return in_place_; }

 private:
  /// Slots of the store, which are taken in a circle. A triangle is used again as long
  /// as its slot will not be taken by the next kStored reads.
  static constexpr std::size_t kSlots = 2 * kStored;

  void find(int i);
  void compute(int i, std::size_t slot);
  bool isStored(std::uint32_t id, std::size_t slot) const;
  void pose(std::uint32_t id, TreeVertex& out) const;

  const MeshInstance& mesh_;
  TrianglesInPlace in_place_{nullptr, nullptr};
  /// The triangle that was read last, and its slot.
  int index_{-1};
  std::size_t slot_{0};
  /// The slot that is taken next.
  std::size_t next_{0};
  /// The triangle in each slot; -1: none. And the slot of a triangle, and of a vertex,
  /// by the last bits of its number, if it is in the store.
  std::vector<int> stored_;
  std::vector<std::uint16_t> slot_of_, slot_of_vertex_;
  std::unique_ptr<TreeTriangle[]> triangles_;
  std::unique_ptr<TreeVertex[]> vertices_;
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
