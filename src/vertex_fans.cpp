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

/// Brings the corners of one vertex into the order of a fan; false if they form none.
bool sortIntoFan(Corner* corners, std::uint32_t count, bool& is_closed) {
  const auto startsAt = [&](std::uint32_t vertex, std::uint32_t from) {
    return std::find_if(corners + from, corners + count,
                        [vertex](const Corner& c) { return c.next == vertex; });
  };
  // An open fan begins where no triangle ends; a closed one anywhere.
  std::uint32_t begin = 0, num_begins = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    std::uint32_t num_same = 0;
    bool is_begin = true;
    for (std::uint32_t k = 0; k < count; ++k) {
      num_same +=
          (corners[k].next == corners[i].next) + (corners[k].last == corners[i].last);
      is_begin &= corners[k].last != corners[i].next;
    }
    if (num_same != 2) return false;
    if (is_begin) {
      begin = i;
      ++num_begins;
    }
  }
  if (num_begins > 1) return false;
  is_closed = num_begins == 0;
  std::swap(corners[0], corners[begin]);
  for (std::uint32_t i = 1; i < count; ++i) {
    Corner* following = startsAt(corners[i - 1].last, i);
    if (following == corners + count) return false;  // a second sheet
    std::swap(corners[i], *following);
  }
  return is_closed ? count >= 3 && corners[count - 1].last == corners[0].next : true;
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
    Corner* mine = corners.data() + begin[i];
    const std::uint32_t count = end[i] - begin[i];
    bool is_closed = false;
    if (count == 0 || count > kMaxSpokes || !sortIntoFan(mine, count, is_closed))
      continue;
    if (!is_closed && count == kMaxSpokes) continue;
    for (std::uint32_t k = 0; k < count; ++k) spokes_.push_back(mine[k].next);
    if (!is_closed) spokes_.push_back(mine[count - 1].last);
    closed_[i] = is_closed;
  }
  first_[num_vertices] = static_cast<std::uint32_t>(spokes_.size());
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
