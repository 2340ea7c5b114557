// SPDX-License-Identifier: BSD-3-Clause
//
// The kernels of each instruction set, and the choice between them.
#include "kernels/kernels.h"

#if defined(FCL_CCD_USE_HIGHWAY)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "kernels/dispatch.cpp"
#include "hwy/foreach_target.h"
#endif

#include "kernels/kernel_functions.h"
#if defined(FCL_CCD_USE_HIGHWAY)
#include "kernels/targets.h"
#endif

HWY_BEFORE_NAMESPACE();
namespace fcl {
namespace detail {
namespace deformable {
namespace HWY_NAMESPACE {

#if defined(FCL_CCD_USE_HIGHWAY)
inline const char* targetName() { return hwy::TargetName(HWY_TARGET); }
#else
inline const char* targetName() { return "plain"; }
#endif

extern const Kernels kKernels = {targetName(),     &fitPoints,        &fitNode,
                                 &overlapChildren, &overlapTriangles, &listFeatures,
                                 &cullFeatures,    &cullCrossings,    &areApart,
                                 &stayApart,       &mayCross,         &areFansEmbedded,
                                 &facedDirections, &viewFrom,         &lowCorners,
                                 &coplanarity,     &mayComeWithin,    &approach,
                                 &approachAtStart, &leastDistances,   &solve,
                                 &divide};

const Kernels* table() { return &kKernels; }

}  // namespace HWY_NAMESPACE
}  // namespace deformable
}  // namespace detail
}  // namespace fcl
HWY_AFTER_NAMESPACE();

#if !defined(FCL_CCD_USE_HIGHWAY) || HWY_ONCE
namespace fcl {
namespace detail {
namespace deformable {

#if defined(FCL_CCD_USE_HIGHWAY)
HWY_EXPORT(table);
#endif

const Kernels& kernels() {
#if defined(FCL_CCD_USE_HIGHWAY)
  static const Kernels& best = *HWY_DYNAMIC_DISPATCH(table)();
  return best;
#else
  return HWY_NAMESPACE::kKernels;
#endif
}

std::vector<const Kernels*> allKernels() {
#if defined(FCL_CCD_USE_HIGHWAY) && (HWY_TARGETS & (HWY_TARGETS - 1)) != 0
  std::vector<const Kernels*> all;
  for (const auto kernelsOf : ofEachTarget(HWY_DISPATCH_TABLE(table)))
    all.push_back(kernelsOf());
  return all;
#else
  return {&kernels()};
#endif
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
#endif
