// SPDX-License-Identifier: BSD-3-Clause
#include "query/surroundings.h"

#include <cassert>

namespace fcl {
namespace detail {
namespace deformable {

PairStars Surroundings::of(const FeatureIds& pair) const {
  const bool are_edges = pair.kind == ContinuousContactKind::kEdgeEdge;
  assert(are_edges || pair.kind == ContinuousContactKind::kVertexFace);
  PairStars stars;
  for (int i = 0; i < 4; ++i) {
    stars.ids[i] = pair.vertices[i];
    const bool is_first = i < (are_edges ? 2 : 1);
    if (is_first || are_edges)
      addStar(is_first == pair.first_on_a ? 0 : 1, pair.vertices[i], stars.at[i]);
  }
  return stars;
}

void Surroundings::addStar(int mesh, std::uint32_t vertex,
                           std::vector<StarTriangle>& out) const {
  if (mesh_[mesh] == mesh_[0]) mesh = 0;
  const MeshInstance& instance = *mesh_[mesh];
  std::call_once(is_listed_[mesh],
                 [&] { triangles_[mesh] = TrianglesAtVertices(instance); });
  triangles_[mesh].forEachAt(vertex, [&](const std::uint32_t(&ids)[3]) {
    const int k = ids[0] == vertex ? 0 : ids[1] == vertex ? 1 : 2;
    assert(ids[k] == vertex);
    const std::uint32_t next = ids[(k + 1) % 3], last = ids[(k + 2) % 3];
    out.push_back({{next, last}, {instance.frames[next], instance.frames[last]}});
  });
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
