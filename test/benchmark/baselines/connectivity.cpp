// SPDX-License-Identifier: BSD-3-Clause
#include "baselines/connectivity.h"
#include "fcl/math/triangle.h"
#include "mesh/mesh_topology.h"

#include <algorithm>
#include <utility>

namespace fcl {
namespace test {

using detail::deformable::FeaturePair;
using detail::deformable::featurePair;
using fcl::ContinuousContactKind;

MeshConnectivity::MeshConnectivity(std::vector<std::array<std::uint32_t, 3>> triangles,
                                   std::size_t num_vertices)
    : present_(triangles.size()),
      edge_of_(3 * triangles.size()),
      vertex_starts_(num_vertices + 1, 0) {
  const std::size_t n = triangles.size();
  std::vector<Triangle> plain;
  plain.reserve(n);
  for (const auto& v : triangles) {
    plain.emplace_back(v[0], v[1], v[2]);
    for (const std::uint32_t id : v) ++vertex_starts_[id + 1];
  }
  triangles_ = detail::deformable::assignFeatures(plain.data(), n, num_vertices);
  constexpr std::uint32_t kBorder = 0x3f;
  for (std::size_t i = 0; i < n; ++i) {
    const auto& v = triangles[i];
    const std::uint32_t owned = triangles_[i].owned;
    std::uint32_t present = owned | kBorder;
    // Of a triangle that repeats a vertex, that vertex and the edge that is left once.
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t next = (k + 1) % 3, after = (k + 2) % 3;
      if (v[k] != v[next]) continue;
      present &= ~(8U << k);
      for (const auto& twice : {std::array<std::uint32_t, 2>{1U << k, 1U << next},
                                std::array<std::uint32_t, 2>{8U << next, 8U << after}})
        present &= ~((owned & twice[0]) != 0 ? twice[1] : twice[0]);
    }
    present_[i] = static_cast<std::uint8_t>(present);
  }

  for (std::size_t v = 0; v < num_vertices; ++v)
    vertex_starts_[v + 1] += vertex_starts_[v];
  vertex_triangles_.resize(3 * n);
  std::vector<std::uint32_t> next(vertex_starts_.begin(), vertex_starts_.end() - 1);
  for (std::size_t c = 0; c < 3 * n; ++c)
    vertex_triangles_[next[triangles[c / 3][c % 3]]++] = static_cast<int>(c / 3);

  // An edge and where a triangle has it; equal edges follow each other, the owner first.
  std::vector<std::pair<Edge, std::size_t>> met(3 * n);
  for (std::size_t c = 0; c < 3 * n; ++c) {
    const auto& v = triangles[c / 3];
    const auto ends = std::minmax(v[c % 3], v[(c + 1) % 3]);
    met[c] = {{ends.first, ends.second}, c};
  }
  std::sort(met.begin(), met.end());
  std::vector<std::size_t> group_of(3 * n), group_starts;
  for (std::size_t i = 0; i < met.size(); ++i) {
    if (i == 0 || met[i].first != met[i - 1].first) group_starts.push_back(i);
    group_of[met[i].second] = group_starts.size() - 1;
  }
  group_starts.push_back(met.size());
  // Numbers in the order of the owners, so that neighbours are neighbours in memory.
  constexpr std::uint32_t kNone = ~0U;
  std::vector<std::uint32_t> number(group_starts.size(), kNone);
  edge_starts_.push_back(0);
  for (std::size_t c = 0; c < 3 * n; ++c) {
    const std::size_t group = group_of[c];
    if (number[group] == kNone) {
      number[group] = static_cast<std::uint32_t>(edges_.size());
      edges_.push_back(met[group_starts[group]].first);
      for (std::size_t i = group_starts[group]; i < group_starts[group + 1]; ++i)
        edge_triangles_.push_back(static_cast<int>(met[i].second / 3));
      edge_starts_.push_back(static_cast<std::uint32_t>(edge_triangles_.size()));
    }
    edge_of_[c] = number[group];
  }

