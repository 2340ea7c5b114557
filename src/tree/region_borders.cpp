// SPDX-License-Identifier: BSD-3-Clause
#include "tree/region_borders.h"

namespace fcl {
namespace detail {
namespace deformable {

std::size_t RegionBorders::memUsage() const {
  std::size_t bytes = borders_.capacity() * sizeof(borders_[0]);
  for (const auto& kept : borders_)
    if (const RegionBorder* border = kept.load(std::memory_order_acquire))
      bytes += sizeof(*border) + (border->points.capacity() + border->begins.capacity() +
                                  border->paths.capacity()) *
                                     sizeof(std::uint32_t);
  if (const auto* closed = closed_.load(std::memory_order_acquire))
    bytes += sizeof(std::vector<ClosedNode>) + closed->capacity() * sizeof(ClosedNode);
  return bytes;
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
