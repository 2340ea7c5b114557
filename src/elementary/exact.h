// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_ELEMENTARY_EXACT_H
#define FCL_CCD_ELEMENTARY_EXACT_H

#include "elementary/feature_points.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief The definition over the whole step, with integers: right for all finite inputs.
/// kYes or kNo; the first time of contact lies in [toc_lo, toc_hi], toc_hi - toc_lo <=
/// toc_err or a few units in the last place, equal when the time is found exactly.
ElementaryResult decideExactly(ContinuousContactKind kind, const FeaturePoints& x,
                               double toc_err);

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
