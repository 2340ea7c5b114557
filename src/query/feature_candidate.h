// SPDX-License-Identifier: BSD-3-Clause
//
// The pairs of features that are tested: their names and their points.
#ifndef FCL_CCD_QUERY_FEATURE_CANDIDATE_H
#define FCL_CCD_QUERY_FEATURE_CANDIDATE_H

#include <algorithm>
#include <cstdint>

#include "elementary/feature_points.h"
#include "kernels/kernels.h"
#include "mesh/feature_pairs.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief Two features and their window: outside of [window_lo, window_hi] they do not
/// touch.
struct FeatureCandidate : FeatureIds {
  double window_lo;
  double window_hi;
  /// The vertices, in the order of the ids; the last one repeated where there are fewer.
  /// Valid until FeatureBatch::clear().
  const TreeVertex* x[4];
};

/// @brief The points of a candidate in the form that tests of single pairs need.
class CandidatePoints {
 public:
  explicit CandidatePoints(const FeatureCandidate& candidate) {
    for (int i = 0; i < 4; ++i) {
      std::copy(candidate.x[i]->t0, candidate.x[i]->t0 + 3, path_[i].t0);
      std::copy(candidate.x[i]->t1, candidate.x[i]->t1 + 3, path_[i].t1);
    }
  }
  FeaturePoints get() const { return {{&path_[0], &path_[1], &path_[2], &path_[3]}}; }

 private:
  VertexPath path_[4];
};

/// @brief Sets the candidate of a pair of features of two triangles. It is the same
/// whichever triangles the pair is found in: the ids of an edge are in ascending order,
/// and so are the two edges of an EE pair in a self-collision. The points follow the ids.
/// In a self-collision the vertex of a VF pair always belongs to mesh a.
/// @param bit  of feature_pairs.h
void setCandidate(const TrianglePair& triangles, std::uint32_t bit,
                  const TimeWindow& window, bool is_self, FeatureCandidate& out);

/// @brief The exchanges (exchangedNumbers()) that put the points of a candidate in the
/// order in which these put the points of the pair (kFeaturePoints).
std::uint8_t exchangesOf(const TrianglePair& triangles, std::uint32_t bit,
                         const FeatureCandidate& candidate, std::uint8_t exchanges);

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
