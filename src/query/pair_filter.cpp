// SPDX-License-Identifier: BSD-3-Clause
#include "query/pair_filter.h"

#include <algorithm>
#include <cassert>

namespace fcl {
namespace detail {
namespace deformable {

namespace {

struct NumberedTriangle {
  std::uint32_t ids[3];
};

/// The triangles of a mesh in the order of their numbers; those of a tree are not.
std::vector<NumberedTriangle> trianglesOf(const MeshInstance& mesh) {
  if (mesh.tree) {
    std::vector<NumberedTriangle> triangles(mesh.tree->triangles().size());
    for (const TreeTriangle& from : mesh.tree->triangles()) {
      assert(from.index < triangles.size());
      std::copy(from.id, from.id + 3, triangles[from.index].ids);
    }
    return triangles;
  }
  std::vector<NumberedTriangle> triangles(mesh.num_triangles);
  for (std::size_t i = 0; i < triangles.size(); ++i)
    mesh.triangles.copyIds(i, triangles[i].ids);
  return triangles;
}

}  // namespace

/// A triangle of a rigid mesh with a vertex that is not there has an error when a query
/// comes to it. It is at none of its vertices.
TrianglesAtVertices::TrianglesAtVertices(const MeshInstance& mesh) {
  const std::vector<NumberedTriangle> triangles = trianglesOf(mesh);
  const std::size_t num_vertices = mesh.frames.size();
  const auto isThere = [&](const NumberedTriangle& triangle) {
    return mesh.tree || std::all_of(triangle.ids, triangle.ids + 3,
                                    [&](std::uint32_t id) { return id < num_vertices; });
  };
  first_.assign(num_vertices + 1, 0);
  for (const NumberedTriangle& triangle : triangles)
    if (isThere(triangle))
      for (const std::uint32_t id : triangle.ids) ++first_[id + 1];
  for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
  corners_.resize(first_.back());
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    if (!isThere(triangles[i])) continue;
    for (const std::uint32_t id : triangles[i].ids) {
      Corner& corner = corners_[next[id]++];
      corner.triangle = static_cast<std::int32_t>(i);
      std::copy(triangles[i].ids, triangles[i].ids + 3, corner.ids);
    }
  }
  // Each vertex has as many triangles as were counted.
  assert(std::equal(next.begin(), next.end(), first_.begin() + 1));
}

bool TrianglesAtVertices::holds(const Corner& corner, const HeldFeature& feature) {
  return std::all_of(feature.ids, feature.ids + feature.count, [&](std::uint32_t id) {
    return std::find(corner.ids, corner.ids + 3, id) != corner.ids + 3;
  });
}

bool PairFilter::find(const HeldFeature& a, const HeldFeature& b,
                      std::int32_t (&triangles)[2]) const {
  const auto take = [&](std::int32_t x, std::int32_t y) {
    if (!rules_.accept(x, y)) return false;
    triangles[0] = x;
    triangles[1] = y;
    return true;
  };
  if (take(a.triangle, b.triangle)) return true;
  const TrianglesAtVertices& holders_of_b =
      holders_of_b_ ? *holders_of_b_ : holders_of_a_;
  return holders_of_a_.anyOf(a, [&](std::int32_t x) {
    return holders_of_b.anyOf(b, [&](std::int32_t y) { return take(x, y); });
  });
}

bool PairFilter::find(const FeatureIds& pair, std::int32_t (&triangles)[2]) const {
  const unsigned num_first = pair.kind == ContinuousContactKind::kEdgeEdge ? 2 : 1;
  const HeldFeature first{pair.vertices, num_first,
                          pair.triangles[pair.first_on_a ? 0 : 1]},
      second{pair.vertices + num_first, numVertices(pair.kind) - num_first,
             pair.triangles[pair.first_on_a ? 1 : 0]};
  return pair.first_on_a ? find(first, second, triangles)
                         : find(second, first, triangles);
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
