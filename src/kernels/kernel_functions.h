// SPDX-License-Identifier: BSD-3-Clause
//
// The functions to which the tables in dispatch.cpp point, by the names of their places
// in Kernels, which describes them. Each is compiled for each instruction set.
//
// Included once for each of Highway's targets. So it has no ordinary include guard.
#include <type_traits>

#include "kernels/kernels.h"
#include "kernels/lanes.h"

#if defined(FCL_CCD_KERNEL_FUNCTIONS_INCLUDED) == defined(HWY_TARGET_TOGGLE)
#ifdef FCL_CCD_KERNEL_FUNCTIONS_INCLUDED
#undef FCL_CCD_KERNEL_FUNCTIONS_INCLUDED
#else
#define FCL_CCD_KERNEL_FUNCTIONS_INCLUDED
#endif

HWY_BEFORE_NAMESPACE();
namespace fcl {
namespace detail {
namespace deformable {
namespace HWY_NAMESPACE {

std::remove_pointer_t<decltype(Kernels::fitPoints)> fitPoints;
std::remove_pointer_t<decltype(Kernels::fitNode)> fitNode;
std::remove_pointer_t<decltype(Kernels::overlapChildren)> overlapChildren;
std::remove_pointer_t<decltype(Kernels::overlapTriangles)> overlapTriangles;
std::remove_pointer_t<decltype(Kernels::listFeatures)> listFeatures;
std::remove_pointer_t<decltype(Kernels::cullFeatures)> cullFeatures;
std::remove_pointer_t<decltype(Kernels::cullCrossings)> cullCrossings;
std::remove_pointer_t<decltype(Kernels::areApart)> areApart;
std::remove_pointer_t<decltype(Kernels::stayApart)> stayApart;
std::remove_pointer_t<decltype(Kernels::mayCross)> mayCross;
std::remove_pointer_t<decltype(Kernels::areFansEmbedded)> areFansEmbedded;
std::remove_pointer_t<decltype(Kernels::facedDirections)> facedDirections;
std::remove_pointer_t<decltype(Kernels::viewFrom)> viewFrom;
std::remove_pointer_t<decltype(Kernels::lowCorners)> lowCorners;
std::remove_pointer_t<decltype(Kernels::coplanarity)> coplanarity;
std::remove_pointer_t<decltype(Kernels::mayComeWithin)> mayComeWithin;
std::remove_pointer_t<decltype(Kernels::approach)> approach;
std::remove_pointer_t<decltype(Kernels::approachAtStart)> approachAtStart;
std::remove_pointer_t<decltype(Kernels::leastDistances)> leastDistances;
std::remove_pointer_t<decltype(Kernels::solve)> solve;
std::remove_pointer_t<decltype(Kernels::divide)> divide;

}  // namespace HWY_NAMESPACE
}  // namespace deformable
}  // namespace detail
}  // namespace fcl
HWY_AFTER_NAMESPACE();

#endif
