// SPDX-License-Identifier: BSD-3-Clause
#include "query/task_findings.h"

#include <cassert>

namespace fcl {
namespace detail {
namespace deformable {

TaskFindings::TaskFindings(const QueryOptions& options, bool may_repeat,
                           QueryProgress& progress, std::size_t task, FirstBracket* first)
    : options_(options),
      sink_(options.query == ContinuousQuery::kAny ? 1 : options.max_contacts,
            may_repeat),
      progress_(progress),
      task_(task),
      first_(first) {
  assert(options.toc_err > 0 && options.max_contacts > 0);
  assert(0 <= options.t_max && options.t_max <= 1);
  assert(options.min_distance >= 0 && options.min_approach_speed >= 0);
  // The approach speed of a contact is decided with the triangles around it.
  assert(!(options.min_approach_speed > 0) || options.surroundings);
}

void TaskFindings::begin(std::size_t task) {
  sink_.clear();
  task_ = task;
  crossings_.clear();
  error_.reset();
  counts_ = {};
}

FeatureBatch::Wanted TaskFindings::wanted() const {
  FeatureBatch::Wanted wanted{latest(), wantsCrossings()};
  if (!(options_.min_distance > 0)) return wanted;
  wanted.last_vertex = std::min(sink_.lastVertexAtStart(),
                                progress_.last_vertex.load(std::memory_order_relaxed));
  return wanted;
}

bool TaskFindings::mayMatter(const FeatureIds& pair, const TimeBracket& bracket) const {
  // Errors that begin after the earliest end of a bracket do not count.
  if (bracket.hi < firstHi()) return true;
  if (options_.only_time)
    return bracket.lo < progress_.first_lo.load(std::memory_order_relaxed);
  return sink_.mayKeep(pair, bracket.lo);
}

/// Whether this contact may be the answer of the query and its bracket is not tight yet.
bool TaskFindings::isLeading(const TimeBracket& bracket) const {
  if (bracket.isTight()) return false;
  // Any contact of this task may be the answer of a kAny query.
  if (options_.query == ContinuousQuery::kAny) return true;
  return options_.query == ContinuousQuery::kFirst && bracket.lo <= firstHi();
}

void TaskFindings::addTouching(const FeatureCandidate& candidate, TimeBracket bracket) {
  assert(bracket.lo <= bracket.hi);
  ++counts_.contacts;
  if (isLeading(bracket))
    bracket = tightened(candidate.kind, CandidatePoints(candidate).get(), bracket);
  if (first_ && first_->wants(bracket))
    first_->add(tightened(candidate.kind, CandidatePoints(candidate).get(), bracket));
  FeatureContact contact{candidate, bracket.lo, bracket.hi};
  if (options_.filter) options_.filter->find(candidate, contact.triangles);
  add(contact);
}

void TaskFindings::add(const FeatureContact& contact) {
  sink_.add(contact);
  QueryProgress::lower(progress_.first_hi, contact.toc_hi);
  QueryProgress::lower(progress_.first_lo, contact.toc_lo);
  if (options_.query == ContinuousQuery::kAll)
    QueryProgress::lower(progress_.latest_kept, sink_.latestKept());
  if (options_.min_distance > 0 && sink_.isCut())
    QueryProgress::lower(progress_.last_vertex, sink_.lastVertexAtStart());
  if (hasAnswer()) QueryProgress::lower(progress_.answered_by, task_);
}

void TaskFindings::add(const Crossing& crossing) {
  crossings_.push_back(crossing);
  QueryProgress::lower(progress_.crossed_by, task_);
  if (!hasAnswer()) return;
  QueryProgress::lower(progress_.answered_by, task_);
  if (options_.only_time) QueryProgress::lower(progress_.first_hi, 0.);
}

void TaskFindings::refuse(const NonFiniteVertex& error, float earliest) {
  assert(earliest >= 0);
  if (error_ && error_->earliest <= earliest) return;
  error_ = QueryError{earliest, error.mesh(), error.vertex()};
  QueryProgress::lower(progress_.first_hi, double{earliest});
  if (hasAnswer()) QueryProgress::lower(progress_.answered_by, task_);
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
