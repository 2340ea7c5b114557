// SPDX-License-Identifier: BSD-3-Clause
#include "query/feature_candidate.h"

#include <cassert>
#include <utility>

namespace fcl {
namespace detail {
namespace deformable {
namespace {

/// Exchanges a and b without a branch, which would be unpredictable.
template <typename T>
void swapIf(bool condition, T& a, T& b) {
  const T difference = (a ^ b) & static_cast<T>(-static_cast<T>(condition));
  a ^= difference;
  b ^= difference;
}

/// An edge whose vertices are in the order of their ids.
struct OrderedEdge {
  /// Both ids, 32 bits each.
  std::uint64_t ids;
  /// Its vertices as indices of TrianglePair::x, four bits each.
  std::uint32_t corners;

  /// @param k  the corner of the triangle at which the edge begins
  /// @param first  index in TrianglePair::x of the triangle's first vertex
  OrderedEdge(const TreeTriangle& triangle, unsigned k, unsigned first) {
    unsigned l = (k + 1) % 3;
    std::uint32_t p = triangle.id[k], q = triangle.id[l];
    const bool is_exchanged = q < p;
    swapIf(is_exchanged, k, l);
    swapIf(is_exchanged, p, q);
    assert(p <= q);
    ids = std::uint64_t{p} << 32 | q;
    corners = (first + k) << 4 | (first + l);
  }
};

/// A free point and a free edge, or two free points. In a self-collision the point
/// belongs to mesh a, and of two points the one with the lower id.
void setFreePair(const TrianglePair& pair, bool is_self, FeatureCandidate& out) {
  constexpr std::uint32_t kUnused = ~std::uint32_t{0};
  assert((pair.a->owned & pair.b->owned & kFreeLeaf) != 0);
  const bool edge_on_a = (pair.a->owned & kOwnsFirstEdge) != 0,
             edge_on_b = (pair.b->owned & kOwnsFirstEdge) != 0;
  assert(!(edge_on_a && edge_on_b));
  const bool has_edge = edge_on_a || edge_on_b,
             is_exchanged =
                 edge_on_a || (is_self && !has_edge && pair.b->id[0] < pair.a->id[0]);
  const TreeTriangle &first = is_exchanged ? *pair.b : *pair.a,
                     &second = is_exchanged ? *pair.a : *pair.b;
  const unsigned begin = is_exchanged ? 3 : 0, end = 3 - begin,
                 low = second.id[1] < second.id[0] ? 1 : 0;
  out.kind = has_edge ? ContinuousContactKind::kVertexEdge
                      : ContinuousContactKind::kVertexVertex;
  out.first_on_a = is_self || !is_exchanged;
  if (is_self && is_exchanged) std::swap(out.triangles[0], out.triangles[1]);
  out.vertices[0] = first.id[0];
  out.vertices[1] = second.id[low];
  out.vertices[2] = has_edge ? second.id[1 - low] : kUnused;
  out.vertices[3] = kUnused;
  assert(out.vertices[1] <= out.vertices[2]);
  assert(!is_self || has_edge || out.vertices[0] <= out.vertices[1]);
  out.x[0] = pair.x[begin];
  out.x[1] = pair.x[end + low];
  out.x[2] = out.x[3] = pair.x[end + 1 - low];
}

}  // namespace

void setCandidate(const TrianglePair& triangles, std::uint32_t bit,
                  const TimeWindow& window, bool is_self, FeatureCandidate& out) {
  assert(!window.isEmpty());
  out.window_lo = windowLo(window);
  out.window_hi = windowHi(window);
  assert(0 <= out.window_lo && out.window_lo <= out.window_hi && out.window_hi <= 1);
  out.triangles[0] = static_cast<std::int32_t>(triangles.a->index);
  out.triangles[1] = static_cast<std::int32_t>(triangles.b->index);
  if (bit == kFreePair) return setFreePair(triangles, is_self, out);
  const FeaturePair pair = featurePair(static_cast<int>(bit));
  out.kind = pair.kind;
  out.first_on_a = pair.first_on_a;
  const auto set = [&](int i, bool on_a, unsigned k) {
    out.vertices[i] = (on_a ? triangles.a : triangles.b)->id[k];
    out.x[i] = triangles.x[on_a ? k : 3 + k];
  };
  if (pair.kind == ContinuousContactKind::kVertexFace) {
    set(0, pair.first_on_a, pair.first);
    for (unsigned k = 0; k < 3; ++k) set(static_cast<int>(k) + 1, !pair.first_on_a, k);
    if (is_self && !pair.first_on_a) {
      out.first_on_a = true;
      std::swap(out.triangles[0], out.triangles[1]);
    }
    return;
  }
  OrderedEdge edges[2] = {OrderedEdge(*triangles.a, pair.first, 0),
                          OrderedEdge(*triangles.b, pair.second, 3)};
  const bool is_exchanged = is_self & (edges[1].ids < edges[0].ids);
  swapIf(is_exchanged, edges[0].ids, edges[1].ids);
  swapIf(is_exchanged, edges[0].corners, edges[1].corners);
  swapIf(is_exchanged, out.triangles[0], out.triangles[1]);
  assert(!is_self || edges[0].ids <= edges[1].ids);
  for (std::size_t i = 0; i < 2; ++i) {
    out.vertices[2 * i] = static_cast<std::uint32_t>(edges[i].ids >> 32);
    out.vertices[2 * i + 1] = static_cast<std::uint32_t>(edges[i].ids);
    out.x[2 * i] = triangles.x[edges[i].corners >> 4];
    out.x[2 * i + 1] = triangles.x[edges[i].corners & 15];
  }
}

std::uint8_t exchangesOf(const TrianglePair& triangles, std::uint32_t bit,
                         const FeatureCandidate& candidate, std::uint8_t exchanges) {
  if (candidate.kind != ContinuousContactKind::kEdgeEdge) return exchanges;
  assert(bit >= kNumVertexFacePairs && bit < kNumFeaturePairs && exchanges < 8);
  const unsigned char(&corners)[4] = kFeaturePoints[bit];
  const TreeVertex *first = triangles.x[corners[0]], *second = triangles.x[corners[2]];
  const bool is_exchanged = candidate.x[2] == first || candidate.x[3] == first;
  const unsigned all = exchanges;
  // Of the first edge of the code, and of the second one.
  const unsigned of_first =
                     (all & 1U) ^ unsigned { candidate.x[is_exchanged ? 2 : 0] != first },
                 of_second = (all >> 1 & 1U) ^
                             unsigned { candidate.x[is_exchanged ? 0 : 2] != second };
  return static_cast<std::uint8_t>(is_exchanged ? of_second | of_first << 1 | (~all & 4U)
                                                : of_first | of_second << 1 | (all & 4U));
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
