// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_QUERY_NARROW_PHASE_H
#define FCL_CCD_QUERY_NARROW_PHASE_H

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "fcl/narrowphase/stage_counts.h"
#include "mesh/non_finite_vertex.h"
#include "query/contact_sink.h"
#include "query/crossing.h"
#include "query/decided_pairs.h"
#include "query/distance_contact.h"
#include "query/feature_batch.h"
#include "query/leading_contact.h"
#include "query/query_options.h"
#include "query/query_progress.h"
#include "tree/mesh_instance.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief The narrow phase: from a block of triangle pairs whose boxes overlap to
/// contacts in the sink. It tests for crossings at t = 0, and takes the pairs of features
/// through runStages(), eight at a time. It holds the state of one query in one thread.
class NarrowPhase {
 public:
  /// @param a, b  kept by reference; the same object for a self-collision
  /// @param shifts  added to boxes of a, with options.min_distance; kept by reference
  /// @param progress  of the query; null if the query has no other tasks
  /// @param task  the number of this task
  NarrowPhase(const MeshInstance& a, const MeshInstance& b, const BoxShifts& shifts,
              const QueryOptions& options, QueryProgress* progress = nullptr,
              std::size_t task = 0);

  /// @brief Forgets what was found and begins another task of the same query.
  /// @param task  the number of that task
  void begin(std::size_t task);

  /// @brief Begins a part of the traversal: FeatureBatch::beginTask().
  void beginPart() { batch_.beginTask(); }

  /// @brief Takes pairs of triangles. The limit between two calls of flush() is
  /// FeatureBatch::kMaxPairs.
  /// @param next  the first pair. Becomes `last`, or the pair with the vertex that is not
  /// finite
  /// @throws NonFiniteVertex
  void visit(const LeafPair*& next, const LeafPair* last) {
    batch_.add(next, last, wanted(), counts_);
  }

  /// @brief Notes an error that visit() has thrown for a pair, and leaves the pair out.
  /// Whether the query fails is known when all tasks have ended, since another task may
  /// have an answer that comes before the error.
  void refuse(const NonFiniteVertex& error, float earliest);

  /// @brief The error with the lowest `earliest`; of several the one that was noted
  /// first.
  const std::optional<QueryError>& error() const { return error_; }

  /// @brief Tests the pairs that visit() has taken.
  void flush();

  /// @brief Whether nothing more can change the answer.
  bool isDone() const {
    return hasAnswer() ||
           (progress_ && progress_->answered_by.load(std::memory_order_relaxed) < task_);
  }

  /// @brief A pair whose window starts after this time cannot change the answer.
  double latest() const {
    if (options_.query == ContinuousQuery::kAny) return options_.t_max;
    // A contact is at most `width` after the beginning of its bracket.
    const double width = options_.toc_err + kTimeRounding;
    double latest = latestKept() + width;
    if (options_.query == ContinuousQuery::kFirst) {
      const double first_hi = firstHi();
      latest = std::min(latest, std::min(first_hi + width, latestLeading(first_hi)));
    }
    return std::min(latest, options_.t_max);
  }

  /// @brief Whether it matters when boxes begin to overlap.
  bool isTimed() const { return options_.t_max < 1 || mayEndBefore(); }

  bool hasCrossing() const { return !crossings_.empty(); }
  /// @brief The first crossing that was found, or all of them
  /// (QueryOptions::all_crossings). A crossing of a mesh without owners may be there
  /// several times.
  const std::vector<Crossing>& crossings() const { return crossings_; }
  /// @brief The tight bracket of the first contact that was found.
  /// @pre there is a contact, and the query has no other tasks
  TimeBracket firstBracket() const { return first_.get(); }
  ContactSink& sink() { return sink_; }
  const ContactSink& sink() const { return sink_; }
  const StageCounts& counts() const { return counts_; }
  StageCounts& counts() { return counts_; }

  /// @brief Adds the counts of a traversal.
  void addTraversal(std::uint64_t compared, std::uint64_t fan_culled) {
    counts_.node_pairs += compared;
    counts_.triangle_pairs += fan_culled;
    counts_.adjacent_pairs += fan_culled;
    counts_.fan_culled += fan_culled;
  }

