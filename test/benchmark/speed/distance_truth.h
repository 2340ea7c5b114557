// SPDX-License-Identifier: BSD-3-Clause
//
// What is within a distance during a step, by formulas, without the library.
#ifndef FCL_BENCHMARK_SPEED_DISTANCE_TRUTH_H
#define FCL_BENCHMARK_SPEED_DISTANCE_TRUTH_H

#include <array>
#include <vector>

#include "fcl/narrowphase/continuous_contact.h"
#include "scene_data.h"

namespace fcl {
namespace test {

/// @brief The distance of two features at t, in the unit of the coordinates, by textbook
/// formulas.
/// @param kind  kVertexFace, kEdgeEdge, kVertexEdge or kVertexVertex
/// @param vertices  as in a ContinuousContact
double distanceAt(const FramePairMesh& mesh, ContinuousContactKind kind,
                  const std::array<int, 4>& vertices, double t);

/// @brief A VF or EE pair and a time at which it is within its distance. There may be
/// earlier ones.
struct PairWithin {
  ContinuousContactKind kind;
  std::array<int, 4> vertices;
  double toc;
};

/// @brief The pairs without a common vertex that come within d (1 - 1e-6) - 1e-9 d, so
/// that rounding does not matter. They are found by a sweep over boxes, and by distances
/// at times that are at most 1/256 apart where the speed of the features does not allow
/// more. So all of them do come within d. A pair that does so for less than 1/256 of the
/// step may be left out.
/// @param ignores_initially_closer  in place of d: the distance at t = 0 if that is less.
/// Then pairs that touch at t = 0 are left out.
std::vector<PairWithin> findPairsWithin(const FramePairMesh& mesh, double d,
                                        bool ignores_initially_closer);

}  // namespace test
}  // namespace fcl

#endif
