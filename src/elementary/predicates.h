// SPDX-License-Identifier: BSD-3-Clause
//
// Tests of points at one time, exact for all finite inputs. First an evaluation in double
// with a bound; if this does not decide, in more digits.
#ifndef FCL_CCD_ELEMENTARY_PREDICATES_H
#define FCL_CCD_ELEMENTARY_PREDICATES_H

#include "elementary/feature_points.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief Sign (-1, 0, 1) of the volume (p - a) . ((b - a) x (c - a)).
int orientation(const double (&p)[3], const double (&a)[3], const double (&b)[3],
                const double (&c)[3]);

/// @brief Sign of the component of (b - a) x (d - c) along an axis.
int crossSign(const double (&a)[3], const double (&b)[3], const double (&c)[3],
              const double (&d)[3], int axis);

/// @brief Whether the inside of segment pq passes through the inside of triangle abc.
/// Touching (a zero orientation) is not crossing: it is a VF or EE contact.
bool isCrossing(const double (&p)[3], const double (&q)[3], const double (&a)[3],
                const double (&b)[3], const double (&c)[3]);

/// @brief Whether a point lies on a closed triangle. A triangle without area is the union
/// of its edges.
bool isOnTriangle(const double (&p)[3], const double (&a)[3], const double (&b)[3],
                  const double (&c)[3]);

/// @brief Whether the closed segments ab and cd touch. A segment without length is a
/// point.
bool doSegmentsTouch(const double (&a)[3], const double (&b)[3], const double (&c)[3],
                     const double (&d)[3]);

/// @brief Whether the features touch at t = 0; the points are finite.
bool doTouchAtStart(ContinuousContactKind kind, const FeaturePoints& x);

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
