// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_NARROWPHASE_DETAIL_DEFORMABLE_TRIANGLE_PAIR_H
#define FCL_NARROWPHASE_DETAIL_DEFORMABLE_TRIANGLE_PAIR_H

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <stdexcept>

#include "fcl/math/bv/moving_kdop.h"
#include "fcl/narrowphase/detail/deformable/feature_pairs.h"
#include "fcl/narrowphase/detail/deformable/mesh_instance.h"
#include "fcl/narrowphase/detail/deformable/stage_counts.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief Names a vertex whose coordinates are not finite.
class NonFiniteVertex : public std::domain_error {
 public:
  explicit NonFiniteVertex(std::size_t vertex);
};

/// @brief A triangle's vertices with the ranges of its features.
struct TriangleSide {
  std::int32_t index{-1};
  MeshTriangle triangle;
  VertexPath x[3];
  AxisRanges vertex[3];
  AxisRanges edge[3];
  AxisRanges face;

  /// @brief Reads triangle i of the mesh, unless it is there already.
  /// @throws NonFiniteVertex
  void load(const MeshInstance& mesh, int i) {
    if (index != i) read(mesh, i);
  }

 private:
  void read(const MeshInstance& mesh, int i);
};

/// @brief Two triangles and their candidates: the pairs of features that they own and
/// whose coordinate ranges meet at some time.
class TrianglePair {
 public:
  /// @brief A triangle pair owns at most so many: 2 x 3 VF and 3 x 3 EE.
  static constexpr std::size_t kMaxCandidates = 15;

  /// @param a, b  kept by reference; the same object twice for a self-collision.
  TrianglePair(const MeshInstance& a, const MeshInstance& b)
      : a_(a), b_(b), self_(&a == &b) {}

  /// @brief Takes triangle i of a and triangle j of b.
  /// @throws NonFiniteVertex
  void load(int i, int j) {
    side_a_.load(a_, i);
    side_b_.load(b_, j);
  }

  bool isSelf() const { return self_; }
  const TriangleSide& sideA() const { return side_a_; }
  const TriangleSide& sideB() const { return side_b_; }

  /// @brief Calls visit(const FeaturePair&, lo, hi) for each candidate; the features do
  /// not touch outside [lo, hi].
  /// @param window  outside of which the triangles do not touch
  /// @param counts  adjacent_pairs, feature_pairs and box_culled are counted
  template <typename Visit>
  void forEachCandidate(TimeWindow window, StageCounts& counts, Visit&& visit) const {
    if (self_)
      visitCandidates<true>(window, counts, visit);
    else
      visitCandidates<false>(window, counts, visit);
  }

  FeaturePoints pointsOf(const FeaturePair& pair) const {
    if (pair.kind == FeatureKind::kVertexFace) {
      const TriangleSide &vertex = pair.first_on_a ? side_a_ : side_b_,
                         &face = pair.first_on_a ? side_b_ : side_a_;
      return {{&vertex.x[pair.first], &face.x[0], &face.x[1], &face.x[2]}};
    }
    return {{&side_a_.x[pair.first], &side_a_.x[(pair.first + 1) % 3],
             &side_b_.x[pair.second], &side_b_.x[(pair.second + 1) % 3]}};
  }

  /// @brief The pair's one name, whatever triangles it is met in. Edges have their ids in
  /// ascending order (edges of two meshes stay on their sides) and `points`, which come
  /// from pointsOf(pair), are brought into the order of the ids: one name, one
  /// evaluation. In a self-collision the vertex of a VF pair is always mesh a's.
  FeatureIds describe(const FeaturePair& pair, FeaturePoints& points) const;

 private:
  template <bool kSelf, typename Visit>
  void visitCandidates(TimeWindow window, StageCounts& counts, Visit& visit) const {
    const double lo = std::max(0., window.lo - kWindowMargin),
                 hi = std::min(1., window.hi + kWindowMargin);
    const MeshTriangle &a = side_a_.triangle, &b = side_b_.triangle;
    if (kSelf && (hasVertex(b, a.v[0]) || hasVertex(b, a.v[1]) || hasVertex(b, a.v[2])))
      ++counts.adjacent_pairs;
    forEachFeaturePair<kSelf>(a, b, [&](const FeaturePair& pair) {
      ++counts.feature_pairs;
      const bool ee = pair.kind == FeatureKind::kEdgeEdge;
      const AxisRanges& ranges_a = ee                ? side_a_.edge[pair.first]
                                   : pair.first_on_a ? side_a_.vertex[pair.first]
                                                     : side_a_.face;
      const AxisRanges& ranges_b = ee                ? side_b_.edge[pair.second]
                                   : pair.first_on_a ? side_b_.face
                                                     : side_b_.vertex[pair.first];
      double pair_lo = lo, pair_hi = hi;
      if (!narrowWindow(ranges_a, ranges_b, pair_lo, pair_hi))
        ++counts.box_culled;
      else
        visit(pair, pair_lo, pair_hi);
    });
  }

  const MeshInstance& a_;
  const MeshInstance& b_;
  bool self_;
  TriangleSide side_a_, side_b_;
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
