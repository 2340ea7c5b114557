// SPDX-License-Identifier: BSD-3-Clause
#include "tree/topology_difference.h"

#include <cassert>

namespace fcl {
namespace detail {
namespace deformable {
namespace {

/// A vertex that was joined from several, or is split into several.
constexpr std::uint32_t kSeveral = TopologyDifference::kNone - 1;

/// Records that x became, or was, y.
void match(std::uint32_t& x, std::uint32_t y) {
  x = x == TopologyDifference::kNone || x == y ? y : kSeveral;
}

#ifndef NDEBUG
/// Whether the place of each vertex that is the same has the id of this vertex.
bool areMutual(const std::vector<std::uint32_t>& vertices,
               const std::vector<std::uint32_t>& new_ids) {
  for (std::uint32_t id = 0; id < vertices.size(); ++id)
    if (vertices[id] != TopologyDifference::kNone &&
        (vertices[id] >= new_ids.size() || new_ids[vertices[id]] != id))
      return false;
  return true;
}
#endif

}  // namespace

TopologyDifference::TopologyDifference(const std::vector<TreeTriangle>& before,
                                       std::size_t num_places_before,
                                       TriangleArray triangles, std::size_t num_triangles,
                                       std::size_t num_vertices,
                                       const std::vector<int>& origins)
    : vertices_(num_vertices, kNone), new_ids_(num_places_before, kNone) {
  findOrigins(before, num_triangles, origins);
  findVertices(before, triangles);
  dropTriangles(before, triangles);
  assert(areMutual(vertices_, new_ids_));
}

/// A triangle is not the same if a triangle with a lower number has the same origin, or
/// an origin with a higher number.
void TopologyDifference::findOrigins(const std::vector<TreeTriangle>& before,
                                     std::size_t num_triangles,
                                     const std::vector<int>& origins) {
  assert(origins.empty() || origins.size() == num_triangles);
  std::vector<std::uint32_t> places(before.size());
  for (std::uint32_t i = 0; i < before.size(); ++i) {
    assert(before[i].index < before.size());
    places[before[i].index] = i;
  }
  origins_.resize(num_triangles);
  is_same_.assign(num_triangles, 0);
  stays_.assign(before.size(), 0);
  int last = -1;
  for (std::size_t i = 0; i < num_triangles; ++i) {
    const int number = static_cast<int>(i);
    const int origin = !origins.empty() ? origins[i] : i < before.size() ? number : -1;
    assert(origin < 0 || static_cast<std::size_t>(origin) < before.size());
    origins_[i] = origin < 0 ? kNone : places[static_cast<std::size_t>(origin)];
    if (origin <= last) continue;
    last = origin;
    is_same_[i] = stays_[origins_[i]] = 1;
  }
}

/// Matches the vertices of the triangles that may be the same.
void TopologyDifference::findVertices(const std::vector<TreeTriangle>& before,
                                      TriangleArray triangles) {
  for (std::size_t i = 0; i < is_same_.size(); ++i) {
    if (!is_same_[i]) continue;
    std::uint32_t ids[3];
    triangles.copyIds(i, ids);
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t place = before[origins_[i]].place[k];
      assert(place < new_ids_.size() && ids[k] < vertices_.size());
      match(new_ids_[place], ids[k]);
      match(vertices_[ids[k]], place);
    }
  }
}

/// Triangles at vertices that were split or joined are not the same. A vertex is not the
/// same if one of the triangles around it is not.
void TopologyDifference::dropTriangles(const std::vector<TreeTriangle>& before,
                                       TriangleArray triangles) {
  for (std::size_t i = 0; i < is_same_.size(); ++i) {
    std::uint32_t ids[3];
    triangles.copyIds(i, ids);
    for (int k = 0; k < 3 && is_same_[i]; ++k)
      if (vertices_[ids[k]] == kSeveral ||
          new_ids_[before[origins_[i]].place[k]] == kSeveral)
        is_same_[i] = stays_[origins_[i]] = 0;
  }
  for (std::uint32_t& id : new_ids_)
    if (id == kSeveral) id = kNone;
  for (std::size_t i = 0; i < is_same_.size(); ++i) {
    if (is_same_[i]) continue;
    std::uint32_t ids[3];
    triangles.copyIds(i, ids);
    for (const std::uint32_t id : ids) vertices_[id] = kNone;
  }
  for (std::size_t i = 0; i < before.size(); ++i) {
    if (stays_[i]) continue;
    for (const std::uint32_t place : before[i].place)
      if (new_ids_[place] != kNone) vertices_[new_ids_[place]] = kNone;
  }
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
