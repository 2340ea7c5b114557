// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_NARROWPHASE_DETAIL_DEFORMABLE_STAGE_COUNTS_H
#define FCL_NARROWPHASE_DETAIL_DEFORMABLE_STAGE_COUNTS_H

#include <cstdint>

namespace fcl {

/// @brief How many candidates each stage of a continuous query saw and removed, in
/// pipeline order. Every candidate that enters a stage leaves it culled or goes on:
/// feature_pairs = box_culled + filter_culled + solver_culled + exact_culled + contacts.
struct StageCounts {
  /// node pairs whose moving boxes were compared
  std::uint64_t node_pairs{0};
  /// triangle pairs whose boxes meet at some time
  std::uint64_t triangle_pairs{0};
  /// of those, the pairs that share a vertex
  std::uint64_t adjacent_pairs{0};
  /// VF and EE pairs that the triangle pairs own and that share no vertex
  std::uint64_t feature_pairs{0};
  /// feature pairs whose ranges along x, y, z never meet all at once
  std::uint64_t box_culled{0};
  /// feature pairs that provably never become coplanar while their boxes meet
  std::uint64_t filter_culled{0};
  /// feature pairs for which the root solve proved that there is no contact
  std::uint64_t solver_culled{0};
  /// feature pairs that rounding left open for the solver and integers proved apart
  std::uint64_t exact_culled{0};
  /// feature pairs that integers had to decide, either way
  std::uint64_t exact_tests{0};
  /// contacts, each proved
  std::uint64_t contacts{0};
  /// edge-face pairs tested for crossing at t = 0
  std::uint64_t crossing_tests{0};
};

/// @brief Wall time of the parts of a query, in seconds.
struct StageTimes {
  /// bringing the moving boxes up to date, when the query itself had to do it
  double update{0};
  /// moving boxes against moving boxes
  double traverse{0};
  /// everything done to a triangle pair
  double test{0};
};

}  // namespace fcl

#endif
