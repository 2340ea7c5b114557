// SPDX-License-Identifier: BSD-3-Clause
#include "mesh_model.h"

#include <stdexcept>

namespace fcl_ccd {
namespace {

void requireSuccess(int code, const std::string& error, const std::string& mesh) {
  if (code != fcl::BVH_OK) throw std::runtime_error(mesh + ": " + error);
}

void addFree(const FreeElements& free, MeshInput& input) {
  using fcl::PrimitiveKind;
  std::vector<fcl::Primitive> points;
  for (std::size_t i = 0; i < free.edges.size(); ++i) {
    const auto from = static_cast<std::size_t>(free.edges[i][0]),
               to = static_cast<std::size_t>(free.edges[i][1]);
    if (from == to)
      input.points.push_back(from);
    else
      input.edges.push_back({from, to});
    (from == to ? points : input.free).push_back({PrimitiveKind::kFreeEdge, i});
  }
  for (std::size_t i = 0; i < free.points.size(); ++i) {
    input.points.push_back(static_cast<std::size_t>(free.points[i]));
    points.push_back({PrimitiveKind::kFreePoint, i});
  }
  input.free.insert(input.free.end(), points.begin(), points.end());
}

}  // namespace

MeshInput toInput(const Vertices& vertices, const Triangles& triangles,
                  const FreeElements* free) {
  MeshInput input;
  input.vertices.reserve(vertices.size());
  for (const auto& p : vertices) input.vertices.emplace_back(p[0], p[1], p[2]);
  input.triangles.reserve(triangles.size());
  for (const auto& t : triangles)
    input.triangles.emplace_back(static_cast<std::size_t>(t[0]),
                                 static_cast<std::size_t>(t[1]),
                                 static_cast<std::size_t>(t[2]));
  if (free != nullptr) addFree(*free, input);
  return input;
}

MeshModel buildModel(const MeshInput& input, const std::string& name, int num_threads) {
  MeshModel mesh{std::make_unique<MeshModel::Model>(), input.free};
  MeshModel::Model& model = *mesh.model;
  requireSuccess(model.setNumThreads(num_threads), model.lastError(), name);
  requireSuccess(model.beginModel(static_cast<int>(input.triangles.size()),
                                  static_cast<int>(input.vertices.size())),
                 model.lastError(), name);
  requireSuccess(
      model.addSubModel(input.vertices, input.triangles, input.edges, input.points),
      model.lastError(), name);
  const int code = model.endModel(fcl::FclTree::kSkip);
  requireSuccess(code, model.lastError(), name);
  return mesh;
}

void updateModel(MeshModel::Model& model, const Vertices& from, const Vertices& to,
                 const std::string& name) {
  if (&from == &to && !model.isDeforming()) return;
  const int code = model.updateFrames(from.data()->data(), to.data()->data(), to.size(),
                                      fcl::FclTree::kSkip);
  requireSuccess(code, model.lastError(), name);
}

}  // namespace fcl_ccd
