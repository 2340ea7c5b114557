// SPDX-License-Identifier: BSD-3-Clause
//
// Input and answer of the stages of the elementary test.
#ifndef FCL_CCD_ELEMENTARY_FEATURE_POINTS_H
#define FCL_CCD_ELEMENTARY_FEATURE_POINTS_H

#include <cstdint>

#include "base/short_vector.h"
#include "fcl/narrowphase/stage_counts.h"
#include "mesh/vertex_frames.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief The four moving points of a pair: v, f0, f1, f2 or ea0, ea1, eb0, eb1.
struct FeaturePoints {
  const VertexPath* point[4];
  const VertexPath& operator[](int i) const { return *point[i]; }
};

/// @brief The ids of the points of a pair. Points of a feature that coincide are in the
/// order of their ids: an edge or a vertex of the feature then has one name.
struct PointIds {
  std::uint32_t id[4]{0, 1, 2, 3};
};

/// The same quantity at t = 0 and at t = 1.
using FramePair = Double2;

enum class Answer { kNo, kYes, kUnsure };

/// @brief The stage that gave the answer.
enum class DecidedBy { kBox, kFilter, kSolver, kExact };

struct ElementaryResult {
  Answer answer;
  /// Bracket of the first time of contact. For kUnsure: of this time, if there is a
  /// contact. No meaning for kNo.
  double toc_lo;
  double toc_hi;
  DecidedBy decided_by;
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
