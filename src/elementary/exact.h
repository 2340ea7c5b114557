// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_ELEMENTARY_EXACT_H
#define FCL_CCD_ELEMENTARY_EXACT_H

#include "elementary/feature_points.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief The definition over [0, t_max], exact for all finite inputs: kYes or kNo.
/// For kYes the first time of contact lies in [toc_lo, toc_hi], toc_hi - toc_lo <=
/// toc_err or a few units in the last place; equal when the time is found exactly.
/// @param t_stop  may answer kNo if the first contact begins later than this: what is
/// after it is not looked at. The bracket of a contact does not depend on it
/// @param t_max  in [0, 1]; a contact that begins exactly then counts
ElementaryResult decideExactly(ContinuousContactKind kind, const FeaturePoints& x,
                               double toc_err, double t_stop = 1, double t_max = 1);

/// @brief decideExactly() by roots of polynomials with integer coefficients alone: what
/// it does when solveMagnified() does not find out.
ElementaryResult decideByRoots(ContinuousContactKind kind, const FeaturePoints& x,
                               double toc_err, double t_stop = 1, double t_max = 1);

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
