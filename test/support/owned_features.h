// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_TEST_SUPPORT_OWNED_FEATURES_H
#define FCL_TEST_SUPPORT_OWNED_FEATURES_H

#include "mesh/feature_pairs.h"

namespace fcl {
namespace test {

/// @brief Whether a triangle owns its vertex k, its edge k or its face. Edge k joins
/// vertices k and (k + 1) % 3.
inline bool ownsVertex(const detail::deformable::MeshTriangle& triangle, unsigned k) {
  return triangle.owned >> k & 1U;
}
inline bool ownsEdge(const detail::deformable::MeshTriangle& triangle, unsigned k) {
  return triangle.owned >> (3 + k) & 1U;
}
inline bool ownsFace(const detail::deformable::MeshTriangle& triangle) {
  return triangle.owned >> 6 & 1U;
}

/// @brief Calls visit(FeaturePair) for each pair of features that triangles a and b own.
/// Over all triangle pairs of a scene these are all VF and EE pairs, each once.
/// @tparam kSelf  a and b are of one mesh: pairs that share a vertex are left out
template <bool kSelf, typename Visit>
void forEachFeaturePair(const detail::deformable::MeshTriangle& a,
                        const detail::deformable::MeshTriangle& b, Visit&& visit) {
  namespace deformable = detail::deformable;
  unsigned pairs = deformable::ownedPairs(a.owned, b.owned);
  if (kSelf) pairs &= ~deformable::pairsAt(deformable::sharedVertices(a.v, b.v));
  for (; pairs != 0; pairs &= pairs - 1)
    visit(deformable::featurePair(__builtin_ctz(pairs)));
}

}  // namespace test
}  // namespace fcl

#endif
