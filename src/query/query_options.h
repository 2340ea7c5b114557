// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_QUERY_QUERY_OPTIONS_H
#define FCL_CCD_QUERY_QUERY_OPTIONS_H

#include <cstddef>

#include "fcl/narrowphase/stage_counts.h"
#include "query/pair_filter.h"

namespace fcl {
namespace detail {
namespace deformable {

class Surroundings;

/// @brief What is asked of a query.
struct QueryOptions {
  ContinuousQuery query{ContinuousQuery::kAll};
  std::size_t max_contacts{static_cast<std::size_t>(-1)};
  double toc_err{1e-4};
  /// Whether only the time of the first contact matters, not the features that meet. A
  /// crossing at t = 0 then answers the query.
  bool only_time{false};
  /// Whether the position and the normal of each contact are wanted.
  bool with_geometry{true};
  /// See parallelFor().
  int num_threads{1};
  /// Whether a self-collision query leaves out embedded regions. The answer does not
  /// depend on it, except for which contact kAny finds.
  bool leaves_out_regions{true};
  /// Later contacts do not count.
  double t_max{1};
  /// Whether the answer has all crossings at t = 0, not only one.
  bool all_crossings{false};
  /// The pairs that count; null: all.
  const PairFilter* filter{nullptr};
  /// Features that come within this distance are in contact; 0: features that touch.
  double min_distance{0};
  /// See DistanceRequest.
  bool ignores_initially_closer{false};
  /// Contacts that approach no faster do not count; 0: all count. See
  /// elementary/approach_speed.h.
  double min_approach_speed{0};
  /// What is around the features; null if it does not matter.
  const Surroundings* surroundings{nullptr};
  /// With a distance: whether a contact is named after the parts of its features that are
  /// nearest, or after the features.
  bool names_parts{true};
  /// With a distance: whether the answer has all pairs of features that may come within
  /// it, for tests on other paths. Their brackets are the times outside of which they
  /// provably do not.
  bool lists_near_pairs{false};

  /// Whether the list may end before the last contact.
  bool isLimited() const { return max_contacts != static_cast<std::size_t>(-1); }
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
