// SPDX-License-Identifier: BSD-3-Clause
//
// The queries of two meshes, or of a mesh with itself. A query divides the traversal of
// the trees into tasks. A task compares boxes (Traversal). The triangle pairs whose boxes
// overlap go block by block into the narrow phase (NarrowPhase), or into
// CandidateCollector if the query asks for candidates. merge() makes one answer of the
// answers of the tasks.
#ifndef FCL_CCD_QUERY_DEFORMABLE_QUERY_H
#define FCL_CCD_QUERY_DEFORMABLE_QUERY_H

#include "query/candidate_collector.h"
#include "query/query_answer.h"
#include "query/query_options.h"
#include "tree/mesh_instance.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief The contacts of mesh a with itself.
QueryAnswer querySelf(const MeshInstance& a, const QueryOptions& options);

/// @brief The contacts of meshes a and b.
QueryAnswer queryPair(const MeshInstance& a, const MeshInstance& b,
                      const QueryOptions& options);

/// @brief Hands the candidates of mesh a with itself to the sink.
/// @param min_distance  candidates are pairs that may come within this distance; 0: pairs
/// that may touch
/// @pre a has owners
/// @return whether the sink took them all
bool candidatesSelf(const MeshInstance& a, const FeatureCandidateSink& sink,
                    double min_distance = 0);

/// @brief Hands the candidates of meshes a and b to the sink.
/// @pre a and b have owners
/// @return whether the sink took them all
bool candidatesPair(const MeshInstance& a, const MeshInstance& b,
                    const FeatureCandidateSink& sink, double min_distance = 0);

/// @brief Hands the pairs that may be within a distance at t = 1 to the sink, with some
/// others. The windows of the former end at 1.
/// @param a, b  the same object for a mesh with itself
/// @param sink  takes all
/// @param distance  above 0
/// @param is_wanted  triangles for which it is false are left out
/// @pre a and b have owners
void candidatesAtEnd(const MeshInstance& a, const MeshInstance& b,
                     const FeatureCandidateSink& sink, double distance,
                     const TrianglePairTest& is_wanted);

/// @brief The shift between the boxes of two meshes, which may have different origins and
/// translations. overlapWindow() adds it.
KdopShift relativeShift(const MeshInstance& a, const MeshInstance& b);

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
