// SPDX-License-Identifier: BSD-3-Clause
#include "brute_force.h"

#include <algorithm>
#include <array>
#include <set>

#include "fcl/narrowphase/continuous_features.h"
#include "mesh_generators.h"

namespace fcl {
namespace test {

using detail::deformable::FeaturePoints;
using detail::deformable::VertexPath;
using fcl::ContinuousContactKind;

bool doTouch(ContinuousContactKind kind, const FeaturePoints& x) {
  Vector3<double> p[4], q[4];
  for (int i = 0; i < 4; ++i) {
    p[i] = Vector3<double>(x[i].t0);
    q[i] = Vector3<double>(x[i].t1);
  }
  const auto result =
      kind == ContinuousContactKind::kVertexFace
          ? vertexFace<double>(p[0], p[1], p[2], p[3], q[0], q[1], q[2], q[3], 1)
          : edgeEdge<double>(p[0], p[1], p[2], p[3], q[0], q[1], q[2], q[3], 1);
  return result.is_contact;
}

std::vector<PairName> bruteForceSelfContacts(const FramePairMesh& mesh) {
  std::vector<VertexPath> paths;
  for (std::size_t i = 0; i < mesh.previous.size(); ++i) {
    const auto &p = mesh.previous[i], &q = mesh.current[i];
    paths.push_back({{p[0], p[1], p[2]}, {q[0], q[1], q[2]}});
  }
  std::vector<PairName> found;
  const auto test = [&](ContinuousContactKind kind, std::array<int, 4> v) {
    for (std::size_t i = 0; i < (kind == ContinuousContactKind::kVertexFace ? 1 : 2); ++i)
      for (std::size_t j = i + 1; j < 4; ++j)
        if (v[i] == v[j] && (kind == ContinuousContactKind::kVertexFace || j >= 2))
          return;
    const auto path = [&](std::size_t i) {
      return &paths[static_cast<std::size_t>(v[i])];
    };
    if (doTouch(kind, {{path(0), path(1), path(2), path(3)}}))
      found.push_back(pairName(kind == ContinuousContactKind::kVertexFace
                                   ? ContinuousContactKind::kVertexFace
                                   : ContinuousContactKind::kEdgeEdge,
                               v));
  };
  std::set<int> vertices;
  for (const Triangle& t : mesh.triangles)
    for (int k = 0; k < 3; ++k) vertices.insert(static_cast<int>(t[k]));
  for (const Triangle& t : mesh.triangles)
    for (const int v : vertices)
      test(ContinuousContactKind::kVertexFace,
           {v, static_cast<int>(t[0]), static_cast<int>(t[1]), static_cast<int>(t[2])});
  const auto edges = uniqueEdges(mesh.triangles);
  for (std::size_t i = 0; i < edges.size(); ++i)
    for (std::size_t j = i + 1; j < edges.size(); ++j)
      test(ContinuousContactKind::kEdgeEdge,
           {edges[i][0], edges[i][1], edges[j][0], edges[j][1]});
  std::sort(found.begin(), found.end());
  return found;
}

}  // namespace test
}  // namespace fcl
