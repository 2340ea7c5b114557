// SPDX-License-Identifier: BSD-3-Clause
//
// Eight or sixteen numbers that are computed at the same time, in as many of Highway's
// vectors as the machine needs for them, or in a plain loop if Highway is switched off.
// Every operation is an IEEE operation, lane by lane, and none is fused. So all machines
// give the same bits.
//
// Included once for each of Highway's targets. So it has no ordinary include guard.
#if defined(FCL_CCD_USE_HIGHWAY)
#include "hwy/highway.h"
#else
#include <cmath>
#define HWY_BEFORE_NAMESPACE() static_assert(true, "")
#define HWY_AFTER_NAMESPACE() static_assert(true, "")
#define HWY_NAMESPACE plain_lanes
#define HWY_INLINE inline
#define HWY_ATTR
#endif

#if defined(FCL_CCD_LANES_INCLUDED) == defined(HWY_TARGET_TOGGLE)
#ifdef FCL_CCD_LANES_INCLUDED
#undef FCL_CCD_LANES_INCLUDED
#else
#define FCL_CCD_LANES_INCLUDED
#endif

HWY_BEFORE_NAMESPACE();
namespace fcl {
namespace detail {
namespace deformable {
namespace HWY_NAMESPACE {

constexpr std::size_t kEight = 8, kSixteen = 16;

}  // namespace HWY_NAMESPACE
}  // namespace deformable
}  // namespace detail
}  // namespace fcl
HWY_AFTER_NAMESPACE();

#if defined(FCL_CCD_USE_HIGHWAY)
#include "kernels/highway_lanes.h"
#else
#include "kernels/plain_lanes.h"
#endif

HWY_BEFORE_NAMESPACE();
namespace fcl {
namespace detail {
namespace deformable {
namespace HWY_NAMESPACE {

/// The larger (smaller) of two numbers; b if one is a NaN. Highway's own function is not
/// used, since its answer for a NaN depends on the target.
template <typename T, std::size_t N>
HWY_INLINE Lanes<T, N> max(const Lanes<T, N>& a, const Lanes<T, N>& b) {
  return select(a > b, a, b);
}

template <typename T, std::size_t N>
HWY_INLINE Lanes<T, N> min(const Lanes<T, N>& a, const Lanes<T, N>& b) {
  return select(a < b, a, b);
}

using Floats = Lanes<float, kEight>;
using HalfAxes = Lanes<float, 16>;
using Doubles = Lanes<double, kEight>;
using DoubleMask = LaneMask<double, kEight>;

}  // namespace HWY_NAMESPACE
}  // namespace deformable
}  // namespace detail
}  // namespace fcl
HWY_AFTER_NAMESPACE();

#endif
