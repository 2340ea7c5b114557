// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_QUERY_TASK_FINDINGS_H
#define FCL_CCD_QUERY_TASK_FINDINGS_H

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "fcl/narrowphase/stage_counts.h"
#include "mesh/non_finite_vertex.h"
#include "query/contact_sink.h"
#include "query/crossing.h"
#include "query/feature_batch.h"
#include "query/leading_contact.h"
#include "query/query_options.h"
#include "query/query_progress.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief What a task of a query has found, and what can still change the answer of the
/// query. Whatever is found, here or in other tasks (QueryProgress), leaves less to look
/// for.
class TaskFindings {
 public:
  /// @param may_repeat  as of ContactSink
  /// @param progress  of the query; kept by reference
  /// @param task  the number of this task
  /// @param first  gets the tight bracket of the first contact, even if the list drops
  /// it; null: nobody asks for it here
  TaskFindings(const QueryOptions& options, bool may_repeat, QueryProgress& progress,
               std::size_t task, FirstBracket* first);

  /// @brief Forgets what was found and begins another task of the same query.
  void begin(std::size_t task);

  const QueryOptions& options() const { return options_; }

  /// @brief Whether nothing more can change the answer.
  bool isDone() const {
    return hasAnswer() || progress_.answered_by.load(std::memory_order_relaxed) < task_;
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

  /// @brief Whether the traversal has to tell when boxes begin to overlap: contacts or
  /// errors after some time do not count.
  bool isTimed() const { return options_.t_max < 1 || mayEndBeforeError(); }

  /// @brief What triangle pairs are still looked at for.
  FeatureBatch::Wanted wanted() const;
  bool wantsCrossings() const {
    if (options_.all_crossings) return true;
    return !hasCrossing() &&
           !(progress_.crossed_by.load(std::memory_order_relaxed) < task_);
  }

  /// @brief The earliest upper end of a bracket, of all tasks; 1 without contacts.
  double firstHi() const {
    return std::min(sink_.firstHi(), progress_.first_hi.load(std::memory_order_relaxed));
  }

  /// @brief Whether a contact of the pair may change the answer, if its bracket is this
  /// one or a later one.
  bool mayMatter(const FeatureIds& pair, const TimeBracket& bracket) const;

  /// @brief Adds a contact of features that touch. Its bracket is made tight if it may be
  /// the answer.
  void addTouching(const FeatureCandidate& candidate, TimeBracket bracket);
  void add(const FeatureContact& contact);
  void add(const Crossing& crossing);

  /// @brief Notes the error of a triangle pair that is left out. Whether the query fails
  /// is known when all tasks have ended, since another task may have an answer that comes
  /// before the error.
  /// @param earliest  when the boxes of the triangles begin to overlap
  void refuse(const NonFiniteVertex& error, float earliest);

  /// @brief The error with the lowest `earliest`; of several the one that was noted
  /// first.
  const std::optional<QueryError>& error() const { return error_; }
  bool hasCrossing() const { return !crossings_.empty(); }
  /// @brief The first crossing that was found, or all of them
  /// (QueryOptions::all_crossings). A crossing of a mesh without owners may be there
  /// several times.
  const std::vector<Crossing>& crossings() const { return crossings_; }
  ContactSink& sink() { return sink_; }
  StageCounts& counts() { return counts_; }

 private:
  /// A bracket is wider than toc_err by less than this: by a few units in the last place
  /// of 1.
  static constexpr double kTimeRounding = 0x1p-40;

  bool hasAnswer() const {
    if (hasCrossing() && options_.only_time) return true;
    // No contact is earlier than t = 0.
    if (error_ && (!mayEndBeforeError() || error_->earliest <= 0.f)) return true;
    return options_.query == ContinuousQuery::kAny &&
           (!sink_.contacts().empty() || hasCrossing());
  }
  /// Whether the answer may be complete at a time before that of an error, which then
  /// does not count: merge().
  bool mayEndBeforeError() const {
    return options_.query == ContinuousQuery::kFirst ||
           (options_.query == ContinuousQuery::kAll && options_.isLimited());
  }
  /// What begins later is dropped.
  double latestKept() const {
    return std::min(sink_.latestKept(),
                    progress_.latest_kept.load(std::memory_order_relaxed));
  }
  bool isLeading(const TimeBracket& bracket) const;

  const QueryOptions options_;
  ContactSink sink_;
  QueryProgress& progress_;
  std::size_t task_;
  FirstBracket* first_;
  std::vector<Crossing> crossings_;
  std::optional<QueryError> error_;
  StageCounts counts_;
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
