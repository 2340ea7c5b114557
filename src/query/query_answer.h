// SPDX-License-Identifier: BSD-3-Clause
//
// The answer of a query, and how the answers of its tasks become one.
#ifndef FCL_CCD_QUERY_QUERY_ANSWER_H
#define FCL_CCD_QUERY_QUERY_ANSWER_H

#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <vector>

#include "fcl/narrowphase/stage_counts.h"
#include "numerics/moving_vector.h"
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

/// @brief A contact of any kind, or a crossing: what the public type says of it.
struct DescribedContact {
  ContinuousContactKind kind{ContinuousContactKind::kShapes};
  /// ContinuousContact::first_on_o1.
  bool first_on_a{false};
  bool within_tolerance{false};
  /// -1 beyond those of the kind, with a shape or an octree.
  std::int32_t vertices[5]{-1, -1, -1, -1, -1};
  /// Triangles of a and b; -1 for a shape; of a cell its number (OctreeCellNumber).
  std::int64_t triangles[2]{-1, -1};
  double toc_lo{0}, toc_hi{0};
  /// In the world. The normal is that of ContinuousContact::normal; zero: there is none.
  Vec position{0, 0, 0}, normal{0, 0, 0};
  /// ContinuousContact::penetration_depth.
  double depth{0};
};

struct QueryAnswer {
  /// Of two meshes, by features. There may be very many, so that one is described when it
  /// is needed (api/contact_conversion.h).
  SortedContacts contacts;
  /// With a shape or an octree, sorted by (toc_lo, triangles). With only_time they have
  /// times only.
  std::vector<DescribedContact> shape_contacts;
  /// The bracket of the first contact, if there is one; of two meshes the tight one.
  TimeBracket first{1, 1};
  /// With a shape or an octree: when discrete queries find the first contact, if they do
  /// within toc_err: a time in [toc_hi, toc_lo + toc_err]. With a distance, and of two
  /// meshes, it is not after first.hi.
  double pose_time{0};
  bool cut{false};
  /// One, or all of them (QueryOptions::all_crossings).
  std::vector<Crossing> crossings;
  StageCounts counts;
  StageTimes times;

  bool hasContact() const { return !contacts.empty() || !shape_contacts.empty(); }
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
