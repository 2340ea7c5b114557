// SPDX-License-Identifier: BSD-3-Clause
#include "fcl/narrowphase/detail/deformable/mesh_topology.h"

#include <algorithm>
#include <array>

namespace fcl {
namespace detail {
namespace deformable {
namespace {

/// A feature that several triangles may have: its lowest vertex, its other vertices, and
/// the place (7 * triangle + bit) that may own it.
struct Claim {
  std::uint32_t lowest;
  std::uint64_t others;
  std::uint64_t place;
};

/// Gives each distinct feature to its claim with the lowest place: claims are bucketed by
/// lowest vertex (a counting sort), and each small bucket is sorted.
void settle(const std::vector<Claim>& claims, std::size_t num_vertices,
            std::vector<MeshTriangle>& triangles) {
  std::vector<std::size_t> first(num_vertices + 1, 0);
  for (const Claim& c : claims) ++first[c.lowest + 1];
  for (std::size_t i = 0; i < num_vertices; ++i) first[i + 1] += first[i];

  using Entry = std::array<std::uint64_t, 2>;
  std::vector<Entry> entries(claims.size());
  std::vector<std::size_t> next(first.begin(), first.end() - 1);
  for (const Claim& c : claims) entries[next[c.lowest]++] = {c.others, c.place};

  for (std::size_t i = 0; i < num_vertices; ++i) {
    const auto begin = entries.begin() + static_cast<std::ptrdiff_t>(first[i]);
    const auto end = entries.begin() + static_cast<std::ptrdiff_t>(first[i + 1]);
    std::sort(begin, end);
    for (auto e = begin; e != end; ++e)
      if (e == begin || (*e)[0] != (*(e - 1))[0])
        triangles[(*e)[1] / 7].owned |= 1U << ((*e)[1] % 7);
  }
}

}  // namespace

std::vector<MeshTriangle> assignFeatures(const Triangle* triangles,
                                         std::size_t num_triangles,
                                         std::size_t num_vertices) {
  std::vector<MeshTriangle> result(num_triangles);
  std::vector<Claim> edges, faces;
  edges.reserve(3 * num_triangles);
  faces.reserve(num_triangles);
  std::vector<bool> vertex_taken(num_vertices, false);

  for (std::size_t i = 0; i < num_triangles; ++i) {
    MeshTriangle& t = result[i];
    t.owned = 0;
    for (unsigned k = 0; k < 3; ++k)
      t.v[k] = static_cast<std::uint32_t>(triangles[i][static_cast<int>(k)]);
    for (unsigned k = 0; k < 3; ++k) {
      if (!vertex_taken[t.v[k]]) {
        vertex_taken[t.v[k]] = true;
        t.owned |= 1U << k;
      }
      const auto ends = std::minmax(t.v[k], t.v[(k + 1) % 3]);
      if (ends.first != ends.second)
        edges.push_back({ends.first, ends.second, 7 * std::uint64_t{i} + 3 + k});
    }
    std::array<std::uint32_t, 3> v{t.v[0], t.v[1], t.v[2]};
    std::sort(v.begin(), v.end());
    faces.push_back({v[0], std::uint64_t{v[1]} << 32 | v[2], 7 * std::uint64_t{i} + 6});
  }
  settle(edges, num_vertices, result);
  settle(faces, num_vertices, result);
  return result;
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
