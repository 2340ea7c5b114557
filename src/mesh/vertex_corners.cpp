// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/vertex_corners.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstring>

#include "base/bits.h"
#include "base/parallel.h"
#include "base/short_vector.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

/// The number of vertices whose corners one task does.
constexpr std::size_t kBlock = 2048;

/// Not a vertex.
constexpr std::uint32_t kNone = ~std::uint32_t{0};

#ifndef NDEBUG

/// Whether corners are in the order that CornersAtVertex says.
bool areInFanOrder(const Corner* corners, std::uint32_t count,
                   CornersAtVertex::Kind kind) {
  if (kind == CornersAtVertex::kNoFan) return true;
  for (std::uint32_t i = 1; i < count; ++i)
    if (corners[i].next != corners[i - 1].last) return false;
  const bool ends_at_begin = corners[count - 1].last == corners[0].next;
  return kind == CornersAtVertex::kClosedFan ? count >= 3 && ends_at_begin
                                             : !ends_at_begin;
}

/// Whether each vertex that has corners is owned by one of the triangles.
bool ownEachVertexOnce(const VertexCorners& corners,
                       const std::vector<TreeTriangle>& triangles) {
  std::vector<int> owners(corners.size(), 0);
  for (const TreeTriangle& t : triangles)
    for (int k = 0; k < 3; ++k) owners[t.place[k]] += (t.owned >> k & 1U) != 0;
  for (std::size_t v = 0; v < owners.size(); ++v)
    if (owners[v] != (corners[v].count > 0)) return false;
  return true;
}

#endif

/// Sorts corners into the order of a fan if they form one: each begins where the one
/// before ends.
/// @param count  1 ... 4 * kQuads
template <std::uint32_t kQuads>
CornersAtVertex::Kind sortIntoFan(Corner* corners, std::uint32_t count) {
  constexpr std::uint32_t kWidth = 4 * kQuads;
  assert(count > 0 && count <= kWidth);
  std::uint32_t last[kWidth];
  std::fill(last, last + kWidth, kNone);
  for (std::uint32_t i = 0; i < count; ++i) last[i] = corners[i].last;
  // For each corner, the corners that begin where it ends, a bit each. There is no branch
  // on the result, which would be unpredictable.
  Word4 quads[kQuads], found[kQuads] = {};
  std::memcpy(quads, last, sizeof(last));
  for (std::uint32_t k = 0; k < count; ++k)
    for (std::uint32_t q = 0; q < kQuads; ++q)
      found[q] |= Word4(quads[q] == corners[k].next) & (1U << k);
  std::uint32_t after[kWidth + 1];
  std::memcpy(after, found, sizeof(found));
  after[kWidth] = 0;

  // If a spoke occurs too often, it belongs to three triangles or to two sheets. In a fan
  // at most one corner follows each corner, and each follows at most one.
  std::uint32_t followers = 0, surplus = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    surplus |= (after[i] & (after[i] - 1)) | (followers & after[i]);
    followers |= after[i];
  }
  // The walk from the corner that follows none (or from any, in a closed fan) must visit
  // all corners.
  const std::uint32_t all = (1U << count) - 1, begins = all & ~followers;
  const bool is_closed = begins == 0;
  Corner sorted[kWidth];
  std::uint32_t met = 0;
  auto at = static_cast<std::uint32_t>(lowestBit(is_closed ? 1 : begins));
  for (std::uint32_t i = 0; i < count; ++i) {
    met |= 1U << at;
    sorted[i] = corners[at % kWidth];
    at = static_cast<std::uint32_t>(lowestBit(after[at] | 1U << kWidth));
  }
  const bool is_fan = surplus == 0 && met == all && (!is_closed || count >= 3);
  if (!is_fan) return CornersAtVertex::kNoFan;
  std::copy(sorted, sorted + count, corners);
  return is_closed ? CornersAtVertex::kClosedFan : CornersAtVertex::kOpenFan;
}

