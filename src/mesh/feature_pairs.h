// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_MESH_FEATURE_PAIRS_H
#define FCL_CCD_MESH_FEATURE_PAIRS_H

#include <algorithm>
#include <array>
#include <cassert>
#include <cstdint>

#include "base/bits.h"
#include "base/short_vector.h"
#include "fcl/narrowphase/stage_counts.h"
#include "mesh/mesh_triangle.h"
#include "mesh/moving_kdop.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief One feature of each of two triangles, by corners of the triangles. VF: vertex
/// `first` of one triangle, and the other triangle. EE: edge `first` of a and edge
/// `second` of b.
struct FeaturePair {
  ContinuousContactKind kind;
  /// VF: whether the vertex belongs to a.
  bool first_on_a;
  unsigned first;
  unsigned second;
};

/// @brief The number of points of a pair of features: VF, EE, VE or VV.
constexpr unsigned numVertices(ContinuousContactKind kind) {
  return kind == ContinuousContactKind::kVertexVertex ? 2
         : kind == ContinuousContactKind::kVertexEdge ? 3
                                                      : 4;
}

/// @brief Whether a point of such a pair belongs to a: the first two of EE, and else the
/// first one, belong to the first feature.
constexpr bool isPointOfA(ContinuousContactKind kind, bool first_on_a, unsigned point) {
  const unsigned num_first = kind == ContinuousContactKind::kEdgeEdge ? 2 : 1;
  return (point < num_first) == first_on_a;
}

/// @brief Two features of two meshes a and b, by ids.
struct FeatureIds {
  ContinuousContactKind kind;
  /// VF and VE: the vertex belongs to mesh a and the face or edge to mesh b, not the
  /// other way round.
  bool first_on_a;
  /// VF: v, f0, f1, f2. EE: ea0, ea1, eb0, eb1. VE: v, e0, e1. VV: v of a, v of b.
  std::uint32_t vertices[4];
  /// Triangle of mesh a and of mesh b.
  std::int32_t triangles[2];
};

/// @brief A pair of features as a key of tables. Faces with the same vertices are one
/// face, in whatever order the vertices are.
struct FeatureKey {
  /// Kind and side, and the vertices.
  std::array<std::uint32_t, 5> words;

  explicit FeatureKey(const FeatureIds& c)
      : words{2 * static_cast<std::uint32_t>(c.kind) + (c.first_on_a ? 1U : 0U),
              c.vertices[0], c.vertices[1], c.vertices[2], c.vertices[3]} {
    if (c.kind == ContinuousContactKind::kVertexFace)
      std::sort(words.begin() + 2, words.end());
  }
  bool operator==(const FeatureKey& other) const { return words == other.words; }

  /// @brief Two products that do not wait for each other and one of their sum, by odd
  /// numbers with bits all over (the golden ratio, and a prime of xxHash). The upper bits
  /// of a product depend on all bits of its factors, so the lower 20 are left out.
  std::uint64_t hash() const {
    const std::uint64_t first = std::uint64_t{words[1]} << 32 | words[2],
                        second = std::uint64_t{words[3]} << 32 | words[4];
    const std::uint64_t sum = (first + words[0]) * 0x9e3779b97f4a7c15 +
                              (second ^ second >> 29) * 0xc2b2ae3d27d4eb4f;
    return (sum ^ sum >> 32) * 0x9e3779b97f4a7c15 >> 20;
  }
};

/// @brief The pairs of features of two triangles a and b, a bit each. Bit k: vertex k of
/// a and the face of b. Bit 3 + k: vertex k of b and the face of a. Bit 6 + 3 i + j: edge
/// i of a and edge j of b.
constexpr int kNumVertexFacePairs = 6;
constexpr int kNumFeaturePairs = 15;

/// @brief One bit more: of two free leaves, edge 0 of each, where a free point is an edge
/// with equal ends. Only contact at a distance knows it. Of two free edges it is the same
/// pair as bit 6.
constexpr int kFreePair = 15;

inline FeaturePair featurePair(int bit) {
  assert(bit >= 0 && bit < kNumFeaturePairs);
  const auto k = static_cast<unsigned>(bit);
  if (k < 3) return {ContinuousContactKind::kVertexFace, true, k, 0};
  if (k < 6) return {ContinuousContactKind::kVertexFace, false, k - 3, 0};
  return {ContinuousContactKind::kEdgeEdge, true, (k - 6) / 3, (k - 6) % 3};
}

/// @brief The number of a pair: the inverse of featurePair().
inline int pairNumber(const FeaturePair& pair) {
  assert(pair.first < 3 && pair.second < 3);
  if (pair.kind == ContinuousContactKind::kEdgeEdge)
    return static_cast<int>(kNumVertexFacePairs + 3 * pair.first + pair.second);
  return static_cast<int>(pair.first_on_a ? pair.first : 3 + pair.first);
}

/// @brief The four points of each pair of features, the vertices of a counted 0-2 and b's
/// 3-5: v, f0, f1, f2 or ea0, ea1, eb0, eb1.
constexpr unsigned char kFeaturePoints[kNumFeaturePairs + 1][4] = {
    {0, 3, 4, 5}, {1, 3, 4, 5}, {2, 3, 4, 5}, {3, 0, 1, 2}, {4, 0, 1, 2}, {5, 0, 1, 2},
    {0, 1, 3, 4}, {0, 1, 4, 5}, {0, 1, 5, 3}, {1, 2, 3, 4}, {1, 2, 4, 5}, {1, 2, 5, 3},
    {2, 0, 3, 4}, {2, 0, 4, 5}, {2, 0, 5, 3}, {0, 1, 3, 4}};

