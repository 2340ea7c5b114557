// SPDX-License-Identifier: BSD-3-Clause
//
// The borders of parts of a tree: what of them depends on the structure alone, and stays.
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

/// @brief The directed edges of a region's triangles that are left when opposite ones
/// cancel. No edges: none are left, or one more than once, and the region is not proved.
struct RegionBorder {
  /// Places of the vertices, path after path: between vertices that the border passes
  /// more than once, or closed.
  std::vector<std::uint32_t> points;
  /// Where each edge begins among the points; it ends at the next one.
  std::vector<std::uint32_t> begins;
  /// The first edge of each path.
  std::vector<std::uint32_t> paths;
  bool is_one_loop{false};

  std::size_t size() const { return begins.size(); }
  std::uint32_t from(std::size_t edge) const { return points[begins[edge]]; }
  std::uint32_t to(std::size_t edge) const { return points[begins[edge] + 1]; }
};

/// @brief The borders of a tree's nodes, each found when a query first asks for it: the
/// next one asks for most of them again.
///
/// For any number of threads at a time; two may find the same border, and one is kept.
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

  /// @param find  find() is the border of the node
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
