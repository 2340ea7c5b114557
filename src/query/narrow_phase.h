// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_QUERY_NARROW_PHASE_H
#define FCL_CCD_QUERY_NARROW_PHASE_H

#include <cstddef>
#include <cstdint>

#include "query/distance_stages.h"
#include "query/feature_batch.h"
#include "query/task_findings.h"
#include "query/touching_stages.h"
#include "tree/mesh_instance.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief The narrow phase: from a block of triangle pairs whose boxes overlap to what a
/// task of a query finds. It belongs to one thread.
class NarrowPhase {
 public:
  /// @param a, b  kept by reference; the same object for a self-collision
  /// @param shifts  added to boxes of a, with options.min_distance; kept by reference
  /// @param progress, task, first  as of TaskFindings
  NarrowPhase(const MeshInstance& a, const MeshInstance& b, const BoxShifts& shifts,
              const QueryOptions& options, QueryProgress& progress, std::size_t task = 0,
              FirstBracket* first = nullptr);

  /// @brief Begins a part of the traversal: FeatureBatch::beginTask().
  void beginPart() { batch_.beginTask(); }

  /// @brief Takes pairs of triangles. The limit between two calls of decide() is
  /// FeatureBatch::kMaxPairs.
  /// @param next  the first pair. Becomes `last`, or the pair with the vertex that is not
  /// finite
  /// @throws NonFiniteVertex
  void collect(const LeafPair*& next, const LeafPair* last) {
    batch_.add(next, last, findings_.wanted(), findings_.counts());
  }

  /// @brief Notes an error that collect() has thrown: TaskFindings::refuse().
  void refuse(const NonFiniteVertex& error, float earliest) {
    findings_.refuse(error, earliest);
  }

  /// @brief Decides the pairs of features of the block that was collected.
  void decide();

  /// @brief See TaskFindings.
  bool isDone() const { return findings_.isDone(); }
  double latest() const { return findings_.latest(); }
  bool isTimed() const { return findings_.isTimed(); }

  TaskFindings& findings() { return findings_; }

  /// @brief Adds the counts of a traversal.
  void addTraversal(std::uint64_t compared, std::uint64_t fan_culled) {
    StageCounts& counts = findings_.counts();
    counts.node_pairs += compared;
    counts.triangle_pairs += fan_culled;
    counts.adjacent_pairs += fan_culled;
    counts.fan_culled += fan_culled;
  }

 private:
  void setCullDistance(double cull_distance);

  const BoxShifts& shifts_;
  /// What is added to boxes of a.
  KdopShift shift_;
  FeatureBatch batch_;
  TaskFindings findings_;
  TouchingStages touching_;
  DistanceStages distance_;
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
