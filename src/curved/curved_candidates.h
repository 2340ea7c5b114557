// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_CURVED_CURVED_CANDIDATES_H
#define FCL_CCD_CURVED_CURVED_CANDIDATES_H

#include "bodies/moving_body.h"
#include "query/candidate_collector.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief Hands the pairs of features of two bodies that may touch, or come within a
/// distance, during t in [0, 1] to the sink: those that no box keeps apart. Each pair
/// comes once, in ascending order of its vertices, VF first. All are collected before the
/// first is handed out.
/// @pre the floating-point mode is the default one
/// @return whether the sink took them all
/// @throws NonFiniteVertex; fcl::Exception when a vertex id of a triangle is out of range
bool curvedCandidates(const MovingBody& a, const MovingBody& b,
                      const FeatureCandidateSink& sink, double min_distance = 0);

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
