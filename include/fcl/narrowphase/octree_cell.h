// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_NARROWPHASE_OCTREE_CELL_H
#define FCL_NARROWPHASE_OCTREE_CELL_H

#include "fcl/config.h"

#if FCL_HAVE_OCTOMAP

#include <algorithm>
#include <cstdint>

#include "fcl/common/exception.h"
#include "fcl/export.h"
#include "fcl/geometry/octree/octree.h"

namespace fcl {

namespace detail {

/// @brief A cell of an octree as numbers.
struct OctreeCellNumbers {
  double center[3];
  double size;
  std::uint16_t key[3];
  unsigned depth;
};

/// @brief The cell that a contact names.
/// @param root_size  the side of the octree's root
/// @return false: it is the number of no cell
FCL_EXPORT bool readOctreeCell(std::intptr_t number, double root_size,
                               OctreeCellNumbers& cell);

}  // namespace detail

/// @brief A cell of an octree. A pruned node is one large cell.
template <typename S>
struct OctreeCell {
  /// @brief The center of the cube, in the frame of the octree.
  Vector3<S> center;
  /// @brief The side of the cube.
  S size;
  /// @brief octomap's name of the cell: octomap::OcTree::search(key, depth) finds its
  /// node.
  octomap::OcTreeKey key;
  unsigned int depth;
};

/// @brief The cell of an octree that is part of a continuous contact.
/// @param b  ContinuousContact::b1 if the octree is o1, b2 if it is o2. It is not FCL's
/// "query cell id", which depends on addresses: it stays valid when the map changes, and
/// means the same in each run.
/// @throws fcl::Exception  b is not the number of a cell
template <typename S>
OctreeCell<S> octreeCell(const OcTree<S>& octree, std::intptr_t b) {
  detail::OctreeCellNumbers numbers;
  if (!detail::readOctreeCell(b, 2 * static_cast<double>(octree.getRootBV().max_[0]),
                              numbers))
    throw Exception(
        "octreeCell: b is not the number of a cell. Give b1 or b2 of a "
        "ContinuousContact, that of the octree");
  OctreeCell<S> cell;
  for (int k = 0; k < 3; ++k) cell.center[k] = static_cast<S>(numbers.center[k]);
  cell.size = static_cast<S>(numbers.size);
  std::copy(numbers.key, numbers.key + 3, cell.key.k);
  cell.depth = numbers.depth;
  return cell;
}

}  // namespace fcl

#endif

#endif
