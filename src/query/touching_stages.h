// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_QUERY_TOUCHING_STAGES_H
#define FCL_CCD_QUERY_TOUCHING_STAGES_H

#include <cstddef>
#include <vector>

#include "kernels/kernels.h"
#include "query/decided_pairs.h"
#include "query/feature_batch.h"
#include "query/task_findings.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief The stages that decide which features of a block touch, for runStages().
class TouchingStages {
 public:
  /// @param batch, findings  kept by reference
  /// @param may_repeat  whether a pair of features may be met more than once
  TouchingStages(FeatureBatch& batch, TaskFindings& findings, bool may_repeat)
      : batch_(batch), findings_(findings), may_repeat_(may_repeat) {}

  /// @brief Sets the pairs for the stages: those of one kind.
  /// @param latest  TaskFindings::latest() when the block began
  TouchingStages& of(ContinuousContactKind kind, double latest) {
    kind_ = kind;
    latest_ = latest;
    return *this;
  }

  void cullByBoxes();
  /// @brief Makes candidates of the pairs that may become coplanar.
  void filterCoplanarity();
  /// @brief Solves all candidates over their whole windows. Keeps those that are no plain
  /// cases.
  void solvePlainCases();
  /// @brief Decides what solvePlainCases() has left. Divides windows in two; the second
  /// part is solved only if there is no contact in the first one.
  void solveRest();

 private:
  /// A candidate and a part of its window.
  struct Piece {
    std::size_t candidate;
    double lo, hi;
  };

  template <typename OnNo, typename OnOpen>
  void solve(const std::vector<Piece>& pieces, OnNo&& on_no, OnOpen&& on_open);
  void divide();
  EightPairs eightOf(const std::vector<Piece>& pieces, std::size_t first) const;
  ElementaryResult decideOnce(const FeatureCandidate& candidate);
  ElementaryResult decide(const FeatureCandidate& candidate, double t_stop) const;
  void solveAlone(const FeatureCandidate& candidate);
  void add(const FeatureCandidate& candidate, const TimeBracket& bracket);

  const Kernels& kernels_{kernels()};
  FeatureBatch& batch_;
  TaskFindings& findings_;
  StageCounts& counts_{findings_.counts()};
  ContinuousContactKind kind_{};
  double latest_{1};
  std::vector<FeatureCandidate> candidates_;
  /// Those to solve next, those that are no plain cases, and the second parts of divided
  /// windows.
  std::vector<Piece> pieces_, open_, second_parts_;
  bool may_repeat_;
  DecidedPairs decided_;
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
