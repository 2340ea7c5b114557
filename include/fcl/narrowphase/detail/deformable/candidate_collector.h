// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_NARROWPHASE_DETAIL_DEFORMABLE_CANDIDATE_COLLECTOR_H
#define FCL_NARROWPHASE_DETAIL_DEFORMABLE_CANDIDATE_COLLECTOR_H

#include <cstddef>
#include <functional>
#include <vector>

#include "fcl/narrowphase/detail/deformable/mesh_instance.h"
#include "fcl/narrowphase/detail/deformable/stage_counts.h"
#include "fcl/narrowphase/detail/deformable/triangle_pair.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief Two features that do not touch outside [window_lo, window_hi].
struct FeatureCandidate : FeatureIds {
  double window_lo;
  double window_hi;
};

/// @brief Takes a block of candidates; false: no more are wanted.
using CandidateSink =
    std::function<bool(const FeatureCandidate* block, std::size_t count)>;

/// @brief Stands in place of TrianglePairTest: what that would test is handed out.
class CandidateCollector {
 public:
  /// @param a, b, sink  kept by reference; the same mesh twice for a self-collision.
  /// @pre both meshes are prepared: otherwise pairs would come repeatedly
  CandidateCollector(const MeshInstance& a, const MeshInstance& b,
                     const CandidateSink& sink)
      : pair_(a, b), sink_(sink) {
    block_.reserve(kBlock);
  }

  /// @brief Collects from triangle i of a and triangle j of b, whose boxes overlap in the
  /// window.
  /// @throws NonFiniteVertex
  void visit(int i, int j, TimeWindow window);

  /// @brief Hands out what is left.
  void finish() {
    if (!stopped_ && !block_.empty()) handOut();
  }

  /// @brief Whether the sink wants no more.
  bool isDone() const { return stopped_; }

  double latest() const { return 1; }
  StageCounts& counts() { return counts_; }

 private:
  /// 48 KiB: a block stays in the cache from here to its reader.
  static constexpr std::size_t kBlock = 1024;

  void handOut() {
    stopped_ = !sink_(block_.data(), block_.size());
    block_.clear();
  }

  TrianglePair pair_;
  const CandidateSink& sink_;
  std::vector<FeatureCandidate> block_;
  bool stopped_{false};
  StageCounts counts_;
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
