// SPDX-License-Identifier: BSD-3-Clause
//
// The second precision of solveCoplanarity(), for features that lie nearly in one plane
// or along one line: to doubles their volume, or the normal of their plane, is mere
// rounding.
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
  bool is_double{true};  // all lo are 0

  AccurateDifference() = default;
  AccurateDifference(const VertexPath& p, const VertexPath& q);
  void at(const DoubleDouble& t, DoubleDouble (&out)[3]) const;
};

/// @brief Volume and cross products of a pair, named as in solveCoplanarity(): computed
/// for the whole step in twice the digits of a double, rounded, and restricted to parts
/// of the step in doubles.
class AccuratePair {
 public:
  AccuratePair(ContinuousContactKind kind, const FeaturePoints& x);

  /// @brief Bernstein coefficients of the volume u . (v x w) over [lo, hi], and a bound
  /// on their error; false where the coordinates leave the range in which there is one.
  bool volume(double lo, double hi, double (&b)[4], double& error) const;

  /// @brief Whether all these coefficients have one sign beyond doubt; over the whole
  /// step they are not even rounded.
  bool hasNoRoot(double lo, double hi) const;

  /// @brief v x w over [lo, hi]; its error is infinite where there is no bound.
  MovingCross normal(double lo, double hi) const;

  /// @brief The cross product of inside condition i, likewise; made at the first call.
  MovingCross side(int i, double lo, double hi);

  /// Whether the features touch at a root of the volume, and a bracket of that root.
  struct RootContact {
    Answer answer;
    double lo, hi;
  };

  /// @brief What happens at the only root of the volume in (lo, hi), which is found in
  /// twice the digits too: edges that are parallel but for rounding touch while they are
  /// in one line, for less time than doubles can tell.
  /// @return kUnsure if there may be no root or several, or nearly a contact.
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
  double volume_error_;  // infinite where there is no bound
  MovingCross normal_;
  std::optional<MovingCross> side_[4];
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
