// SPDX-License-Identifier: BSD-3-Clause
//
// The border of a region, and the proof that the plane is covered once at most.
#ifndef FCL_CCD_REGION_BORDER_H
#define FCL_CCD_REGION_BORDER_H

#include <cstddef>
#include <cstdint>
#include <vector>

#include "fcl/narrowphase/detail/deformable/kernels.h"
#include "fcl/narrowphase/detail/deformable/moving_kdop_tree.h"
#include "fcl/narrowphase/detail/deformable/uninitialized_vector.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief Triangles [first, last) of a tree, and the vertices that they are the first to
/// have, [first_place, last_place).
struct Region {
  std::uint32_t first, last, first_place, last_place;
};

/// @brief Moving boxes of the edges of a border, as Traversal takes them: triangles
/// between two points.
struct BorderTree {
  UninitializedVector<TreeVertex> points;
  UninitializedVector<MovingKdopNode> nodes;

  const MovingKdopNode& node(int i) const { return nodes[static_cast<std::size_t>(i)]; }
};

/// @brief The border of one region after another.
class RegionBorder {
 public:
  RegionBorder(const MovingKdopTree& tree, const Kernels& kernels)
      : tree_(tree), kernels_(kernels) {}

  /// @brief Finds what lies inside.
  /// @param interior  for each vertex of the tree; those of the region get 1 if they have
  /// a closed fan of its triangles and no others, else 0
  void markInterior(const Region& region, std::uint8_t* interior) const;

  /// @brief Finds the border: the directed edges that are left when opposite ones cancel.
  /// @param interior  markInterior() is called
  /// @return false if an edge is left more than once
  bool find(const Region& region, std::uint8_t* interior);

  /// @brief Proves for one of the directions, which all triangles of the region face
  /// during the whole step, that seen along it the border never meets itself but where
  /// edges share a vertex, and that at t = 0 it winds once round what lies on the left of
  /// its edges.
  bool isEmbedded(std::uint32_t directions);

 private:
  struct Edge {
    std::uint32_t from, to;
  };
  struct Point {
    double x, y;
  };
  /// At t = 0 and at t = 1.
  struct MovingPoint {
    Point at[2];
  };
  struct PlanarEdge {
    const MovingPoint &from, &to;
  };

  friend Point operator-(const Point& a, const Point& b) {
    return {a.x - b.x, a.y - b.y};
  }
  friend Point operator+(const Point& a, const Point& b) {
    return {a.x + b.x, a.y + b.y};
  }
  static double cross(const Point& a, const Point& b) { return a.x * b.y - a.y * b.x; }
  static double dot(const Point& a, const Point& b) { return a.x * b.x + a.y * b.y; }

  bool cancelOpposites();
  bool linkPaths();
  int widest(std::uint32_t directions) const;
  void project(int direction);
  PlanarEdge planarEdge(std::size_t i) const {
    return {points_[begins_[i]], points_[begins_[i] + 1]};
  }
  void fitPoints();
  void fitTree();
  bool isSimple();
  bool meetOnlyAtVertices(std::size_t i, std::size_t j) const;
  bool areApart(const PlanarEdge& e, const PlanarEdge& f) const;
  bool areApart(const PlanarEdge& e, const PlanarEdge& f, const Point (&w)[2]) const;
  bool windsOnce() const;
  bool windsOnceLeftOf(std::size_t i) const;

  const MovingKdopTree& tree_;
  const Kernels& kernels_;
  /// Edges by their vertices, the lower place first, and whether it comes last.
  std::vector<std::uint64_t> keys_;
  /// Path after path: between vertices that the border passes more than once, or closed.
  std::vector<Edge> edges_;
  std::vector<std::size_t> paths_;
  /// Scratch of linkPaths().
  std::vector<Edge> unlinked_;
  std::vector<std::uint8_t> taken_;
  bool is_one_loop_{false};
  /// In the plane: where each edge begins, and that it ends at the next point.
  std::vector<MovingPoint> points_;
  std::vector<std::uint32_t> begins_;
  BorderTree boxes_;
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
