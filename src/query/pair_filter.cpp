// SPDX-License-Identifier: BSD-3-Clause
#include "query/pair_filter.h"

#include <algorithm>
#include <cassert>

namespace fcl {
namespace detail {
namespace deformable {

TrianglesAtVertices::TrianglesAtVertices(const MeshInstance& mesh) {
  assert(mesh.tree || !mesh.owners);
  if (!mesh.tree) return;
  const auto& triangles = mesh.tree->triangles();
  first_.assign(mesh.frames.size() + 1, 0);
  for (const TreeTriangle& triangle : triangles)
    for (const std::uint32_t id : triangle.id) ++first_[id + 1];
  for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
  // The triangles of a tree are not in the order of their numbers.
  std::vector<const TreeTriangle*> by_number(triangles.size());
  for (const TreeTriangle& triangle : triangles) by_number[triangle.index] = &triangle;
  corners_.resize(3 * triangles.size());
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  for (const TreeTriangle* triangle : by_number)
    for (const std::uint32_t id : triangle->id) {
      Corner& corner = corners_[next[id]++];
      corner.triangle = static_cast<std::int32_t>(triangle->index);
      std::copy(triangle->id, triangle->id + 3, corner.ids);
    }
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
