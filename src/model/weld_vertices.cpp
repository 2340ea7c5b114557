// SPDX-License-Identifier: BSD-3-Clause
#include "fcl/geometry/bvh/weld_vertices.h"

#include <cmath>
#include <string>

#include "base/default_floating_point.h"
#include "fcl/common/exception.h"
#include "mesh/mesh_topology.h"
#include "mesh/vertex_weld.h"
#include "model/coordinate_arrays.h"

namespace fcl {
namespace {

template <typename S>
void requireFrames(const std::vector<const S*>& frames, std::size_t num_vertices) {
  using namespace detail::deformable;
  if (frames.empty())
    throw Exception("weldVertices: there is no frame: give at least one");
  const std::string too_many = findTooMany(0, num_vertices);
  if (!too_many.empty()) throw Exception("weldVertices: " + too_many);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const std::string frame = "weldVertices: frame " + std::to_string(i);
    if (!frames[i]) throw Exception(frame + " is null");
    const std::size_t bad = findNotFinite(frames[i], num_vertices, 1);
    if (bad < num_vertices)
      throw Exception(frame + ": vertex " + std::to_string(bad) +
                      " is not finite: correct its coordinates");
  }
}

}  // namespace

template <typename S>
std::vector<int> weldVertices(const std::vector<const S*>& frames,
                              std::size_t num_vertices, S eps) {
  if (!(eps >= 0) || !std::isfinite(eps))
    throw Exception("weldVertices: eps is " + std::to_string(eps) +
                    ": give a distance that is finite and not negative");
  requireFrames(frames, num_vertices);
  const detail::deformable::DefaultFloatingPoint mode;
  detail::deformable::VertexWeld weld(num_vertices, static_cast<double>(eps));
  weld.refineByAll(frames.size(), [&](std::size_t i) { return weld.refine(frames[i]); });
  return weld.map();
}

template std::vector<int> weldVertices(const std::vector<const double*>&, std::size_t,
                                       double);
template std::vector<int> weldVertices(const std::vector<const float*>&, std::size_t,
                                       float);

}  // namespace fcl
