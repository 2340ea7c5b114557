// SPDX-License-Identifier: BSD-3-Clause
//
// The proof that a region with a given border covers the plane at most once.
#ifndef FCL_CCD_SELF_CULLING_BORDER_PROOF_H
#define FCL_CCD_SELF_CULLING_BORDER_PROOF_H

#include <cassert>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/uninitialized_vector.h"
#include "kernels/kernels.h"
#include "tree/moving_kdop_tree.h"
#include "tree/region_borders.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief Moving boxes of the edges of a border, in the form that Traversal takes: an
/// edge is a triangle with two points.
struct BorderTree {
  UninitializedVector<TreeVertex> points;
  UninitializedVector<MovingKdopNode> nodes;

  const MovingKdopNode& node(int i) const {
    assert(i >= 0 && static_cast<std::size_t>(i) < nodes.size());
    return nodes[static_cast<std::size_t>(i)];
  }
};

/// @brief The vector of a bit of a set of directions (kAxes).
void directionOf(int bit, int (&d)[3]);

/// @brief Tests one border after another.
class BorderProof {
 public:
  BorderProof(const MovingKdopTree& tree, const Kernels& kernels)
      : tree_(tree), kernels_(kernels) {}

  /// @brief All triangles of the region face the given directions during the whole step.
  /// Proves two things for the projection along one of these directions. The border never
  /// meets itself, except where edges share a vertex. At t = 0 it winds once around what
  /// is on the left of its edges.
  /// @param border  has at least one edge
  bool isEmbedded(const RegionBorder& border, std::uint32_t directions);

  /// @brief The bit of the direction of the last proof.
  int direction() const { return direction_; }

  /// @brief Marks the vertices of the pairs of edges without a common vertex that may
  /// come within a distance of each other during the step, seen along a direction. With a
  /// distance far above the length of edges all vertices of the border are marked.
  /// @param border  has at least one edge
  /// @param direction  a bit of kAxes
  /// @param[out] is_apart  0 for a vertex that is marked, by its place
  void markNear(const RegionBorder& border, int direction, double distance,
                std::vector<std::uint8_t>& is_apart);

 private:
  struct Point {
    double x, y;
  };
  /// A point of the plane at t = 0 and at t = 1.
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

  int widest(std::uint32_t directions) const;
  void project(int direction);
  PlanarEdge planarEdge(std::size_t i) const {
    assert(i < border_->size() && points_.size() == border_->points.size());
    return {points_[border_->begins[i]], points_[border_->begins[i] + 1]};
  }
  void fitPoints();
  void fitTree();
  template <typename Visit>
  void visitPairs(const KdopShift* shift, Visit&& visit) const;
  bool isSimple();
  bool meetOnlyAtVertices(std::size_t i, std::size_t j) const;
  bool areApart(const PlanarEdge& e, const PlanarEdge& f, double distance) const;
  bool areApart(const PlanarEdge& e, const PlanarEdge& f, const Point (&w)[2],
                double distance) const;
  double lengthOf(const Point& w) const;
  KdopShift shiftFor(double distance) const;
  bool windsOnce() const;
  bool windsOnceLeftOf(std::size_t i) const;

  const MovingKdopTree& tree_;
  const Kernels& kernels_;
  /// The border that is tested, and its points in the plane.
  const RegionBorder* border_{nullptr};
  int direction_{0};
  /// The products of the two vectors with which the plane's coordinates are made: of the
  /// first with itself, of both, of the second with itself.
  double products_[3]{};
  std::vector<MovingPoint> points_;
  BorderTree boxes_;
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
