// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_NARROWPHASE_DETAIL_DEFORMABLE_FEATURE_PAIRS_H
#define FCL_NARROWPHASE_DETAIL_DEFORMABLE_FEATURE_PAIRS_H

#include <cstdint>

#include "fcl/narrowphase/detail/deformable/elementary_test.h"
#include "fcl/narrowphase/detail/deformable/mesh_topology.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief One feature of each of two triangles, by places in the triangles: VF, vertex
/// `first` of one and the whole other; EE, edge `first` of a and edge `second` of b.
struct FeaturePair {
  FeatureKind kind;
  /// VF: the vertex is a's.
  bool first_on_a;
  unsigned first;
  unsigned second;
};

/// @brief Two features of two meshes a and b, by ids.
struct FeatureIds {
  FeatureKind kind;
  /// VF: the vertex belongs to mesh a and the face to mesh b, not the other way round.
  bool first_on_a;
  /// VF: v, f0, f1, f2. EE: ea0, ea1, eb0, eb1.
  std::uint32_t vertices[4];
  /// Triangle of mesh a and of mesh b.
  std::int32_t triangles[2];
};

inline bool hasVertex(const MeshTriangle& t, std::uint32_t v) {
  return t.v[0] == v || t.v[1] == v || t.v[2] == v;
}

/// @brief Calls visit(FeaturePair) for each pair of features that triangles a and b own;
/// over all triangle pairs of a scene that is every VF and EE pair once.
/// @tparam kSelf  a and b index the same vertices: pairs that share one are left out.
template <bool kSelf, typename Visit>
void forEachFeaturePair(const MeshTriangle& a, const MeshTriangle& b, Visit&& visit) {
  if (b.ownsFace())
    for (unsigned k = 0; k < 3; ++k)
      if (a.ownsVertex(k) && !(kSelf && hasVertex(b, a.v[k])))
        visit(FeaturePair{FeatureKind::kVertexFace, true, k, 0});
  if (a.ownsFace())
    for (unsigned k = 0; k < 3; ++k)
      if (b.ownsVertex(k) && !(kSelf && hasVertex(a, b.v[k])))
        visit(FeaturePair{FeatureKind::kVertexFace, false, k, 0});
  for (unsigned i = 0; i < 3; ++i) {
    if (!a.ownsEdge(i)) continue;
    const std::uint32_t a0 = a.v[i], a1 = a.v[(i + 1) % 3];
    for (unsigned j = 0; j < 3; ++j) {
      if (!b.ownsEdge(j)) continue;
      const std::uint32_t b0 = b.v[j], b1 = b.v[(j + 1) % 3];
      if (kSelf && (a0 == b0 || a0 == b1 || a1 == b0 || a1 == b1)) continue;
      visit(FeaturePair{FeatureKind::kEdgeEdge, true, i, j});
    }
  }
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
