// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_QUERY_CANDIDATE_COLLECTOR_H
#define FCL_CCD_QUERY_CANDIDATE_COLLECTOR_H

#include <cassert>
#include <cstddef>
#include <functional>
#include <utility>
#include <vector>

#include "fcl/narrowphase/stage_counts.h"
#include "mesh/non_finite_vertex.h"
#include "query/feature_batch.h"
#include "tree/mesh_instance.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief Takes a block of candidates. Returns false if it wants no more.
using FeatureCandidateSink =
    std::function<bool(const FeatureCandidate* block, std::size_t count)>;

/// @brief Whether pairs of features of two triangles are wanted. Empty: of all.
using TrianglePairTest =
    std::function<bool(const TreeTriangle& a, const TreeTriangle& b)>;

/// @brief Takes the place of NarrowPhase in a query for candidates: it hands them to the
/// caller and does not test them.
class CandidateCollector {
 public:
  /// @param a, b, sink  kept by reference; a and b are the same object for a
  /// self-collision
  /// @param cull_distance  as of FeatureBatch
  /// @param is_wanted  asked for each block, so that its answer may change
  /// @pre both meshes have owners; otherwise the sink would get pairs repeatedly
  CandidateCollector(const MeshInstance& a, const MeshInstance& b, const KdopShift* shift,
                     const FeatureCandidateSink& sink, double cull_distance,
                     TrianglePairTest is_wanted)
      : batch_(a, b, shift, kernels(), cull_distance),
        sink_(sink),
        is_wanted_(std::move(is_wanted)) {
    assert(a.hasOwners() && b.hasOwners());
  }

  /// @brief Begins a part of the traversal: FeatureBatch::beginTask().
  void beginPart() { batch_.beginTask(); }

  /// @brief Takes pairs of triangles. The limit between two calls of decide() is
  /// FeatureBatch::kMaxPairs.
  /// @param next  the first pair. Becomes `last`, or the pair with the vertex that is not
  /// finite
  /// @throws NonFiniteVertex
  void collect(const LeafPair*& next, const LeafPair* last) {
    batch_.add(next, last, {latest(), false}, counts_);
  }

  /// @brief Ends the query with the error that collect() has thrown, since the query
  /// needs all candidates.
  [[noreturn]] void refuse(const NonFiniteVertex& error, float) { throw error; }

  /// @brief Hands the candidates of the block to the sink, which decides them.
  void decide() {
    if (is_wanted_) batch_.keepTriangles(is_wanted_);
    batch_.cullTriangles(latest(), counts_);
    block_.clear();
    for (const ContinuousContactKind kind :
         {ContinuousContactKind::kVertexFace, ContinuousContactKind::kEdgeEdge}) {
      batch_.cull(kind, latest(), counts_);
      for (std::size_t i = 0; i < batch_.size(kind); ++i) {
        block_.emplace_back();
        batch_.setCandidate(batch_.codes(kind)[i], batch_.windows(kind)[i],
                            block_.back());
      }
    }
    batch_.clear();
    if (!block_.empty() && !stopped_) stopped_ = !sink_(block_.data(), block_.size());
  }

  /// @brief Whether the sink wants no more.
  bool isDone() const { return stopped_; }

  double latest() const { return 1; }
  bool isTimed() const { return false; }
  void addTraversal(std::uint64_t, std::uint64_t) {}

 private:
  FeatureBatch batch_;
  const FeatureCandidateSink& sink_;
  const TrianglePairTest is_wanted_;
  std::vector<FeatureCandidate> block_;
  bool stopped_{false};
  StageCounts counts_;
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
