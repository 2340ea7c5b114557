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

extern const Kernels kKernels = {targetName(),
                                 &fitPoints,
                                 &fitNodeOf,
                                 &overlapChildrenOf,
                                 &overlapTrianglesOf,
                                 &listFeatures,
                                 &cullFeaturesOf,
                                 &cullCrossings,
                                 &areApart,
                                 &mayCrossOfEight,
                                 &areFansEmbedded,
                                 &facedDirections,
                                 &viewFrom,
                                 &leastSightFrom,
                                 &lowCorners,
                                 &coplanarityOfFeatures,
                                 &mayComeWithinOfFeatures,
                                 &approachOfEight,
                                 &leastDistancesOf,
                                 &solveEight,
                                 &divideEight};

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
  std::vector<const Kernels*> all;
#if defined(FCL_CCD_USE_HIGHWAY) && (HWY_TARGETS & (HWY_TARGETS - 1)) != 0
  // The library makes its own choice, since Highway's is valid for the whole process. The
  // best target has the lowest bit. Without any bit the code without vector instructions
  // is used.
  hwy::ChosenTarget choice;
  for (std::int64_t left = hwy::SupportedTargets() & HWY_TARGETS; true;
       left &= left - 1) {
    choice.Update(left & -left);
    const Kernels* k = HWY_DISPATCH_TABLE(table)[choice.GetIndex()]();
    if (all.empty() || all.back() != k) all.push_back(k);
    if (left == 0) return all;
  }
#else
  all.push_back(&kernels());
  return all;
#endif
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
#endif
