// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_ELEMENTARY_EXACT_H
#define FCL_CCD_ELEMENTARY_EXACT_H

#include "elementary/feature_points.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief The definition of a contact over [0, t_max], exact for all finite inputs: kYes
/// or kNo. For kYes the first time of contact is in [toc_lo, toc_hi], and toc_hi - toc_lo
/// is at most toc_err or a few units in the last place. Both are equal if the time is
/// found exactly.
/// @param t_stop  the answer may be kNo if the first contact begins later than this. The
/// bracket of a contact does not depend on it
/// @param t_max  in [0, 1]; a contact that begins exactly then counts
ElementaryResult decideExactly(ContinuousContactKind kind, const FeaturePoints& x,
                               double toc_err, double t_stop = 1, double t_max = 1);

class ExactPair;

/// @brief The stage of decideExactly() that decides by roots of polynomials with integer
/// coefficients, where solveMagnified() cannot.
/// @param clock_exponent  of the integers, see FrameDigits
/// @pre the features do not touch at t = 0, and t_max > 0
ElementaryResult decideByRoots(const ExactPair& pair, int clock_exponent, double toc_err,
                               double t_stop, double t_max);

/// @brief The same answer for a pair whose coordinates are not doubles.
ElementaryResult decideExactly(const ExactPair& pair, double toc_err);

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
