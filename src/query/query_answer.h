// SPDX-License-Identifier: BSD-3-Clause
//
// The answer of a query, and how the answers of its tasks become one.
#ifndef FCL_CCD_QUERY_QUERY_ANSWER_H
#define FCL_CCD_QUERY_QUERY_ANSWER_H

#include <deque>
#include <functional>
#include <optional>
#include <vector>

#include "fcl/narrowphase/stage_counts.h"
#include "query/contact_sink.h"
#include "query/crossing.h"
#include "query/leading_contact.h"
#include "query/query_options.h"
#include "query/query_progress.h"
#include "tree/mesh_instance.h"

namespace fcl {
namespace detail {
namespace deformable {

class TaskFindings;

struct QueryAnswer {
  SortedContacts contacts;
  /// The tight bracket of the first contact, if there is one.
  TimeBracket first{1, 1};
  bool cut{false};
  /// One, or all of them (QueryOptions::all_crossings).
  std::vector<Crossing> crossings;
  StageCounts counts;
  StageTimes times;

  bool hasCrossing() const { return !crossings.empty(); }
};

/// @brief The answer of one task of a query.
struct TaskAnswer {
  /// Empty without contacts, as for most tasks of a first-contact query.
  std::optional<std::deque<FeatureContact>> contacts;
  bool cut{false};
  std::vector<Crossing> crossings;
  std::optional<QueryError> error;
  StageCounts counts;
  StageTimes times;

  /// @brief Takes everything except the times.
  void take(TaskFindings& findings);
};

/// @brief Makes one answer of the answers of all tasks. It does not depend on the order
/// in which the tasks ran. The crossing is that of the first task that has one. A kFirst
/// query keeps the contacts that may be the first, a kAny query what the first task has
/// found. A kAll query keeps the brackets as they were found, so that they do not depend
/// on max_contacts.
/// @param a, b  the meshes of the contacts
/// @param firstContact  a query for the first contact alone; called if that may be among
/// the contacts that were dropped
/// @throws NonFiniteVertex  if an error decides the query. For kFirst this is the
/// earliest error, unless the first contact is before it. For kAll with max_contacts it
/// is the earliest error, unless the first contact and the last one that is kept are
/// before it. For other queries it is the error of the first task that has an answer or
/// an error.
QueryAnswer merge(std::vector<TaskAnswer>& tasks, const QueryOptions& options,
                  const QueryProgress& progress, const MeshInstance& a,
                  const MeshInstance& b,
                  const std::function<FeatureContact()>& firstContact);

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