/// The same for more corners.
CornersAtVertex::Kind sortIntoLongFan(Corner* corners, std::uint32_t count) {
  std::vector<Corner> by_next(corners, corners + count);
  std::vector<std::uint32_t> lasts(count);
  std::transform(by_next.begin(), by_next.end(), lasts.begin(),
                 [](const Corner& c) { return c.last; });
  std::sort(by_next.begin(), by_next.end(),
            [](const Corner& a, const Corner& b) { return a.next < b.next; });
  std::sort(lasts.begin(), lasts.end());
  const auto begin_together = [](const Corner& a, const Corner& b) {
    return a.next == b.next;
  };
  // At each spoke at most one corner may begin and at most one may end.
  if (std::adjacent_find(lasts.begin(), lasts.end()) != lasts.end() ||
      std::adjacent_find(by_next.begin(), by_next.end(), begin_together) != by_next.end())
    return CornersAtVertex::kNoFan;
  const auto first =
      std::find_if(by_next.begin(), by_next.end(), [&lasts](const Corner& c) {
        return !std::binary_search(lasts.begin(), lasts.end(), c.next);
      });
  const bool is_closed = first == by_next.end();
  const Corner begin = is_closed ? corners[0] : *first;
  // The walk must visit all corners.
  std::vector<Corner> sorted{begin};
  while (sorted.size() < count) {
    const auto next = std::lower_bound(
        by_next.begin(), by_next.end(), sorted.back().last,
        [](const Corner& c, std::uint32_t spoke) { return c.next < spoke; });
    if (next == by_next.end() || next->next != sorted.back().last ||
        next->next == begin.next)
      return CornersAtVertex::kNoFan;
    sorted.push_back(*next);
  }
  std::copy(sorted.begin(), sorted.end(), corners);
  return is_closed ? CornersAtVertex::kClosedFan : CornersAtVertex::kOpenFan;
}

/// Sorts the corners at a vertex.
CornersAtVertex::Kind sortCorners(Corner* corners, std::uint32_t count) {
  if (count == 0) return CornersAtVertex::kNoFan;
  const CornersAtVertex::Kind kind = count <= 8    ? sortIntoFan<2>(corners, count)
                                     : count <= 16 ? sortIntoFan<4>(corners, count)
                                                   : sortIntoLongFan(corners, count);
  assert(areInFanOrder(corners, count, kind));
  return kind;
}

/// The features at a vertex that the triangle of each corner owns: the vertex, and the
/// edges and faces that no lower triangle has. By the place of the corner.
class Owned {
 public:
  Owned(std::uint32_t vertex, const CornersAtVertex& at, std::uint8_t* owned)
      : vertex_(vertex), corners_(at.corners), count_(at.count), owned_(owned) {}

  /// In a fan every face occurs once. Every edge is in two triangles that follow each
  /// other, or at an end of the fan.
  void ofFan(bool is_closed) const {
    assert(count_ >= (is_closed ? 3U : 1U));
    const Corner* lowest = corners_;
    std::uint32_t before = is_closed ? lastEdge(corners_[count_ - 1]) : kNone;
    const std::uint32_t end = is_closed ? nextEdge(corners_[0]) : kNone;
    for (std::uint32_t i = 0; i < count_; ++i) {
      const Corner& c = corners_[i];
      if (c.number < lowest->number) lowest = &c;
      const std::uint32_t after = i + 1 < count_ ? nextEdge(corners_[i + 1]) : end;
      const bool below_next = vertex_ < c.next, below_last = vertex_ < c.last;
      owned_[c.place] = bit(below_next & (nextEdge(c) < before), 3 + nextEdge(c) % 4) |
                        bit(below_last & (lastEdge(c) < after), 3 + lastEdge(c) % 4) |
                        bit(below_next & below_last, 6);
      before = lastEdge(c);
    }
    owned_[lowest->place] |= bit(true, lowest->number % 4);
  }

