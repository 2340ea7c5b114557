// SPDX-License-Identifier: BSD-3-Clause
#include <cassert>

#include "moment.h"

#include "contact_text.h"

namespace fcl_ccd {
namespace {

void append(const Triangles& triangles, const FreeElements* free, int offset,
            Mesh& whole) {
  for (const auto& t : triangles)
    whole.triangles.push_back({t[0] + offset, t[1] + offset, t[2] + offset});
  if (free == nullptr) return;
  for (const auto& edge : free->edges)
    whole.edges.push_back({edge[0] + offset, edge[1] + offset});
}

void append(const Vertices& from, const Vertices& to, double time, Vertices& whole) {
  assert(from.size() == to.size());
  for (std::size_t v = 0; v < from.size(); ++v) {
    auto& p = whole.emplace_back();
    for (std::size_t k = 0; k < 3; ++k)
      // To the bit the positions of the frames at 0 and 1.
      p[k] = (1 - time) * from[v][k] + time * to[v][k];
  }
}

}  // namespace

Vertices verticesAt(const SceneFrame& from, const SceneFrame& to, double time) {
  Vertices whole;
  whole.reserve(from.a->size() + (from.b != nullptr ? from.b->size() : 0));
  append(*from.a, *to.a, time, whole);
  if (from.b != nullptr) append(*from.b, *to.b, time, whole);
  return whole;
}

Mesh meshAt(const SceneTriangles& triangles, const SceneFrame& from, const SceneFrame& to,
            double time) {
  Mesh whole;
  whole.vertices = verticesAt(from, to, time);
  append(*triangles.a, triangles.free_a, 0, whole);
  if (from.b != nullptr)
    append(*triangles.b, triangles.free_b, static_cast<int>(from.a->size()), whole);
  return whole;
}

std::optional<std::size_t> triangleInScene(const SceneContact& contact,
                                           std::size_t feature,
                                           const SceneTriangles& triangles) {
  if (contact.triangle_kinds[feature] != fcl::PrimitiveKind::kTriangle)
    return std::nullopt;
  assert(contact.triangles[feature] >= 0);
  return static_cast<std::size_t>(contact.triangles[feature]) +
         (isOfB(contact, feature) ? triangles.a->size() : 0);
}

}  // namespace fcl_ccd
