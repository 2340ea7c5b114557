// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_QUERY_CANDIDATE_COLLECTOR_H
#define FCL_CCD_QUERY_CANDIDATE_COLLECTOR_H

#include <cassert>
#include <cstddef>
#include <functional>
#include <vector>

#include "fcl/narrowphase/stage_counts.h"
#include "query/feature_batch.h"
#include "tree/mesh_instance.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief Takes a block of candidates; false: no more are wanted.
using CandidateSink =
    std::function<bool(const FeatureCandidate* block, std::size_t count)>;

/// @brief Stands in place of NarrowPhase: what that would test is handed out.
class CandidateCollector {
 public:
  /// @param a, b, sink  kept by reference; the same mesh twice for a self-collision.
  /// @pre both meshes have owners: otherwise pairs would come repeatedly
  CandidateCollector(const MeshInstance& a, const MeshInstance& b, const KdopShift* shift,
                     const CandidateSink& sink)
      : batch_(a, b, shift, kernels()), sink_(sink) {
    assert(a.hasOwners() && b.hasOwners());
  }

  /// @brief Takes pairs of triangles; between two calls of flush() at most
  /// FeatureBatch::kMaxPairs.
  /// @param next  the first of them; after an error the one that it is about, and in the
  /// end `last`
  /// @throws NonFiniteVertex
  void visit(const LeafPair*& next, const LeafPair* last) {
    batch_.add(next, last, latest(), false, counts_);
  }

  /// @brief What visit() threw ends the query: all candidates are wanted.
  [[noreturn]] void refuse(const NonFiniteVertex& error, float) { throw error; }

  /// @brief Hands out what is there.
  void flush();

  /// @brief Whether the sink wants no more.
  bool isDone() const { return stopped_; }

  double latest() const { return 1; }
  void addTraversal(std::uint64_t, std::uint64_t) {}

 private:
  FeatureBatch batch_;
  const CandidateSink& sink_;
  std::vector<FeatureCandidate> block_;
  bool stopped_{false};
  StageCounts counts_;
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