  /// If several triangles have a feature, the lowest number comes first.
  void ofAny(std::vector<std::array<std::uint32_t, 5>>& claims) const {
    claims.clear();
    for (const Corner* c = corners_; c != corners_ + count_; ++c) {
      owned_[c->place] = 0;
      claims.push_back({kNone, kNone, c->number, c->place, c->number % 4});
      for (const bool next : {true, false}) {
        const std::uint32_t other = next ? c->next : c->last,
                            edge = next ? nextEdge(*c) : lastEdge(*c);
        if (vertex_ < other)
          claims.push_back({other, kNone, edge, c->place, 3 + edge % 4});
      }
      if (vertex_ <= c->next && vertex_ <= c->last)
        claims.push_back({std::min(c->next, c->last), std::max(c->next, c->last),
                          c->number, c->place, 6});
    }
    std::sort(claims.begin(), claims.end());
    for (std::size_t i = 0; i < claims.size(); ++i) {
      const auto& c = claims[i];
      if (i == 0 || claims[i - 1][0] != c[0] || claims[i - 1][1] != c[1])
        owned_[c[3]] |= bit(true, c[4]);
    }
  }

 private:
  static std::uint8_t bit(bool is_owned, std::uint32_t index) {
    return static_cast<std::uint8_t>(std::uint32_t{is_owned} << index);
  }
  /// 4 * triangle + k of the edge to the next vertex, and of the edge from the last
  /// vertex.
  static std::uint32_t nextEdge(const Corner& c) { return c.number; }
  static std::uint32_t lastEdge(const Corner& c) {
    return c.number % 4 == 0 ? c.number + 2 : c.number - 1;
  }

  std::uint32_t vertex_;
  const Corner* corners_;
  std::uint32_t count_;
  std::uint8_t* owned_;
};

}  // namespace

VertexCorners::VertexCorners(const std::vector<TreeTriangle>& triangles,
                             std::size_t num_vertices, int num_threads)
    : first_(num_vertices + 2, 0), corners_(3 * triangles.size()), kinds_(num_vertices) {
  assert(triangles.size() <= kMaxMeshSize && num_vertices <= kMaxMeshSize);
  // While corners are stored, first_[v + 1] is the place of the next corner of v.
  for (const TreeTriangle& t : triangles)
    for (const std::uint32_t v : t.place) {
      assert(v < num_vertices && t.index < kMaxMeshSize);
      ++first_[v + 2];
    }
  for (std::size_t v = 0; v < num_vertices; ++v) first_[v + 2] += first_[v + 1];
  for (std::uint32_t i = 0; i < triangles.size(); ++i) {
    const TreeTriangle& t = triangles[i];
    for (std::uint32_t k = 0; k < 3; ++k)
      corners_[first_[t.place[k] + 1]++] = {t.place[(k + 1) % 3], t.place[(k + 2) % 3],
                                            4 * t.index + k, 4 * i + k};
  }
  assert(first_[0] == 0 && first_[num_vertices] == corners_.size());
  parallelForBlocks(
      num_vertices, kBlock, num_threads, [&](std::size_t v, std::size_t last) {
        for (; v < last; ++v)
          kinds_[v] = sortCorners(corners_.data() + first_[v], first_[v + 1] - first_[v]);
      });
}

void assignOwners(const VertexCorners& corners, int num_threads,
                  std::vector<TreeTriangle>& triangles) {
  UninitializedVector<std::uint8_t> owned(4 * triangles.size());
  parallelForBlocks(corners.size(), kBlock, num_threads,
                    [&](std::size_t v, std::size_t last) {
                      std::vector<std::array<std::uint32_t, 5>> claims;
                      for (; v < last; ++v) {
                        const CornersAtVertex at = corners[v];
                        const Owned here(static_cast<std::uint32_t>(v), at, owned.data());
                        if (at.kind == CornersAtVertex::kNoFan)
                          here.ofAny(claims);
                        else
                          here.ofFan(at.kind == CornersAtVertex::kClosedFan);
                      }
                    });
  parallelForBlocks(triangles.size(), 4 * kBlock, num_threads,
                    [&](std::size_t i, std::size_t last) {
                      for (; i < last; ++i) {
                        const std::uint8_t* at = &owned[4 * i];
                        triangles[i].owned = std::uint32_t{at[0]} | at[1] | at[2];
                        assert(triangles[i].owned <= kOwnsAll);
                      }
                    });
  assert(ownEachVertexOnce(corners, triangles));
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
