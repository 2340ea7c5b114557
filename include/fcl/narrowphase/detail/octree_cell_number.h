// SPDX-License-Identifier: BSD-3-Clause
//
// The number that stands for a cell of an octree in contacts.
#ifndef FCL_NARROWPHASE_DETAIL_OCTREE_CELL_NUMBER_H
#define FCL_NARROWPHASE_DETAIL_OCTREE_CELL_NUMBER_H

#include <cstdint>

namespace fcl {
namespace detail {

/// @brief A cell by octomap's key and its depth; the root has the depth 0. As a number:
/// the key along x, y and z in 16 bits each, from the lowest bit on, then the depth.
struct OctreeCellNumber {
  static constexpr unsigned kDepth = 16;

  std::uint16_t key[3];
  unsigned depth;

  std::int64_t toNumber() const {
    std::int64_t number = depth;
    for (int k = 2; k >= 0; --k) number = number << 16 | key[k];
    return number;
  }
  static OctreeCellNumber of(std::int64_t number) {
    OctreeCellNumber out;
    for (int k = 0; k < 3; ++k)
      out.key[k] = static_cast<std::uint16_t>(number >> (16 * k) & 0xffff);
    out.depth = static_cast<unsigned>(number >> 48);
    return out;
  }
  static bool isNumber(std::int64_t number) {
    return number >= 0 && number >> 48 <= std::int64_t{kDepth};
  }

  /// @brief The place of the cell along an axis among the cells of its depth, less half
  /// of their number: the cell is from index(k) to index(k) + 1 times its size.
  double index(int k) const {
    return static_cast<double>(key[k] >> (kDepth - depth)) - 0.5 * (1U << depth);
  }
  /// @brief The size of the cell.
  /// @param root_size  the side of the root
  double size(double root_size) const { return root_size / (1U << depth); }
};

}  // namespace detail
}  // namespace fcl

#endif
