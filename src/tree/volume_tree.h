// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_TREE_VOLUME_TREE_H
#define FCL_CCD_TREE_VOLUME_TREE_H

#include <cassert>
#include <cstddef>
#include <cstring>

#include "tree/oriented_box.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief Bounds along the directions of a 16-DOP.
struct Slabs {
  double lo[8];
  double hi[8];
};

/// @brief A binary tree of bounding volumes that the caller has: an array of nodes, and
/// functions that read them. A node begins with its link. Does not own the nodes.
struct VolumeTree {
  /// @brief How to read volumes of one kind. The functions take the addresses of some
  /// nodes, since one call for eight of them costs less than eight.
  struct Reader {
    /// The bytes from a node to the next one.
    std::size_t stride;
    /// How far points can stand out of a volume, relative to their coordinates.
    double slack;
    /// Null: the volumes store no bounds along our directions.
    void (*slabs)(const void* const* nodes, int count, Slabs* out);
    void (*boxes)(const void* const* nodes, int count, OrientedBox* out);
  };

  const void* nodes{nullptr};
  Reader reader{};

  const void* at(int node) const {
    assert(nodes && node >= 0);
    return static_cast<const char*>(nodes) +
           static_cast<std::size_t>(node) * reader.stride;
  }

  /// @brief The left child of a node (the right child follows it), or ~triangle of a
  /// leaf.
  int link(int node) const {
    int link;
    std::memcpy(&link, at(node), sizeof(link));
    return link;
  }
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
