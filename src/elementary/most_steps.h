// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_ELEMENTARY_MOST_STEPS_H
#define FCL_CCD_ELEMENTARY_MOST_STEPS_H

namespace fcl {
namespace detail {
namespace deformable {

/// @brief The number of steps after which the advancement of a pair is given up. Features
/// that move along each other at nearly the distance at which they are in contact may
/// need as many.
constexpr int kMostSteps = 10000;

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
