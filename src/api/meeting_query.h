// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_API_MEETING_QUERY_H
#define FCL_CCD_API_MEETING_QUERY_H

#include <string>

#include "broadphase/broad_phase.h"
#include "fcl/broadphase/swept_collision_object.h"
#include "prepare/query_arguments.h"

namespace fcl {
namespace detail {

/// @brief The settings of a query, checked.
/// @throws fcl::Exception  a distance is negative or not finite, a time not in [0, 1]
inline deformable::MeetingQuery meetingQueryOf(const BroadPhaseSettings& settings) {
  requireDistance(settings.distance, "request.min_distance");
  requireTimeLimit(settings.t_max, "request.t_max");
  deformable::MeetingQuery query;
  query.distance = settings.distance;
  query.latest = settings.t_max;
  query.with_self = settings.with_self;
  return query;
}

}  // namespace detail
}  // namespace fcl

#endif
