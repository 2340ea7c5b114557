// SPDX-License-Identifier: BSD-3-Clause
//
// The order in which the points of a pair are tested at a distance. It depends on the
// points and their ids only, so that the answer does not depend on the order in which
// they are given.
#ifndef FCL_CCD_ELEMENTARY_ORDERED_POINTS_H
#define FCL_CCD_ELEMENTARY_ORDERED_POINTS_H

#include <cassert>
#include <cstdint>

#include "elementary/feature_points.h"
#include "fcl/narrowphase/stage_counts.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief The points of a pair in order, and the numbers that they had before.
/// @tparam Point  VertexPath or TreeVertex
template <typename Point>
class OrderedPoints {
 public:
  OrderedPoints(ContinuousContactKind kind, const Point* const (&points)[4],
                const PointIds& ids)
      : point{points[0], points[1], points[2], points[3]}, ids_(ids) {
    putInOrder(kind);
    assert(isOrdered(kind));
  }

  const Point* point[4];
  int number[4]{0, 1, 2, 3};

 private:
  void putInOrder(ContinuousContactKind kind) {
    switch (kind) {
      case ContinuousContactKind::kVertexFace:
        sort(1, 2);
        sort(2, 3);
        sort(1, 2);
        return;
      case ContinuousContactKind::kEdgeEdge:
        sort(0, 1);
        sort(2, 3);
        sortEdges();
        return;
      case ContinuousContactKind::kVertexEdge:
        sort(1, 2);
        return;
      default:
        swapIf(compare(1, 0) < 0, 0, 1);
        return;
    }
  }
  bool isOrdered(ContinuousContactKind kind) const {
    switch (kind) {
      case ContinuousContactKind::kVertexFace:
        return number[0] == 0 && !isBefore(2, 1) && !isBefore(3, 2);
      case ContinuousContactKind::kEdgeEdge:
        return !isBefore(1, 0) && !isBefore(3, 2) && compare(0, 2) <= 0;
      case ContinuousContactKind::kVertexEdge:
        return number[0] == 0 && !isBefore(2, 1);
      default:
        return compare(0, 1) <= 0;
    }
  }
  /// Below, at or above 0: point i is before point j, they coincide, or it is after it.
  int compare(int i, int j) const {
    const Point &p = *point[i], &q = *point[j];
    for (int k = 0; k < 3; ++k)
      if (p.t0[k] != q.t0[k]) return p.t0[k] < q.t0[k] ? -1 : 1;
    for (int k = 0; k < 3; ++k)
      if (p.t1[k] != q.t1[k]) return p.t1[k] < q.t1[k] ? -1 : 1;
    return 0;
  }
  /// Whether a point of a feature comes before another one of the same feature.
  bool isBefore(int i, int j) const {
    const int order = compare(i, j);
    return order != 0 ? order < 0 : ids_.id[number[i]] < ids_.id[number[j]];
  }
  void sortEdges() {
    const int first = compare(2, 0);
    const bool is_exchanged = first != 0 ? first < 0 : compare(3, 1) < 0;
    swapIf(is_exchanged, 0, 2);
    swapIf(is_exchanged, 1, 3);
  }
  void sort(int i, int j) { swapIf(isBefore(j, i), i, j); }
  /// Without a branch on the condition, which would be unpredictable.
  void swapIf(bool condition, int i, int j) {
    const Point *p = point[i], *q = point[j];
    const int m = number[i], n = number[j];
    point[i] = condition ? q : p;
    point[j] = condition ? p : q;
    number[i] = condition ? n : m;
    number[j] = condition ? m : n;
  }

  const PointIds ids_;
};

/// @brief The numbers that the points of a VF or EE pair had before OrderedPoints took
/// some of its three exchanges:
/// - VF: points 1 and 2; points 2 and 3; points 1 and 2.
/// - EE: the points of the first edge; those of the second edge; the edges.
/// @param exchanges  a bit each
inline void exchangedNumbers(ContinuousContactKind kind, unsigned exchanges,
                             int (&number)[4]) {
  constexpr std::uint8_t kVertexFace[8][4] = {{0, 1, 2, 3}, {0, 2, 1, 3}, {0, 1, 3, 2},
                                              {0, 2, 3, 1}, {0, 2, 1, 3}, {0, 1, 2, 3},
                                              {0, 3, 1, 2}, {0, 3, 2, 1}};
  constexpr std::uint8_t kEdgeEdge[8][4] = {{0, 1, 2, 3}, {1, 0, 2, 3}, {0, 1, 3, 2},
                                            {1, 0, 3, 2}, {2, 3, 0, 1}, {2, 3, 1, 0},
                                            {3, 2, 0, 1}, {3, 2, 1, 0}};
  assert(exchanges < 8);
  assert(kind == ContinuousContactKind::kVertexFace ||
         kind == ContinuousContactKind::kEdgeEdge);
  const auto& numbers =
      (kind == ContinuousContactKind::kVertexFace ? kVertexFace : kEdgeEdge)[exchanges];
  for (int i = 0; i < 4; ++i) number[i] = numbers[i];
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
