// SPDX-License-Identifier: BSD-3-Clause
//
// Elementary tests at a distance: the library's, and two usual ones to compare with.
#ifndef FCL_BENCHMARK_DISTANCE_METHODS_H
#define FCL_BENCHMARK_DISTANCE_METHODS_H

#include <string>
#include <vector>

#include "feature_pair_generators.h"

namespace fcl {
namespace test {

/// @brief toc: the time that a method gives out as the first.
struct DistanceAnswer {
  bool contact;
  double toc;
};

struct DistanceMethod {
  std::string name;
  /// How the number is written in the table.
  std::string setting;
  double number;
  DistanceAnswer (*answer)(const MovingPair& query, double distance, double number);
};

/// @brief ours: vertexFaceWithin() and edgeEdgeWithin(), by `toc_err`.
///
/// inclusion: bisection of the box of time and both weights, after Wang et al. 2021, "A
/// Large-Scale Benchmark and an Inclusion-Based Algorithm for Continuous Collision
/// Detection". A box is left out if the box of the differences does not meet the cube of
/// half width d; it is a contact if the box of the differences is smaller than the number
/// times the size of the pair, or after 100,000 boxes. Differences from the paper: one
/// order of boxes (by time), one tolerance in place of three, no bounds on rounding.
///
/// additive: conservative advancement, after Li et al. 2021, "Codimensional Incremental
/// Potential Contact": without the mean motion of the points, in steps of the number
/// times what the distance and the largest displacements allow, until the gap is below
/// what is left of the first one.
std::vector<DistanceMethod> distanceMethods();

}  // namespace test
}  // namespace fcl

#endif
