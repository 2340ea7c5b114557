// SPDX-License-Identifier: BSD-3-Clause
//
// The parts of a moving tree: its nodes, and the triangles and vertices in its order.
#ifndef FCL_CCD_MESH_TREE_NODES_H
#define FCL_CCD_MESH_TREE_NODES_H

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "mesh/mesh_triangle.h"
#include "mesh/moving_kdop.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief Up to eight children, each a subtree or a triangle, with their moving boxes. A
/// row has one half-axis of all children, so that one box is compared with eight at once.
/// The two half-axes of a direction follow each other. The rows of t = 0 are together:
/// much of a first-contact query reads only these.
struct alignas(64) MovingKdopNode {
  static constexpr int kWidth = 8;
  static constexpr std::uint32_t kNoPlace = ~std::uint32_t{0};

  /// Row r at t = 0 and at t = 1.
  float t0[16][kWidth];
  float t1[16][kWidth];
  /// Vertices of the triangles, as places in the tree's order; kNoPlace for a node.
  std::uint32_t places[3][kWidth];
  /// Bound on the change of any coordinate of any vertex of the child during the step.
  float displacement[kWidth];
  /// >= 0: a node; < 0: ~triangle. The first `count` are in use.
  std::int32_t child[kWidth];
  std::int32_t count;
  /// Lanes that are triangles, a bit each: markTriangles().
  std::uint32_t triangles;

  bool isTriangle(int lane) const { return child[lane] < 0; }
  int triangle(int lane) const {
    assert(lane < count && isTriangle(lane));
    return ~child[lane];
  }

  /// @brief Lanes that are in use, a bit each.
  unsigned lanes() const {
    assert(count > 0 && count <= kWidth);
    return (1U << count) - 1;
  }

  /// @brief Sets `triangles`. Call it when the children are set.
  void markTriangles() {
    assert(count > 0 && count <= kWidth);
    triangles = 0;
    for (int lane = 0; lane < count; ++lane)
      triangles |= unsigned{isTriangle(lane)} << lane;
  }

  /// @brief Half-axis of Kdop16 that a row holds.
  static constexpr int halfAxis(int row) { return row / 2 + row % 2 * 8; }

  /// @brief Row that holds a half-axis of Kdop16.
  static constexpr int rowOf(int half_axis) { return half_axis % 8 * 2 + half_axis / 8; }

  void setBox(int lane, const MovingKdop& box) {
    assert(lane >= 0 && lane < kWidth);
    for (int r = 0; r < 16; ++r) {
      t0[r][lane] = box.t0.half[halfAxis(r)];
      t1[r][lane] = box.t1.half[halfAxis(r)];
    }
  }
  MovingKdop box(int lane) const {
    assert(lane >= 0 && lane < kWidth);
    MovingKdop out;
    for (int r = 0; r < 16; ++r) {
      out.t0.half[halfAxis(r)] = t0[r][lane];
      out.t1.half[halfAxis(r)] = t1[r][lane];
    }
    return out;
  }
  /// @brief Fills the lanes that are not in use with boxes that overlap nothing.
  void clearRest() {
    assert(count >= 0 && count <= kWidth);
    for (int i = count; i < kWidth; ++i) {
      child[i] = 0;
      displacement[i] = 0;
      for (int r = 0; r < 16; ++r) t0[r][i] = t1[r][i] = kLeastHalf;
    }
  }

  /// @brief Whether the boxes and displacements are such that a traversal can compare
  /// them: no NaN, no half-axis below kLeastHalf, and nothing in lanes not in use.
  bool isComparable() const {
    for (int lane = 0; lane < kWidth; ++lane) {
      if (!(displacement[lane] >= 0)) return false;
      for (int r = 0; r < 16; ++r) {
        if (!(t0[r][lane] >= kLeastHalf && t1[r][lane] >= kLeastHalf)) return false;
        if (lane >= count && (t0[r][lane] > kLeastHalf || t1[r][lane] > kLeastHalf))
          return false;
      }
    }
    return true;
  }

  /// @brief Whether the boxes of a child, and the bound on its motion, contain others.
  bool contains(int lane, const MovingKdop& other, double moved) const {
    const MovingKdop own = box(lane);
    for (int j = 0; j < 16; ++j)
      if (other.t0.half[j] > own.t0.half[j] || other.t1.half[j] > own.t1.half[j])
        return false;
    return !(moved > double{displacement[lane]});
  }
};

/// @brief A triangle, as the tests read it.
struct TreeTriangle {
  /// Places of the vertices in the tree's order.
  std::uint32_t place[3];
  std::uint32_t owned;
  /// The user's ids of the vertices and of the triangle.
  std::uint32_t id[3];
  std::uint32_t index;
};

inline ThreeIds idsOf(const TreeTriangle& t) {
  static_assert(offsetof(TreeTriangle, id) + sizeof(ThreeIds) == sizeof(TreeTriangle),
                "one more number may be read");
  ThreeIds ids;
  std::memcpy(&ids, reinterpret_cast<const char*>(&t) + offsetof(TreeTriangle, id),
              sizeof(ids));
  return ids;
}

/// @brief A vertex, as the tests read it: its path and its moving box. t0[3] is a bound
/// on the change of a coordinate during the step, which is a float. t1[3] is not used.
struct alignas(64) TreeVertex {
  double t0[4];
  double t1[4];
  MovingKdop box;

  double displacement() const { return t0[3]; }

  /// @brief Sets the path. Differences of doubles are rounded by 2^-53 of themselves,
  /// much less than roundUp() adds.
  void setPath(const double (&from)[3], const double (&to)[3]) {
    double moved = 0;
    for (int k = 0; k < 3; ++k) {
      t0[k] = from[k];
      t1[k] = to[k];
      moved = std::max(moved, std::fabs(to[k] - from[k]));
    }
    t0[3] = double{roundUp(moved, 0.f)};
    t1[3] = 0;
  }
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
