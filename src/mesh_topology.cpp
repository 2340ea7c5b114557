// SPDX-License-Identifier: BSD-3-Clause
#include "fcl/narrowphase/detail/deformable/mesh_topology.h"

#include <algorithm>
#include <cstring>
#include <type_traits>

#include "fcl/narrowphase/detail/deformable/uninitialized_vector.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

struct VertexIds {
  std::size_t id[3];
};
static_assert(std::is_trivially_copyable_v<Triangle> &&
              sizeof(Triangle) == sizeof(VertexIds));

/// As FCL's operator[], which is a call into its library for each vertex.
VertexIds idsOf(const Triangle& triangle) {
  VertexIds ids;
  std::memcpy(&ids, &triangle, sizeof(ids));
  return ids;
}

/// What is to be found again: claims with the same key and other are for one thing.
struct Claim {
  std::uint32_t key, other;
};

/// Not the key of a claim.
constexpr std::uint32_t kNoKey = ~std::uint32_t{0};

/// For each claim the number of the first that is for the same thing. Time and memory
/// are linear, whatever claims there are: they are brought together by key, and in each
/// group the first one with each other number is noted.
/// @param claim  claim(i) of 0 <= i < count; key and other below num_keys and num_others
template <typename ClaimOf>
UninitializedVector<std::uint32_t> firstClaims(std::uint32_t count, std::size_t num_keys,
                                               std::size_t num_others, ClaimOf&& claim) {
  std::vector<std::uint32_t> next(num_keys + 1, 0);
  for (std::uint32_t i = 0; i < count; ++i) ++next[claim(i).key + 1];
  for (std::size_t key = 0; key < num_keys; ++key) next[key + 1] += next[key];

  struct Entry {
    Claim claim;
    std::uint32_t number;
  };
  UninitializedVector<Entry> entries(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    const Claim c = claim(i);
    entries[next[c.key]++] = {c, i};
  }

  struct Noted {
    std::uint32_t key, number;
  };
  std::vector<Noted> noted(num_others, Noted{kNoKey, 0});
  UninitializedVector<std::uint32_t> first(count);
  for (const Entry& e : entries) {
    Noted& n = noted[e.claim.other];
    // No branch: nobody could foretell it.
    n.number = n.key == e.claim.key ? n.number : e.number;
    n.key = e.claim.key;
    first[e.number] = n.number;
  }
  return first;
}

}  // namespace

std::size_t findOutOfRange(const Triangle* triangles, std::size_t num_triangles,
                           std::size_t num_vertices) {
  for (std::size_t i = 0; i < num_triangles; ++i) {
    const VertexIds ids = idsOf(triangles[i]);
    for (std::size_t k = 0; k < 3; ++k)
      if (ids.id[k] >= num_vertices) return 3 * i + k;
  }
  return 3 * num_triangles;
}

std::vector<MeshTriangle> assignFeatures(const Triangle* triangles,
                                         std::size_t num_triangles,
                                         std::size_t num_vertices) {
  std::vector<MeshTriangle> result(num_triangles);
  std::vector<std::uint8_t> vertex_taken(num_vertices, 0);
  for (std::size_t i = 0; i < num_triangles; ++i) {
    MeshTriangle& t = result[i];
    const VertexIds ids = idsOf(triangles[i]);
    t.owned = 0;
    for (unsigned k = 0; k < 3; ++k) {
      t.v[k] = static_cast<std::uint32_t>(ids.id[k]);
      t.owned |= (1U ^ vertex_taken[t.v[k]]) << k;
      vertex_taken[t.v[k]] = 1;
    }
  }

  // An edge: its lower and its higher vertex. A face: its lowest vertex and the edge
  // opposite, by the number of the edge's first claim.
  const auto count = static_cast<std::uint32_t>(num_triangles);
  const auto ends = [&result](std::uint32_t edge) {
    const MeshTriangle& t = result[edge / 3];
    const std::uint32_t a = t.v[edge % 3], b = t.v[(edge + 1) % 3];
    return Claim{std::min(a, b), std::max(a, b)};
  };
  const UninitializedVector<std::uint32_t> first_edge =
      firstClaims(3 * count, num_vertices, num_vertices, ends);
  const auto corner = [&](std::uint32_t i) {
    const MeshTriangle& t = result[i];
    const std::uint32_t j = t.v[1] < t.v[0] ? 1 : 0, k = t.v[2] < t.v[j] ? 2 : j;
    return Claim{t.v[k], first_edge[3 * i + (k + 1) % 3]};
  };
  const UninitializedVector<std::uint32_t> first_face =
      firstClaims(count, num_vertices, 3 * num_triangles, corner);
  for (std::uint32_t i = 0; i < count; ++i) {
    MeshTriangle& t = result[i];
    for (std::uint32_t k = 0; k < 3; ++k) {
      const bool is_first = first_edge[3 * i + k] == 3 * i + k;
      const bool is_edge = t.v[k] != t.v[(k + 1) % 3];
      t.owned |= static_cast<std::uint32_t>(is_first && is_edge) << (3 + k);
    }
    t.owned |= std::uint32_t{first_face[i] == i} << 6;
  }
  return result;
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
