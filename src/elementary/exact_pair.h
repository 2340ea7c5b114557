// SPDX-License-Identifier: BSD-3-Clause
//
// The definition of a contact, evaluated with integers. Coordinates are doubles, and so
// they are integers times a common power of two; or rational numbers, and so integers
// divided by a common denominator. All conditions are polynomials in t with integer
// coefficients, and times of contact are roots of these.
#ifndef FCL_CCD_ELEMENTARY_EXACT_PAIR_H
#define FCL_CCD_ELEMENTARY_EXACT_PAIR_H

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "elementary/feature_points.h"
#include "elementary/frame_digits.h"
#include "elementary/pair_table.h"
#include "numerics/exact_polynomial.h"

namespace fcl {
namespace detail {
namespace deformable {

/// The conditions of a contact, see pair_table.h. Seen along an axis k in which n does
/// not vanish, the plane of the points is seen one to one, and the weights of the contact
/// are quotients of components k: those of the inside conditions' cross products, and
/// n_k. All have to be >= 0.
class ExactPair {
 public:
  using MovingPoint = std::array<ExactPolynomial, 3>;

  ExactPair(ContinuousContactKind kind, const FeaturePoints& x,
            const FrameDigits& digits);
  /// @param paths  of the four points, with coordinates of degree 1
  ExactPair(ContinuousContactKind kind, const std::array<MovingPoint, 4>& paths);

  /// @brief The volume u . (v x w) of the four points.
  const ExactPolynomial& volume() const { return volume_; }

  /// @brief A set of times. If there is a contact after 0, the first one is at one of
  /// them.
  std::vector<Root> candidates() const;

  /// @brief Whether the features touch at a time at which volume() is 0, as it is at the
  /// candidates().
  bool touchAt(Root& t) const;

 private:
  /// @param common_axis  axisOfCommonPlane(), which saves what is 0; or -1
  ExactPair(ContinuousContactKind kind, const std::array<MovingPoint, 4>& paths,
            int common_axis);

  struct PointAndSegment {
    const MovingPoint &p, &q, &r;
  };

  ExactPolynomial weight(int i, std::size_t k) const;
  std::vector<PointAndSegment> pointsOnSegments() const;
  static bool isOnSegmentAt(Root& t, const MovingPoint& p, const MovingPoint& q,
                            const MovingPoint& r);

  const PairTable& table_;
  bool is_edge_edge_;
  std::array<MovingPoint, 4> p_;
  std::array<MovingPoint, kQ + 1> differences_;
  MovingPoint n_;
  ExactPolynomial volume_;
};

/// @brief A pair for the exact stages. Its polynomials are computed when they are first
/// needed.
class ExactQuery {
 public:
  ExactQuery(ContinuousContactKind kind, const FeaturePoints& x)
      : kind_(kind), x_(x), digits_(x) {}

  ContinuousContactKind kind() const { return kind_; }
  const FeaturePoints& points() const { return x_; }
  const FrameDigits& digits() const { return digits_; }
  const ExactPair& pair() {
    if (!pair_) pair_.emplace(kind_, x_, digits_);
    return *pair_;
  }

  /// @brief Whether the features touch at t = 0 or 1.
  bool touchInFrame(int t) const;
  /// @brief Whether the four points are coplanar at t = 0 or 1.
  bool isCoplanarInFrame(int t) const;

 private:
  ContinuousContactKind kind_;
  FeaturePoints x_;
  FrameDigits digits_;
  std::optional<ExactPair> pair_;
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
