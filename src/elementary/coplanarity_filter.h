// SPDX-License-Identifier: BSD-3-Clause
//
// The Non-coplanar Theorems of the paper (Tang, Manocha, Tong 2010, section 3.3), with
// bounds on rounding.
#ifndef FCL_CCD_ELEMENTARY_COPLANARITY_FILTER_H
#define FCL_CCD_ELEMENTARY_COPLANARITY_FILTER_H

#include "elementary/feature_points.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief Whether four points become coplanar, as far as doubles can tell.
enum class Coplanarity {
  kNever,
  kPossible,
  kUnclear  ///< the signs say never, but may be rounding only
};

/// @brief The coplanarity filter over [window_lo, window_hi] in doubles. kNever proves
/// that the four points are never coplanar in the window, so that the features never
/// touch in it. (1) Never kNever for a pair that touches. (2) NaN, infinity and products
/// that could underflow or overflow give kPossible.
Coplanarity coplanarityInDoubles(ContinuousContactKind kind, const FeaturePoints& x,
                                 double window_lo, double window_hi);

/// @brief The same question in double-double, for pairs that are kUnclear. False is a
/// proof, as kNever is.
bool mayBecomeCoplanarAccurately(ContinuousContactKind kind, const FeaturePoints& x,
                                 double window_lo, double window_hi);

/// @brief The whole filter: in doubles, and in double-double if doubles are unclear.
bool mayBecomeCoplanar(ContinuousContactKind kind, const FeaturePoints& x,
                       double window_lo, double window_hi);

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
