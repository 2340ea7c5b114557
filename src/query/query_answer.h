// SPDX-License-Identifier: BSD-3-Clause
//
// What a query answers, and how the answers of its tasks become one.
#ifndef FCL_CCD_QUERY_QUERY_ANSWER_H
#define FCL_CCD_QUERY_QUERY_ANSWER_H

#include <deque>
#include <functional>
#include <optional>
#include <vector>

#include "query/contact_sink.h"
#include "query/narrow_phase.h"

namespace fcl {
namespace detail {
namespace deformable {

struct QueryAnswer {
  SortedContacts contacts;
  /// The tight bracket of the first contact, if there is one.
  TimeBracket first{1, 1};
  bool cut{false};
  /// One, or all where these are wanted.
  std::vector<Crossing> crossings;
  StageCounts counts;
  StageTimes times;

  bool hasCrossing() const { return !crossings.empty(); }
};

/// @brief The answer of one task of a query.
struct TaskAnswer {
  /// Without a list where there is none, which most tasks of a first contact are.
  std::optional<std::deque<FeatureContact>> contacts;
  bool cut{false};
  std::vector<Crossing> crossings;
  std::optional<QueryError> error;
  StageCounts counts;
  StageTimes times;

  /// @brief Takes all but the times.
  void take(NarrowPhase& leaves);
};

/// @brief The answers of all tasks as one, which does not depend on how the tasks went:
/// the first task that has a crossing tells it, a first-contact query keeps only what may
/// be the first contact, a yes-or-no query only what the first task found. A list of
/// all contacts has their brackets as they were found, so that it does not depend on how
/// many are wanted.
/// @param a, b  the meshes that the contacts are between
/// @param firstContact  asks for the first contact alone; called where it may be among
/// those that were dropped
/// @throws NonFiniteVertex  that the query has to end with, whatever the tasks did in
/// what order: the error of the first task that has an answer or an error; of a
/// first-contact query the earliest error, unless the first contact is earlier than its
/// triangles meet
QueryAnswer merge(std::vector<TaskAnswer>& tasks, const QueryOptions& options,
                  const QueryProgress& progress, const MeshInstance& a,
                  const MeshInstance& b,
                  const std::function<FeatureContact()>& firstContact);

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
