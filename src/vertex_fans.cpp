// SPDX-License-Identifier: BSD-3-Clause
#include "fcl/narrowphase/detail/deformable/vertex_fans.h"

#include <algorithm>

#include "fcl/narrowphase/detail/deformable/moving_kdop_tree.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

/// A triangle seen from one of its vertices: the next vertex and the one after.
struct Corner {
  std::uint32_t next, last;
};

constexpr std::uint32_t kMaxSpokes = VertexFans::kMaxSpokes;

/// The spokes of corners that form a fan, in order; without spokes if they form none.
struct Spokes {
  std::uint32_t vertices[kMaxSpokes + 1];
  std::uint32_t count{0};
  bool is_closed{false};
};

/// @param count  1 ... kMaxSpokes
Spokes sortIntoFan(Corner* corners, std::uint32_t count) {
  // From any corner forward, as long as a triangle begins where the last one ends; then
  // from the same corner backward.
  Corner* const end = corners + count;
  Corner* sorted = corners + 1;
  const auto follow = [&](auto&& isNeighbour) {
    Corner* found = std::find_if(sorted, end, isNeighbour);
    if (found == end) return false;
    std::swap(*sorted++, *found);
    return true;
  };
  while (follow([&](const Corner& c) { return c.next == sorted[-1].last; })) {
  }
  Corner* const forward = sorted;
  std::uint32_t begin = corners[0].next;
  while (sorted != end && follow([&](const Corner& c) { return c.last == begin; }))
    begin = sorted[-1].next;

  Spokes spokes;
  if (sorted != end) return spokes;
  for (const Corner* c = end; c-- != forward;) spokes.vertices[spokes.count++] = c->next;
  for (const Corner* c = corners; c != forward; ++c)
    spokes.vertices[spokes.count++] = c->next;
  spokes.is_closed = forward[-1].last == begin;
  if (!spokes.is_closed) spokes.vertices[spokes.count++] = forward[-1].last;
  // A spoke that is met twice belongs to three triangles or to two sheets.
  bool is_fan = spokes.count <= kMaxSpokes && !(spokes.is_closed && count < 3);
  for (std::uint32_t i = 0; i < spokes.count; ++i)
    for (std::uint32_t k = 0; k < i; ++k)
      is_fan &= spokes.vertices[k] != spokes.vertices[i];
  if (!is_fan) spokes.count = 0;
  return spokes;
}

}  // namespace

VertexFans::VertexFans(const std::vector<TreeTriangle>& triangles,
                       std::size_t num_vertices) {
  std::vector<std::uint32_t> begin(num_vertices + 1, 0);
  for (const TreeTriangle& t : triangles)
    for (const std::uint32_t v : t.place) ++begin[v + 1];
  for (std::size_t i = 0; i < num_vertices; ++i) begin[i + 1] += begin[i];
  std::vector<Corner> corners(begin.back());
  std::vector<std::uint32_t> end(begin.begin(), begin.end() - 1);
  for (const TreeTriangle& t : triangles)
    for (int k = 0; k < 3; ++k)
      corners[end[t.place[k]]++] = {t.place[(k + 1) % 3], t.place[(k + 2) % 3]};

  first_.resize(num_vertices + 1);
  closed_.assign(num_vertices, 0);
  spokes_.reserve(corners.size() + num_vertices / 8);
  for (std::size_t i = 0; i < num_vertices; ++i) {
    first_[i] = static_cast<std::uint32_t>(spokes_.size());
    const std::uint32_t count = end[i] - begin[i];
    if (count == 0 || count > kMaxSpokes) continue;
    const Spokes fan = sortIntoFan(corners.data() + begin[i], count);
    spokes_.insert(spokes_.end(), fan.vertices, fan.vertices + fan.count);
    closed_[i] = fan.count > 0 && fan.is_closed;
  }
  first_[num_vertices] = static_cast<std::uint32_t>(spokes_.size());
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
