// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_QUERY_CROSSING_STAGE_H
#define FCL_CCD_QUERY_CROSSING_STAGE_H

#include "query/feature_batch.h"
#include "query/task_findings.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief Adds the edges of a block that pass through a face of the other triangle at t =
/// 0, as far as the query wants them.
void findCrossings(const FeatureBatch& batch, TaskFindings& findings);

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
