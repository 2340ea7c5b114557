// SPDX-License-Identifier: BSD-3-Clause
#include "fcl/narrowphase/detail/deformable/triangle_pair.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace fcl {
namespace detail {
namespace deformable {

NonFiniteVertex::NonFiniteVertex(std::size_t vertex)
    : std::domain_error("vertex " + std::to_string(vertex) + " is not finite") {}

void TriangleSide::read(const MeshInstance& mesh, int i) {
  index = i;
  triangle = mesh.triangle(static_cast<std::size_t>(i));
  for (int k = 0; k < 3; ++k) {
    x[k] = mesh.frames[triangle.v[k]];
    vertex[k] = AxisRanges(x[k]);
    for (int c = 0; c < 3; ++c)
      if (!std::isfinite(x[k].t0[c]) || !std::isfinite(x[k].t1[c]))
        throw NonFiniteVertex(triangle.v[k]);
  }
  for (int k = 0; k < 3; ++k) edge[k] = AxisRanges(vertex[k], vertex[(k + 1) % 3]);
  face = AxisRanges(edge[0], vertex[2]);
}

FeatureIds TrianglePair::describe(const FeaturePair& pair, FeaturePoints& points) const {
  const MeshTriangle &a = side_a_.triangle, &b = side_b_.triangle;
  FeatureIds ids{pair.kind, pair.first_on_a, {}, {side_a_.index, side_b_.index}};
  std::uint32_t(&v)[4] = ids.vertices;
  if (pair.kind == FeatureKind::kVertexFace) {
    const MeshTriangle& face = pair.first_on_a ? b : a;
    v[0] = pair.first_on_a ? a.v[pair.first] : b.v[pair.first];
    std::copy(face.v, face.v + 3, v + 1);
    if (self_ && !pair.first_on_a) {
      ids.first_on_a = true;
      std::swap(ids.triangles[0], ids.triangles[1]);
    }
    return ids;
  }
  v[0] = a.v[pair.first];
  v[1] = a.v[(pair.first + 1) % 3];
  v[2] = b.v[pair.second];
  v[3] = b.v[(pair.second + 1) % 3];
  const auto swap = [&](int i, int j) {
    std::swap(v[i], v[j]);
    std::swap(points.point[i], points.point[j]);
  };
  if (v[1] < v[0]) swap(0, 1);
  if (v[3] < v[2]) swap(2, 3);
  if (self_ && (v[2] < v[0] || (v[2] == v[0] && v[3] < v[1]))) {
    swap(0, 2);
    swap(1, 3);
    std::swap(ids.triangles[0], ids.triangles[1]);
  }
  return ids;
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