  owners_vertices_.resize(n);
  for (std::size_t c = 0; c < 3 * n; ++c)
    for (const int owner :
         {*aroundVertex(triangles[c / 3][c % 3]).first, *aroundEdge(edge_of_[c]).first})
      for (const std::uint32_t v : triangles[static_cast<std::size_t>(owner)])
        owners_vertices_[c / 3].add(v);
}

bool MeshConnectivity::findRepresentative(int i, int j, int bit, int& first,
                                          int& second) const {
  const FeaturePair pair = featurePair(bit);
  if (pair.kind == ContinuousContactKind::kVertexFace) {
    const int with_vertex = pair.first_on_a ? i : j, face = pair.first_on_a ? j : i;
    for (const int t : aroundVertex(triangle(with_vertex).v[pair.first]))
      if (!areAdjacent(t, face)) {
        first = pair.first_on_a ? t : face;
        second = pair.first_on_a ? face : t;
        return true;
      }
    return false;
  }
  // The same two triangles in whatever order they are met.
  const std::uint32_t e = edgeOf(i, pair.first), f = edgeOf(j, pair.second);
  for (const int t : aroundEdge(std::min(e, f)))
    for (const int s : aroundEdge(std::max(e, f)))
      if (!areAdjacent(t, s)) {
        first = e < f ? t : s;
        second = e < f ? s : t;
        return true;
      }
  return false;
}

bool MeshConnectivity::isRepresentative(int i, int j, int bit) const {
  int first = -1, second = -1;
  return findRepresentative(i, j, bit, first, second) && first == i && second == j;
}

unsigned MeshConnectivity::representedPairs(int i, int j) const {
  using detail::deformable::kOwnedParts;
  unsigned represented =
      kOwnedParts.of_a[triangle(i).owned] & kOwnedParts.of_b[triangle(j).owned];
  if (!owners_vertices_[static_cast<std::size_t>(i)].mayMeet(
          owners_vertices_[static_cast<std::size_t>(j)]))
    return represented;
  unsigned others =
      kOwnedParts.of_a[present(i)] & kOwnedParts.of_b[present(j)] & ~represented;
  for (; others != 0; others &= others - 1) {
    const int bit = __builtin_ctz(others);
    const FeaturePair pair = featurePair(bit);
    int owner = i, other_owner = j;
    if (pair.kind == ContinuousContactKind::kEdgeEdge) {
      owner = *aroundEdge(edgeOf(i, pair.first)).first;
      other_owner = *aroundEdge(edgeOf(j, pair.second)).first;
    } else if (pair.first_on_a) {
      owner = *aroundVertex(triangle(i).v[pair.first]).first;
    } else {
      other_owner = *aroundVertex(triangle(j).v[pair.first]).first;
    }
    // Nearly always the owners are not adjacent, and represent their features.
    if (areAdjacent(owner, other_owner) && isRepresentative(i, j, bit))
      represented |= 1U << bit;
  }
  return represented;
}

std::vector<TrianglePairMask> MeshConnectivity::findOrphans() const {
  std::vector<TrianglePairMask> orphans;
  const auto add = [&](int i, int j) {
    unsigned left = 0;
    for (unsigned pairs = ownedPairs(i, j); pairs != 0; pairs &= pairs - 1) {
      const int bit = __builtin_ctz(pairs);
      int first = -1, second = -1;
      if (!findRepresentative(i, j, bit, first, second)) left |= 1U << bit;
    }
    if (left != 0) orphans.push_back({i, j, static_cast<std::uint16_t>(left)});
  };
  for (int i = 0; i < static_cast<int>(size()); ++i) {
    const auto& v = triangle(i).v;
    std::vector<int> later;
    for (const std::uint32_t id : v)
      for (const int j : aroundVertex(id))
        if (j > i) later.push_back(j);
    std::sort(later.begin(), later.end());
    later.erase(std::unique(later.begin(), later.end()), later.end());
    for (const int j : later) add(i, j);
  }
  return orphans;
}

}  // namespace test
}  // namespace fcl