/// @brief Edges (three bits) that end in one of the vertices (three bits).
inline unsigned edgesAt(unsigned vertices) {
  assert(vertices < 8);
  return vertices | (vertices >> 1) | (vertices << 2 & 4U);
}

/// @brief Bits 3 i + j for bit i of rows and bit j of columns.
constexpr unsigned product(unsigned rows, unsigned columns) {
  assert(rows < 8 && columns < 8);
  return ((rows & 1U) | (rows & 2U) << 2 | (rows & 4U) << 4) * columns;
}

/// @brief Whether one of the vertices of a is one of b's.
inline bool doShareVertex(const ThreeIds& a, const ThreeIds& b) {
  const auto equal = (a == shuffle<0, 0, 0, 0>(b, b)) | (a == shuffle<1, 1, 1, 1>(b, b)) |
                     (a == shuffle<2, 2, 2, 2>(b, b));
  return isAny(equal & Mask4{-1, -1, -1, 0});
}

/// @brief Bits 3 i + j for the equal ones among vertices i of a and j of b.
inline unsigned sharedVertices(const std::uint32_t (&a)[3], const std::uint32_t (&b)[3]) {
  unsigned shared = 0;
  for (unsigned i = 0; i < 3; ++i)
    for (unsigned j = 0; j < 3; ++j) shared |= unsigned{a[i] == b[j]} << (3 * i + j);
  return shared;
}

/// @brief For each mask of MeshTriangle::owned, the pairs of features whose feature of a
/// (or of b) is owned. The edges that a (or b) owns, and those of the other one if it may
/// have a face: bits 0-2 for edges of a, 3-5 for those of b.
struct OwnedParts {
  static constexpr unsigned kCount = 2 * kFreeLeaf;
  std::uint16_t of_a[kCount];
  std::uint16_t of_b[kCount];
  std::uint8_t edges_of_a[kCount];
  std::uint8_t edges_of_b[kCount];
};

constexpr OwnedParts makeOwnedParts() {
  OwnedParts parts{};
  for (unsigned owned = 0; owned < OwnedParts::kCount; ++owned) {
    const unsigned vertices = owned & 7U, edges = owned >> 3 & 7U, face = owned >> 6 & 1U;
    const bool is_free = (owned & kFreeLeaf) != 0;
    const unsigned free = unsigned{is_free && (owned & kOwnsAll) != 0} << kFreePair,
                   others = is_free ? 0U : 7U;
    parts.of_a[owned] = static_cast<std::uint16_t>(vertices | face * 7U << 3 |
                                                   product(edges, 7U) << 6 | free);
    parts.of_b[owned] = static_cast<std::uint16_t>(face * 7U | vertices << 3 |
                                                   product(7U, edges) << 6 | free);
    parts.edges_of_a[owned] = static_cast<std::uint8_t>(edges | others << 3);
    parts.edges_of_b[owned] = static_cast<std::uint8_t>(edges << 3 | others);
  }
  return parts;
}

constexpr OwnedParts kOwnedParts = makeOwnedParts();

/// @brief The pairs of features that two triangles own (masks of MeshTriangle::owned).
inline unsigned ownedPairs(unsigned owned_a, unsigned owned_b) {
  assert(owned_a < OwnedParts::kCount && owned_b < OwnedParts::kCount);
  return kOwnedParts.of_a[owned_a] & kOwnedParts.of_b[owned_b];
}

/// @brief The same, without the pairs of free leaves that are not looked for: a free
/// point meets a free edge or another free point at a distance only, and two free edges
/// are one pair.
inline unsigned wantedPairs(unsigned owned_a, unsigned owned_b, bool at_distance) {
  const unsigned pairs = ownedPairs(owned_a, owned_b);
  const bool are_edges = (owned_a & owned_b & kOwnsFirstEdge) != 0;
  return at_distance && !are_edges ? pairs : pairs & ~(1U << kFreePair);
}

/// @brief The pairs of features of two triangles that share a vertex (sharedVertices()).
inline unsigned pairsAt(unsigned shared) {
  assert(shared < 1U << 9);
  unsigned pairs = 0;
  for (; shared != 0; shared &= shared - 1) {
    const unsigned bit = static_cast<unsigned>(lowestBit(shared));
    const unsigned i = 1U << bit / 3, j = 1U << bit % 3;
    pairs |= i | j << 3 | product(edgesAt(i), edgesAt(j)) << 6;
  }
  return pairs;
}

/// @brief The edges that two triangles own, bits 0-2 for a's, 3-5 for b's; without those
/// that face a free leaf, through which nothing passes.
inline unsigned ownedEdges(unsigned owned_a, unsigned owned_b) {
  return kOwnedParts.edges_of_a[owned_a] & kOwnedParts.edges_of_b[owned_b];
}

/// @brief The edges of two triangles that have a vertex of the other one.
inline unsigned edgesAtBoth(unsigned shared) {
  assert(shared < 1U << 9);
  const unsigned of_a =
      (shared & 7U ? 1U : 0U) | (shared & 070U ? 2U : 0U) | (shared & 0700U ? 4U : 0U);
  const unsigned of_b = (shared | shared >> 3 | shared >> 6) & 7U;
  return edgesAt(of_a) | edgesAt(of_b) << 3;
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
