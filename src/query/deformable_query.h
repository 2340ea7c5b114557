// SPDX-License-Identifier: BSD-3-Clause
//
// The queries of two meshes, or of one with itself: their tasks, and in what order work
// is done. Every task does the same for its part of the traversal: boxes against boxes
// (Traversal), and block by block what is done to the triangle pairs that are left
// (NarrowPhase, CandidateCollector). What the tasks find becomes one answer in merge().
#ifndef FCL_CCD_QUERY_DEFORMABLE_QUERY_H
#define FCL_CCD_QUERY_DEFORMABLE_QUERY_H

#include "query/candidate_collector.h"
#include "query/narrow_phase.h"
#include "query/query_answer.h"
#include "tree/mesh_instance.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief Traverses the tree of a with itself and tests what it finds.
QueryAnswer querySelf(const MeshInstance& a, const QueryOptions& options);

/// @brief Traverses the trees of a and b and tests what it finds.
QueryAnswer queryPair(const MeshInstance& a, const MeshInstance& b,
                      const QueryOptions& options);

/// @brief Traverses the tree of a with itself and hands the candidates to the sink.
/// @pre a has owners
/// @return whether the sink took them all
bool candidatesSelf(const MeshInstance& a, const CandidateSink& sink);

/// @brief Traverses the trees of a and b and hands the candidates to the sink.
/// @pre a and b have owners
/// @return whether the sink took them all
bool candidatesPair(const MeshInstance& a, const MeshInstance& b,
                    const CandidateSink& sink);

/// @brief What overlapWindow() needs between the trees of two instances.
KdopShift relativeShift(const MeshInstance& a, const MeshInstance& b);

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
