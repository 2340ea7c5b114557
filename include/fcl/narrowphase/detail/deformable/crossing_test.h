// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_NARROWPHASE_DETAIL_DEFORMABLE_CROSSING_TEST_H
#define FCL_NARROWPHASE_DETAIL_DEFORMABLE_CROSSING_TEST_H

namespace fcl {
namespace detail {
namespace deformable {

/// @brief Sign (-1, 0, 1) of the volume (p - a) . ((b - a) x (c - a)), exact for all
/// finite inputs: a bounded double evaluation first, then integers.
int orientation(const double (&p)[3], const double (&a)[3], const double (&b)[3],
                const double (&c)[3]);

/// @brief Whether the inside of segment pq passes through the inside of triangle abc,
/// exact. Touching (a zero orientation) is not crossing: it is a VF or EE contact.
bool isCrossing(const double (&p)[3], const double (&q)[3], const double (&a)[3],
                const double (&b)[3], const double (&c)[3]);

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
