// SPDX-License-Identifier: BSD-3-Clause
//
// Eight or sixteen numbers that are computed at the same time, in as many of Highway's
// vectors as the machine needs for them. They are a plain loop if Highway is switched
// off, and for its targets without vector instructions (HWY_SCALAR, HWY_EMU128): the
// compiler makes faster and shorter code of loops than of Highway's functions there.
// Every operation is an IEEE operation, lane by lane, and none is fused. So all machines
// give the same bits.
//
// Included once for each of Highway's targets. So it has no ordinary include guard.
#include <cassert>
#include <cmath>

#include "base/bits.h"
#if defined(FCL_CCD_USE_HIGHWAY)
#include "hwy/highway.h"
#else
#define HWY_BEFORE_NAMESPACE() static_assert(true, "")
#define HWY_AFTER_NAMESPACE() static_assert(true, "")
#define HWY_NAMESPACE plain_lanes
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

// Functions of Highway's vectors are inlined always, so that the vectors stay in
// registers. Of loops the compiler would make too much code then.
#undef FCL_CCD_INLINE
#if defined(FCL_CCD_USE_HIGHWAY) && HWY_TARGET != HWY_SCALAR && HWY_TARGET != HWY_EMU128
#define FCL_CCD_INLINE HWY_INLINE
#include "kernels/highway_lanes.h"
#else
#define FCL_CCD_INLINE inline
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
FCL_CCD_INLINE Lanes<T, N> max(const Lanes<T, N>& a, const Lanes<T, N>& b) {
  return select(a > b, a, b);
}

template <typename T, std::size_t N>
FCL_CCD_INLINE Lanes<T, N> min(const Lanes<T, N>& a, const Lanes<T, N>& b) {
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
