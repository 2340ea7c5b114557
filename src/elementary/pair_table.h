// SPDX-License-Identifier: BSD-3-Clause
//
// The geometry of a pair of features, as one table. All tests for coplanar points read
// it: in doubles, in double-double, in integers and in the kernels. Distances, also of
// vertices and edges, have their own order of corners: see DifferencePolygon.
//
// The points are numbered 0 to 3: VF (p; a, b, c) and EE (a b; c d). u, v and w are
// differences of points, and n = v x w is normal to the triangle (VF) or to both edges
// (EE). The points are coplanar where the volume u . n is zero. Then u is a combination
// of v and w. Its coordinates are quotients of (x x y) . n and n^2, where x and y are
// differences as well:
//   VF u = beta v + gamma w:   beta n^2 = (u x w).n, gamma n^2 = (v x u).n and
//                              (1 - beta - gamma) n^2 = ((b-p) x (c-p)).n;
//   EE u = s v - r w:          s n^2 = (u x w).n, (1 - s) n^2 = ((b-c) x w).n,
//                              r n^2 = (u x v).n, (1 - r) n^2 = (v x (d-a)).n.
// These are the inside conditions: the features touch where none of them is negative. If
// one of them is negative, then n != 0 and the features do not touch.
//
// Where n = 0, the triangle has no area, so that it is the union of its edges, or the
// edges are parallel, so that they touch in an end of one of them. There, and where all
// points stay in one plane, features that are apart first meet in a vertex of one and an
// edge of the other.
#ifndef FCL_CCD_ELEMENTARY_PAIR_TABLE_H
#define FCL_CCD_ELEMENTARY_PAIR_TABLE_H

#include <cassert>

#include "fcl/narrowphase/stage_counts.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief Index of a difference in PairTable::difference. r, q and z are sums of u, v and
/// w, for the inside conditions and the corners. Only EE pairs have z.
enum PairDifference : unsigned char { kU, kV, kW, kR, kQ, kZ };
constexpr int kNumPairDifferences = 6;

struct PairTable {
  struct Ends {
    /// The difference is point `to` minus point `from`.
    unsigned char to, from;
  };
  /// Vertex p of one feature and edge qr of the other.
  struct VertexAndEdge {
    unsigned char p, q, r;
  };
  /// A difference of a point of one feature and a point of the other: `sign` times this
  /// difference.
  struct Corner {
    PairDifference difference;
    double sign;
  };

  int num_differences;
  Ends difference[kNumPairDifferences];
  /// r, q and z are these multiples of u, v and w, added up.
  signed char sum[3][3];

  /// The number of inside conditions. There are as many pairs of a vertex and an edge.
  int num_inside;
  /// Inside condition i is (x x y) . n for these two differences x and y.
  PairDifference inside[4][2];
  /// Where features meet first if n = 0 or all points stay in one plane.
  VertexAndEdge meeting[4];

  /// The corners of the set of all differences of two points of the features, which has
  /// the origin in it where they touch: a triangle (VF), or a parallelogram (EE) with
  /// corners 0 and 3 opposite to each other.
  int num_corners;
  Corner corner[4];

  constexpr bool isTriangle() const { return num_corners == 3; }
};

/// VF: u = p - a, v = b - a, w = c - a, r = b - p, q = c - p.
constexpr PairTable kVertexFaceTable = {5,
                                        {{0, 1}, {2, 1}, {3, 1}, {2, 0}, {3, 0}, {}},
                                        {{-1, 1, 0}, {-1, 0, 1}, {}},
                                        3,
                                        {{kU, kW}, {kV, kU}, {kR, kQ}, {}},
                                        {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {}},
                                        3,
                                        {{kU, 1}, {kR, -1}, {kQ, -1}, {}}};

/// EE: u = c - a, v = b - a, w = d - c, r = b - c, q = d - a, z = d - b.
constexpr PairTable kEdgeEdgeTable = {6,
                                      {{2, 0}, {1, 0}, {3, 2}, {1, 2}, {3, 0}, {3, 1}},
                                      {{-1, 1, 0}, {1, 0, 1}, {1, -1, 1}},
                                      4,
                                      {{kU, kW}, {kR, kW}, {kU, kV}, {kV, kQ}},
                                      {{0, 2, 3}, {1, 2, 3}, {2, 0, 1}, {3, 0, 1}},
                                      4,
                                      {{kU, 1}, {kR, -1}, {kQ, 1}, {kZ, 1}}};

/// @brief Whether the sums of a table are the differences of the same points.
constexpr bool hasRightSums(const PairTable& table) {
  for (int i = 0; i + 3 < table.num_differences; ++i)
    for (int point = 0; point < 4; ++point) {
      const auto multipleIn = [&table, point](int k) {
        return (table.difference[k].to == point) - (table.difference[k].from == point);
      };
      int multiple = 0;
      for (int k = 0; k < 3; ++k) multiple += table.sum[i][k] * multipleIn(k);
      if (multiple != multipleIn(i + 3)) return false;
    }
  return true;
}
static_assert(hasRightSums(kVertexFaceTable) && hasRightSums(kEdgeEdgeTable), "r, q, z");

/// @param kind  VF or EE
inline const PairTable& pairTable(ContinuousContactKind kind) {
  assert(kind == ContinuousContactKind::kVertexFace ||
         kind == ContinuousContactKind::kEdgeEdge);
  return kind == ContinuousContactKind::kVertexFace ? kVertexFaceTable : kEdgeEdgeTable;
}

/// @brief What is known about the sign of an inside condition, or of all of them.
enum class Side {
  kNegative,  ///< one condition is certainly negative all the time: no contact
  kPositive,  ///< all are certainly positive all the time
  kMixed,     ///< neither is certain
  kLost       ///< of one condition: its coefficients are rounding only
};

/// @brief Whether the features touch at the times at which the four points of the pair
/// are coplanar. kPositive: always; kNegative: never.
/// @param sideOf  sideOf(i) is the sign of inside condition i
template <typename SideOf>
Side insideness(const PairTable& table, SideOf&& sideOf) {
  Side side = Side::kPositive;
  for (int i = 0; i < table.num_inside; ++i) {
    const Side found = sideOf(i);
    if (found == Side::kNegative) return found;
    if (found != Side::kPositive) side = Side::kMixed;
  }
  return side;
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
