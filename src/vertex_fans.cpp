// SPDX-License-Identifier: BSD-3-Clause
#include "fcl/narrowphase/detail/deformable/vertex_fans.h"

#include "parallel.h"
#include "vertex_corners.h"

namespace fcl {
namespace detail {
namespace deformable {

VertexFans::VertexFans(const std::vector<TreeTriangle>& triangles,
                       std::size_t num_vertices)
    : VertexFans(VertexCorners(triangles, num_vertices, 1), 1) {}

VertexFans::VertexFans(const VertexCorners& corners, int num_threads)
    : first_(corners.size() + 1), closed_(corners.size()) {
  std::uint32_t num_spokes = 0;
  for (std::size_t v = 0; v < corners.size(); ++v) {
    const CornersAtVertex at = corners[v];
    first_[v] = num_spokes;
    closed_[v] = at.kind == CornersAtVertex::kClosedFan;
    if (at.kind != CornersAtVertex::kNoFan) num_spokes += at.count + !closed_[v];
  }
  first_[corners.size()] = num_spokes;
  spokes_.resize(num_spokes);
  constexpr std::size_t kBlock = 4096;
  parallelForBlocks(corners.size(), kBlock, num_threads,
                    [&](std::size_t v, std::size_t last) {
                      for (; v < last; ++v) {
                        const CornersAtVertex at = corners[v];
                        std::uint32_t* to = spokes_.data() + first_[v];
                        if (at.kind == CornersAtVertex::kNoFan) continue;
                        for (std::uint32_t i = 0; i < at.count; ++i)
                          *to++ = at.corners[i].next;
                        if (at.kind == CornersAtVertex::kOpenFan)
                          *to = at.corners[at.count - 1].last;
                      }
                    });
}

void VertexFans::renumber(const VertexFans& before,
                          const std::vector<std::uint32_t>& new_places,
                          const std::vector<std::uint32_t>& old_places) {
  std::uint32_t num_spokes = 0;
  for (std::size_t i = 0; i < old_places.size(); ++i) {
    const VertexFan fan = before[old_places[i]];
    first_[i] = num_spokes;
    closed_[i] = fan.is_closed;
    for (std::uint32_t k = 0; k < fan.count; ++k)
      spokes_[num_spokes++] = new_places[fan.spokes[k]];
  }
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
