// SPDX-License-Identifier: BSD-3-Clause
//
// How near two bodies come to each other during the step, and when.
//
// A distance D is proved to be kept like the distance of a contact: boxes along
// directions, then steps of the pairs that are left. The distance of a pair at a time is
// an upper bound, and D is this bound less the tolerance. So a better pair lowers D, and
// all that was proved before stays proved.
#ifndef FCL_CCD_CURVED_BODY_APPROACH_H
#define FCL_CCD_CURVED_BODY_APPROACH_H

#include <cmath>
#include <cstdint>
#include <memory>

#include "advance/advancement.h"
#include "bodies/moving_body.h"
#include "query/pair_filter.h"

namespace fcl {
namespace detail {
namespace deformable {

struct ApproachOptions {
  /// The bracket is not wider than the larger one of the first number and of this share
  /// of the distance, as far as rounding allows.
  double abs_err{0}, rel_err{0};
  /// The latest time that matters.
  double t_max{1};
  /// Larger distances do not matter.
  double max_distance{HUGE_VAL};
  /// Whether `time` is to be a float: then distances are taken at such times only.
  /// @pre t_max is one
  bool float_times{false};
  /// Selects the triangle pairs that count; null: all of them.
  const PairRules* rules{nullptr};
};

struct ApproachAnswer {
  /// The least distance of the surfaces is in [lo, hi]. Infinite: no pair counts.
  double lo, hi;
  /// When they come as near as hi, and where: points of a and b in the world.
  double time;
  Vec point[2];
  /// The triangle of a mesh, the number of the cell of an octree; -1: a shape.
  std::int64_t triangle[2];
  /// Whether the search ended since the distance is above the largest one that matters.
  bool is_cut_off;
  AdvanceCounts counts;
};

/// @brief The search for the least distance of two bodies.
///
/// Properties: (1) during [0, t_max] the surfaces are not nearer than `lo`; (2) at `time`
/// they are not further apart than `hi`; (3) hi - lo is at most the tolerance, or 32
/// times the bound on the rounding of a distance; it is more if a pair takes more than
/// kMostSteps steps.
/// @pre the floating-point mode is the default one
/// @throws NonFiniteVertex; fcl::Exception when a vertex id of a triangle is out of range
class BodyApproach {
 public:
  BodyApproach(const MovingBody& a, const MovingBody& b, const ApproachOptions& options);
  ~BodyApproach();

  /// @brief Searches until the answer is known, or until two triangles are nearer than
  /// their size: then it is cheaper to look for a contact first. Called again, it goes on
  /// and does not stop there again.
  /// @return whether the answer is known
  bool search();

  /// @brief The answer. If `lo` is 0, the surfaces may touch.
  ApproachAnswer answer() const;

 private:
  class Search;
  std::unique_ptr<Search> search_;
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
