// SPDX-License-Identifier: BSD-3-Clause
//
// The second precision of solveCoplanarity(): double-double. It is for features that lie
// nearly in one plane or along one line. In doubles their volume, or the normal of their
// plane, is rounding only.
#ifndef FCL_CCD_ELEMENTARY_ACCURATE_PAIR_H
#define FCL_CCD_ELEMENTARY_ACCURATE_PAIR_H

#include <optional>

#include "elementary/feature_points.h"
#include "elementary/pair_table.h"
#include "numerics/double_double.h"
#include "numerics/moving_vector.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief The difference of two vertices over the step, exact at both ends.
struct AccurateDifference {
  DoubleDouble t0[3], t1[3];
  double norm{0};
  bool is_double{true};  // whether all lo are 0

  AccurateDifference() = default;
  AccurateDifference(const VertexPath& p, const VertexPath& q);
  void at(const DoubleDouble& t, DoubleDouble (&out)[3]) const;
};

/// @brief Volume and cross products of a pair, with the names of pair_table.h. They
/// are computed in double-double for the whole step, rounded, and restricted to parts of
/// the step in doubles.
class AccuratePair {
 public:
  AccuratePair(ContinuousContactKind kind, const FeaturePoints& x);

  /// @brief Bernstein coefficients of the volume u . (v x w) over [lo, hi], and a bound
  /// on their error. False: the coordinates are outside of the range in which there is a
  /// bound.
  bool volume(double lo, double hi, double (&b)[4], double& error) const;

  /// @brief Whether all these coefficients certainly have one sign. For the whole step
  /// the coefficients are not even rounded.
  bool hasNoRoot(double lo, double hi) const;

  /// @brief v x w over [lo, hi]. Its error is infinite if there is no bound.
  MovingCross normal(double lo, double hi) const;

  /// @brief The cross product of inside condition i over [lo, hi], also with its error.
  /// The first call computes it.
  MovingCross side(int i, double lo, double hi);

  /// Whether the features touch at a root of the volume, and a bracket of that root.
  struct RootContact {
    Answer answer;
    double lo, hi;
  };

  /// @brief Decides whether the features touch at the only root of the volume in (lo,
  /// hi). The root is found in double-double, too. Two edges that are parallel except for
  /// rounding touch while they are in one line, for a shorter time than doubles can
  /// resolve.
  /// @return kUnsure if there may be no root or several roots, or if the features nearly
  /// touch
  RootContact contactAtRoot(double lo, double hi) const;

 private:
  struct Cross;

  /// The differences whose cross product inside condition i has.
  struct Factors {
    AccurateDifference x, y;
  };
  AccurateDifference difference(PairDifference i) const;
  Factors factors(int i) const;

  DoubleDouble volumeAt(const DoubleDouble& t) const;
  /// @brief Whether the features touch at the root, which is within t_error of t.
  Answer touchAt(const DoubleDouble& t, double t_error) const;

  const PairTable& table_;
  FeaturePoints x_;
  AccurateDifference u_, v_, w_;
  DoubleDouble volume_[4];  // Bernstein coefficients, the inner ones times 3
  double volume_size_{0};
  double volume_error_;  // infinite if there is no bound
  MovingCross normal_;
  std::optional<MovingCross> side_[4];
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
