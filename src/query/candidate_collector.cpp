// SPDX-License-Identifier: BSD-3-Clause
#include "query/candidate_collector.h"

namespace fcl {
namespace detail {
namespace deformable {

void CandidateCollector::flush() {
  if (is_wanted_) batch_.keepTriangles(is_wanted_);
  batch_.cullTriangles(latest(), counts_);
  block_.clear();
  for (const ContinuousContactKind kind :
       {ContinuousContactKind::kVertexFace, ContinuousContactKind::kEdgeEdge}) {
    batch_.cull(kind, latest(), counts_);
    for (std::size_t i = 0; i < batch_.size(kind); ++i) {
      block_.emplace_back();
      batch_.setCandidate(batch_.codes(kind)[i], batch_.windows(kind)[i], block_.back());
    }
  }
  batch_.clear();
  if (!block_.empty() && !stopped_) stopped_ = !sink_(block_.data(), block_.size());
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
