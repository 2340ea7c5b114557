// SPDX-License-Identifier: BSD-3-Clause
#include "fcl/narrowphase/detail/deformable/candidate_collector.h"

namespace fcl {
namespace detail {
namespace deformable {

void CandidateCollector::visit(int i, int j, TimeWindow window) {
  pair_.load(i, j);
  ++counts_.triangle_pairs;
  pair_.forEachCandidate(window, counts_,
                         [this](const FeaturePair& pair, double lo, double hi) {
                           FeaturePoints points = pair_.pointsOf(pair);
                           block_.push_back({pair_.describe(pair, points), lo, hi});
                         });
  if (block_.size() + TrianglePair::kMaxCandidates > kBlock) handOut();
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
