// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/vertex_fans.h"

#include <algorithm>
#include <cassert>

#include "base/parallel.h"
#include "mesh/vertex_corners.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

std::uint32_t numSpokes(const CornersAtVertex& at) {
  if (at.kind == CornersAtVertex::kNoFan) return 0;
  return at.count + (at.kind == CornersAtVertex::kOpenFan);
}

void writeSpokes(const CornersAtVertex& at, std::uint32_t* to) {
  if (at.kind == CornersAtVertex::kNoFan) return;
  for (std::uint32_t i = 0; i < at.count; ++i) *to++ = at.corners[i].next;
  if (at.kind == CornersAtVertex::kOpenFan) *to = at.corners[at.count - 1].last;
}

}  // namespace

VertexFans::VertexFans(const std::vector<TreeTriangle>& triangles,
                       std::size_t num_vertices)
    : VertexFans(VertexCorners(triangles, num_vertices, 1), 1) {}

VertexFans::VertexFans(const VertexCorners& corners, int num_threads)
    : first_(corners.size() + 1), closed_(corners.size()) {
  std::uint32_t num_spokes = 0;
  for (std::size_t v = 0; v < corners.size(); ++v) {
    first_[v] = num_spokes;
    closed_[v] = corners[v].kind == CornersAtVertex::kClosedFan;
    num_spokes += numSpokes(corners[v]);
    longest_ = std::max(longest_, num_spokes - first_[v]);
  }
  first_[corners.size()] = num_spokes;
  spokes_.resize(num_spokes);
  constexpr std::size_t kBlock = 4096;
  parallelForBlocks(corners.size(), kBlock, num_threads,
                    [&](std::size_t v, std::size_t last) {
                      for (; v < last; ++v)
                        writeSpokes(corners[v], spokes_.data() + first_[v]);
                    });
}

VertexFans::VertexFans(const VertexFans& before,
                       const std::vector<std::uint32_t>& old_places,
                       const std::vector<std::uint32_t>& new_places,
                       const VertexCorners& corners)
    : first_(corners.size() + 1), closed_(corners.size()) {
  constexpr std::uint32_t kNone = ~std::uint32_t{0};
  assert(old_places.size() == corners.size() && new_places.size() == before.size());
  std::uint32_t num_spokes = 0;
  for (std::size_t v = 0; v < corners.size(); ++v) {
    const bool is_new = old_places[v] == kNone;
    first_[v] = num_spokes;
    closed_[v] = is_new ? corners[v].kind == CornersAtVertex::kClosedFan
                        : before.closed_[old_places[v]];
    num_spokes += is_new ? numSpokes(corners[v]) : before[old_places[v]].count;
    longest_ = std::max(longest_, num_spokes - first_[v]);
  }
  first_[corners.size()] = num_spokes;
  spokes_.resize(num_spokes);
  for (std::size_t v = 0; v < corners.size(); ++v) {
    std::uint32_t* to = spokes_.data() + first_[v];
    if (old_places[v] == kNone) {
      writeSpokes(corners[v], to);
      continue;
    }
    const VertexFan fan = before[old_places[v]];
    for (std::uint32_t i = 0; i < fan.count; ++i) {
      to[i] = new_places[fan.spokes[i]];
      assert(to[i] < corners.size());  // known for the neighbours of unchanged vertices
    }
  }
}

void VertexFans::renumber(const VertexFans& before,
                          const std::vector<std::uint32_t>& new_places,
                          const std::vector<std::uint32_t>& old_places) {
  std::uint32_t num_spokes = 0;
  assert(new_places.size() == size() && old_places.size() == size());
  for (std::size_t i = 0; i < old_places.size(); ++i) {
    assert(new_places[old_places[i]] == i);
    const VertexFan fan = before[old_places[i]];
    first_[i] = num_spokes;
    closed_[i] = fan.is_closed;
    for (std::uint32_t k = 0; k < fan.count; ++k)
      spokes_[num_spokes++] = new_places[fan.spokes[k]];
  }
  assert(num_spokes == spokes_.size());
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
