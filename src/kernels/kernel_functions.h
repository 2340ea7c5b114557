// SPDX-License-Identifier: BSD-3-Clause
//
// The functions to which the tables in dispatch.cpp point. Each is compiled for each
// instruction set. kernels.h describes them.
//
// Included once for each of Highway's targets. So it has no ordinary include guard.
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

void fitPoints(const double (&offsets)[3][8], int frame, std::size_t count,
               TreeVertex* vertices);
void fitNodeOf(const TreeVertex* vertices, const MovingKdopNode* nodes, bool is_still,
               MovingKdopNode& node, float (&extents)[MovingKdopNode::kWidth]);
unsigned overlapChildrenOf(const BoxView& box, const MovingKdopNode& node,
                           const OverlapRequest& request,
                           float (&earliest)[MovingKdopNode::kWidth]);
void overlapTrianglesOf(const LeafPairing& leaves, LanePairs& out);
std::size_t listFeatures(const std::uint16_t* masks, std::size_t count, unsigned kept,
                         std::uint32_t* codes);
std::size_t cullFeaturesOf(ContinuousContactKind kind, const TrianglePair* pairs,
                           const KdopShift* shift, const KdopShift* turned_shift,
                           float latest, const float* gaps, std::uint32_t* codes,
                           std::size_t count, TimeWindow* windows);
std::size_t cullCrossings(const TrianglePair* pairs, const KdopShift* shift,
                          const KdopShift* turned_shift, std::uint32_t* codes,
                          std::size_t count);
unsigned areApart(const TrianglePair* pairs, std::size_t count, double share,
                  double distance, float (&gaps)[8]);
unsigned stayApart(const TrianglePair* pairs, std::size_t count, double distance,
                   const PairBends& bends);
unsigned mayCrossOfEight(const TrianglePair* pairs, const std::uint32_t* codes,
                         std::size_t count);
unsigned mayComeWithinOfFeatures(ContinuousContactKind kind, const TrianglePair* pairs,
                                 const std::uint32_t* codes, const TimeWindow* windows,
                                 std::size_t count, const DistanceRequest& request,
                                 const PairBends& bends);
void approachOfAll(ContinuousContactKind kind, const FourPoints* pairs, std::size_t count,
                   const DistanceRequest& request, Approach* answers);
unsigned approachAtStartOf(ContinuousContactKind kind, const TrianglePair* pairs,
                           const std::uint32_t* codes, std::size_t count, double distance,
                           double reach, Approach (&answers)[8]);
unsigned leastDistancesOf(const EightPoints& pairs, double (&least)[8]);
unsigned areFansEmbedded(const TreeVertex* vertices, const EightFans& fans,
                         double distance);
std::uint32_t facedDirections(const TreeVertex* vertices, const TreeTriangle* triangles,
                              std::size_t count);
EightViews viewFromPoint(const TreeVertex& point, const double (&ray)[3],
                         const TreeVertex* vertices, const TreeTriangle* triangles,
                         std::size_t count, LeastSight* least);
std::uint32_t lowCorners(const TreeVertex* vertices, const MovingKdopNode& node,
                         const int (&direction)[3], double distance);
EightCoplanarities coplanarityOfFeatures(ContinuousContactKind kind,
                                         const TrianglePair* pairs,
                                         const std::uint32_t* codes,
                                         const TimeWindow* windows, std::size_t count,
                                         double latest);
EightAnswers solveEight(const EightPairs& pairs, double toc_err);
EightDivisions divideEight(const EightPairs& pairs);

}  // namespace HWY_NAMESPACE
}  // namespace deformable
}  // namespace detail
}  // namespace fcl
HWY_AFTER_NAMESPACE();

#endif
