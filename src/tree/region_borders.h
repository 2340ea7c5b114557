// SPDX-License-Identifier: BSD-3-Clause
//
// The borders of regions of a tree, and its closed parts. They depend on the structure
// alone, and are kept with it.
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
  std::uint32_t from(std::size_t edge) const {
    assert(edge < begins.size() && begins[edge] < points.size());
    return points[begins[edge]];
  }
  std::uint32_t to(std::size_t edge) const {
    assert(edge < begins.size() && begins[edge] + 1 < points.size());
    return points[begins[edge] + 1];
  }
};

/// @brief A node whose triangles are a closed surface, and the end of its triangles.
struct ClosedNode {
  std::int32_t node;
  std::uint32_t last;
};

/// @brief The borders of a tree's nodes, and its closed nodes. Each border is found when
/// a query first asks for it, and kept, since the next query asks for most of them again.
///
/// Any number of threads may use it at the same time. If two find the same, one of the
/// results is kept.
class RegionBorders {
 public:
  explicit RegionBorders(std::size_t num_nodes) : borders_(num_nodes) {
    for (auto& border : borders_) border.store(nullptr, std::memory_order_relaxed);
  }
  ~RegionBorders() {
    for (auto& border : borders_) delete border.load(std::memory_order_relaxed);
    delete closed_.load(std::memory_order_relaxed);
  }
  RegionBorders(const RegionBorders&) = delete;
  RegionBorders& operator=(const RegionBorders&) = delete;

  /// @param find  find() returns the border of the node
  template <typename Find>
  const RegionBorder& of(std::int32_t node, Find&& find) {
    assert(node >= 0 && static_cast<std::size_t>(node) < borders_.size());
    return kept(borders_[static_cast<std::size_t>(node)], find);
  }

  /// @pre of() has been called for this node
  const RegionBorder& known(std::int32_t node) const {
    assert(node >= 0 && static_cast<std::size_t>(node) < borders_.size());
    const RegionBorder* border =
        borders_[static_cast<std::size_t>(node)].load(std::memory_order_acquire);
    assert(border);
    return *border;
  }

  /// @param find  find() returns the closed nodes of the tree
  template <typename Find>
  const std::vector<ClosedNode>& closedNodes(Find&& find) {
    return kept(closed_, find);
  }

  std::size_t memUsage() const;

 private:
  template <typename T, typename Find>
  static const T& kept(std::atomic<const T*>& at, const Find& find) {
    const T* known = at.load(std::memory_order_acquire);
    if (known) return *known;
    auto found = std::make_unique<const T>(find());
    if (!at.compare_exchange_strong(known, found.get(), std::memory_order_acq_rel))
      return *known;
    return *found.release();
  }

  std::vector<std::atomic<const RegionBorder*>> borders_;
  std::atomic<const std::vector<ClosedNode>*> closed_{nullptr};
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
