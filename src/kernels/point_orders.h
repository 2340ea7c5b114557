// SPDX-License-Identifier: BSD-3-Clause
//
// The points of eight pairs in the order of OrderedPoints.
//
// Included once for each of Highway's targets. So it has no ordinary include guard.
#include <cassert>

#include "elementary/ordered_points.h"
#include "kernels/eight_features.h"
#include "kernels/lanes.h"
#include "kernels/vectors.h"

#if defined(FCL_CCD_POINT_ORDERS_INCLUDED) == defined(HWY_TARGET_TOGGLE)
#ifdef FCL_CCD_POINT_ORDERS_INCLUDED
#undef FCL_CCD_POINT_ORDERS_INCLUDED
#else
#define FCL_CCD_POINT_ORDERS_INCLUDED
#endif

HWY_BEFORE_NAMESPACE();
namespace fcl {
namespace detail {
namespace deformable {
namespace HWY_NAMESPACE {

/// Puts the points of eight pairs in order. Lanes in which two points of a feature
/// coincide are left out: their ids would decide. Of StartPoints also those whose order
/// depends on t = 1.
class PointOrders {
 public:
  PointOrders() = default;
  /// @tparam AnyPoints  Points or StartPoints
  template <typename AnyPoints>
  FCL_CCD_INLINE PointOrders(ContinuousContactKind kind, AnyPoints& x) {
    assert(kind == ContinuousContactKind::kVertexFace ||
           kind == ContinuousContactKind::kEdgeEdge);
    if (kind == ContinuousContactKind::kVertexFace) {
      sort(x, 0, 1, 2);
      sort(x, 1, 2, 3);
      sort(x, 2, 1, 2);
    } else {
      sort(x, 0, 0, 1);
      sort(x, 1, 2, 3);
      const Comparison first = compare(x, 2, 0), second = compare(x, 3, 1);
      if (!AnyPoints::kHaveEnd) unknown_ |= bits(first.is_equal);
      const DoubleMask is_exchanged = first.is_less | (first.is_equal & second.is_less);
      exchanges_[2] = bits(is_exchanged);
      exchange(is_exchanged, x, 0, 2);
      exchange(is_exchanged, x, 1, 3);
    }
  }

  /// The lanes that are left out.
  FCL_CCD_INLINE unsigned unknown() const { return unknown_; }
  /// The exchanges of a lane, see exchangedNumbers().
  FCL_CCD_INLINE unsigned exchanges(std::size_t lane) const {
    assert(lane < kEight);
    return (exchanges_[0] >> lane & 1U) | (exchanges_[1] >> lane & 1U) << 1 |
           (exchanges_[2] >> lane & 1U) << 2;
  }

 private:
  struct Comparison {
    DoubleMask is_less, is_equal;
  };

  /// By the coordinates at t = 0, then by those at t = 1.
  template <typename AnyPoints>
  static FCL_CCD_INLINE Comparison compare(const AnyPoints& x, int i, int j) {
    const Vectors &p = x.t0[i], &q = x.t0[j];
    Comparison order{p.x < q.x, p.x == q.x};
    if (bits(order.is_equal) == 0) return order;
    then(p.y, q.y, order);
    then(p.z, q.z, order);
    if constexpr (AnyPoints::kHaveEnd) {
      then(x.t1[i].x, x.t1[j].x, order);
      then(x.t1[i].y, x.t1[j].y, order);
      then(x.t1[i].z, x.t1[j].z, order);
    }
    return order;
  }
  static FCL_CCD_INLINE void then(const Doubles& p, const Doubles& q, Comparison& order) {
    order.is_less = order.is_less | (order.is_equal & (p < q));
    order.is_equal = order.is_equal & (p == q);
  }

  template <typename AnyPoints>
  FCL_CCD_INLINE void sort(AnyPoints& x, int step, int i, int j) {
    const Comparison order = compare(x, j, i);
    exchanges_[step] = bits(order.is_less);
    unknown_ |= bits(order.is_equal);
    exchange(order.is_less, x, i, j);
  }
  template <typename AnyPoints>
  static FCL_CCD_INLINE void exchange(const DoubleMask& condition, AnyPoints& points,
                                      int i, int j) {
    exchange(condition, points.t0[i], points.t0[j]);
    if constexpr (AnyPoints::kHaveEnd) exchange(condition, points.t1[i], points.t1[j]);
  }
  static FCL_CCD_INLINE void exchange(const DoubleMask& condition, Vectors& x,
                                      Vectors& y) {
    const Vectors p = x, q = y;
    x = select(condition, q, p);
    y = select(condition, p, q);
  }

  unsigned exchanges_[3];
  unsigned unknown_{0};
};

}  // namespace HWY_NAMESPACE
}  // namespace deformable
}  // namespace detail
}  // namespace fcl
HWY_AFTER_NAMESPACE();

#endif
