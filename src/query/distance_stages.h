// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_QUERY_DISTANCE_STAGES_H
#define FCL_CCD_QUERY_DISTANCE_STAGES_H

#include <cstddef>
#include <vector>

#include "kernels/kernels.h"
#include "query/distance_contact.h"
#include "query/feature_batch.h"
#include "query/task_findings.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief The stages that decide which features of a block come within the distance, for
/// runDistanceStages().
class DistanceStages {
 public:
  /// @param batch, findings  kept by reference
  DistanceStages(FeatureBatch& batch, TaskFindings& findings)
      : batch_(batch), findings_(findings) {}

  /// @brief Whether only contacts at t = 0 matter to a block, since an answer at t = 0 is
  /// known: a contact, a crossing or an error.
  bool onlyStartMatters(double latest) const;

  /// @brief Sets the pairs for the stages: those of one kind.
  /// @param latest  TaskFindings::latest() when the block began
  /// @param is_at_start  onlyStartMatters() then
  DistanceStages& of(ContinuousContactKind kind, double latest, bool is_at_start) {
    kind_ = kind;
    latest_ = latest;
    is_at_start_ = is_at_start;
    next_ = left_ = 0;
    return *this;
  }

  void cullByBoxes();
  /// @brief Makes candidates of the next pairs that may come near enough, up to
  /// kMostApproaching.
  /// @return whether there are any
  bool filterDistances();
  /// @brief Decides the candidates.
  void advance();

 private:
  DistanceRequest request() const;
  void filterEight();
  bool isSettled(std::size_t lane, FeatureCandidate& candidate);
  void advanceAlone(const FeatureCandidate& candidate);
  void add(const FeatureCandidate& candidate, const DistanceContact& found);

  const Kernels& kernels_{kernels()};
  FeatureBatch& batch_;
  TaskFindings& findings_;
  const QueryOptions& options_{findings_.options()};
  StageCounts& counts_{findings_.counts()};
  ContinuousContactKind kind_{};
  double latest_{1};
  bool is_at_start_{false};
  /// What the filter looks for.
  DistanceRequest request_;
  /// The first pair that the filter has not seen; of the eight before it those that are
  /// left, a bit each, and at the start their answers.
  std::size_t next_{0};
  unsigned left_{0};
  Approach found_[8];
  std::vector<FeatureCandidate> candidates_;
};

/// @brief The stages of contact at a distance, in their order, as runStages() has those
/// of touching.
inline void runDistanceStages(DistanceStages& pairs) {
  // Boxes, enlarged by the distance. The window is the time in which they overlap.
  pairs.cullByBoxes();
  // Distance filter, eight pairs at a time: a direction along which the features are
  // further apart than the distance at both ends of the window. If only t = 0 matters,
  // the filter decides most pairs.
  while (pairs.filterDistances())
    // Certified steps, many pairs at a time: from a time to one until which they provably
    // stay further apart. What is still open goes through advanceToDistance(), one pair
    // after the other.
    pairs.advance();
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
