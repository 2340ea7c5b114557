// SPDX-License-Identifier: BSD-3-Clause
//
// The borders of regions of a tree. They depend on the structure alone, and are kept with
// it.
#ifndef FCL_CCD_TREE_REGION_BORDERS_H
#define FCL_CCD_TREE_REGION_BORDERS_H

#include <atomic>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace fcl {
namespace detail {
namespace deformable {

/// @brief The directed edges of a region's triangles that are left after opposite edges
/// cancel. There are no edges in two cases: none are left, or one is left more than once.
/// Then the region is not proved to be embedded.
struct RegionBorder {
  /// Places of the vertices of all paths, one path after the other. A path leads from one
  /// vertex that the border passes more than once to another one, or it is closed.
  std::vector<std::uint32_t> points;
  /// The index of each edge's first point. The edge ends at the next point.
  std::vector<std::uint32_t> begins;
  /// The first edge of each path.
  std::vector<std::uint32_t> paths;
  bool is_one_loop{false};

  std::size_t size() const { return begins.size(); }
  std::uint32_t from(std::size_t edge) const { return points[begins[edge]]; }
  std::uint32_t to(std::size_t edge) const { return points[begins[edge] + 1]; }
};

/// @brief The borders of a tree's nodes. Each is found when a query first asks for it,
/// and kept, since the next query asks for most of them again.
///
/// Any number of threads may use it at the same time. If two find the same border, one of
/// the results is kept.
class RegionBorders {
 public:
  explicit RegionBorders(std::size_t num_nodes) : borders_(num_nodes) {
    for (auto& border : borders_) border.store(nullptr, std::memory_order_relaxed);
  }
  ~RegionBorders() {
    for (auto& border : borders_) delete border.load(std::memory_order_relaxed);
  }
  RegionBorders(const RegionBorders&) = delete;
  RegionBorders& operator=(const RegionBorders&) = delete;

  /// @param find  find() returns the border of the node
  template <typename Find>
  const RegionBorder& of(std::int32_t node, Find&& find) {
    assert(node >= 0 && static_cast<std::size_t>(node) < borders_.size());
    std::atomic<const RegionBorder*>& kept = borders_[static_cast<std::size_t>(node)];
    const RegionBorder* border = kept.load(std::memory_order_acquire);
    if (border) return *border;
    auto found = std::make_unique<const RegionBorder>(find());
    if (!kept.compare_exchange_strong(border, found.get(), std::memory_order_acq_rel))
      return *border;
    return *found.release();
  }

  std::size_t memUsage() const;

 private:
  std::vector<std::atomic<const RegionBorder*>> borders_;
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