 private:
  /// A bracket is wider than toc_err by less than this: by a few units in the last place
  /// of 1.
  static constexpr double kTimeRounding = 0x1p-40;

  bool hasAnswer() const {
    if (hasCrossing() && options_.only_time) return true;
    // No contact is earlier than t = 0.
    if (error_ && (!mayEndBefore() || error_->earliest <= 0.f)) return true;
    return options_.query == ContinuousQuery::kAny &&
           (!sink_.contacts().empty() || hasCrossing());
  }
  /// Whether an error may come too late to matter, see merge().
  bool mayEndBefore() const {
    return options_.query == ContinuousQuery::kFirst ||
           (options_.query == ContinuousQuery::kAll && options_.isLimited());
  }
  FeatureBatch::Wanted wanted() const;
  bool wantsCrossings() const {
    if (options_.all_crossings) return true;
    return !hasCrossing() &&
           !(progress_ && progress_->crossed_by.load(std::memory_order_relaxed) < task_);
  }
  /// The earliest upper end of a bracket, of all tasks.
  double firstHi() const {
    const double mine = sink_.firstHi();
    return progress_ ? std::min(mine, progress_->first_hi.load(std::memory_order_relaxed))
                     : mine;
  }
  /// What begins later is dropped.
  double latestKept() const {
    const double mine = sink_.latestKept();
    return progress_
               ? std::min(mine, progress_->latest_kept.load(std::memory_order_relaxed))
               : mine;
  }
  /// A candidate and a part of its window.
  struct Piece {
    std::size_t candidate;
    double lo, hi;
  };

  void testCrossings();
  void testCrossing(std::size_t i);
  Crossing crossingAt(std::size_t i) const;
  bool accept(Crossing& crossing) const;
  struct BlockPairs;
  void filterCoplanarity(ContinuousContactKind kind);
  void solvePlainCases();
  void solveRest();
  template <typename OnNo, typename OnOpen>
  void divide(OnNo&& on_no, OnOpen&& on_open);
  template <typename OnNo, typename OnOpen>
  void solve(const std::vector<Piece>& pieces, OnNo&& on_no, OnOpen&& on_open);
  EightPairs eightOf(const std::vector<Piece>& pieces, std::size_t first) const;
  ElementaryResult decide(const FeatureCandidate& candidate, double t_stop) const;
  bool mayMatter(const FeatureIds& pair, const TimeBracket& bracket) const;
  ElementaryResult decideCoarsely(const FeatureCandidate& candidate, double t_stop,
                                  double apart) const;
  ElementaryResult decideOnce(const FeatureCandidate& candidate);
  void solve(const FeatureCandidate& candidate);
  void add(const FeatureCandidate& candidate, TimeBracket bracket);
  void testDistances(ContinuousContactKind kind);
  bool onlyStartMatters(double latest) const;
  void testDistancesAtStart(ContinuousContactKind kind);
  DistanceRequest distanceRequest() const;
  void testManyDistances();
  void testDistance(const FeatureCandidate& candidate);
  void addNear(const FeatureCandidate& candidate, const DistanceContact& found);
  void add(const FeatureContact& contact);
  bool isLeading(const TimeBracket& bracket) const;

  void setReach(double reach);

  QueryOptions options_;
  const Kernels& kernels_;
  const BoxShifts& shifts_;
  /// Features further apart at t = 0 do not matter, and what is added to boxes.
  double reach_;
  KdopShift shift_;
  FeatureBatch batch_;
  /// The candidates of one kind that may become coplanar.
  std::vector<FeatureCandidate> candidates_;
  /// Parts of windows: those to solve next, those that are no plain cases, and the second
  /// parts of divided windows.
  std::vector<Piece> pieces_, open_, second_parts_;
  /// Whether a pair of features may be met more than once.
  bool may_repeat_;
  DecidedPairs decided_;
  ContactSink sink_;
  FirstBracket first_;
  QueryProgress* progress_;
  std::size_t task_;
  std::vector<Crossing> crossings_;
  std::optional<QueryError> error_;
  StageCounts counts_;
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
