// SPDX-License-Identifier: BSD-3-Clause
//
// Meshes of files as models of the library.
#ifndef FCL_CCD_MESH_MODEL_H
#define FCL_CCD_MESH_MODEL_H

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "fcl/math/bv/AABB.h"
#include "mesh_io.h"

namespace fcl_ccd {

/// @brief A mesh in FCL's own types.
struct MeshInput {
  std::vector<fcl::Vector3d> vertices;
  std::vector<fcl::Triangle> triangles;
  std::vector<fcl::FreeEdge> edges;
  std::vector<std::size_t> points;
  /// What the model's numbers of free edges and points stand for in the file.
  std::vector<fcl::Primitive> free;
};

/// @brief An edge whose ends were joined becomes a point.
/// @param free  null: nothing is free
MeshInput toInput(const Vertices& vertices, const Triangles& triangles,
                  const FreeElements* free);

/// @brief A mesh of the library.
struct MeshModel {
  using Model = fcl::DeformableBVHModel<fcl::AABBd>;

  std::unique_ptr<Model> model;
  /// What the numbers of contacts from the triangles on stand for.
  std::vector<fcl::Primitive> free;
};

/// @param name  begins the message
/// @throws std::runtime_error if the library refuses the mesh
MeshModel buildModel(const MeshInput& input, const std::string& name, int num_threads);

/// @brief Gives a model both frames of a step. If both are the same object, it rests.
/// @throws std::runtime_error as buildModel()
void updateModel(MeshModel::Model& model, const Vertices& from, const Vertices& to,
                 const std::string& name);

}  // namespace fcl_ccd

#endif
