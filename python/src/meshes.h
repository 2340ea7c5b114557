// SPDX-License-Identifier: BSD-3-Clause
//
// The meshes of the Python module.
#ifndef FCL_CCD_PYTHON_MESHES_H
#define FCL_CCD_PYTHON_MESHES_H

#include <optional>
#include <vector>

#include "arrays.h"
#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "geometry.h"

namespace fcl_ccd {
namespace python {

/// What has triangles, and can be queried with itself and for candidates.
class Mesh : public Geometry {};

class DeformableMesh : public Mesh {
 public:
  using Model = fcl::DeformableBVHModel<>;

  /// @param edges, points  numbers of vertices: two for each free edge, one for each free
  /// point
  DeformableMesh(const Doubles& vertices, const Integers& triangles,
                 const Integers& edges, const Integers& points, int num_threads);

  const fcl::CollisionGeometry<double>& geometry() const override { return model_; }
  const Model& model() const { return model_; }

  void update(const std::optional<Doubles>& previous, const Doubles& current);
  void updateTopology(const Integers& triangles, const Doubles& previous,
                      const Doubles& current, const std::vector<int>& origins,
                      const Integers& edges, const Integers& points);

 private:
  Model model_;
};

class RigidMesh : public Mesh {
 public:
  using Model = fcl::BVHModel<fcl::OBBRSSd>;

  RigidMesh(const Doubles& vertices, const Integers& triangles);

  const fcl::CollisionGeometry<double>& geometry() const override { return model_; }
  const Model& model() const { return model_; }

 private:
  Model model_;
};

std::vector<fcl::Vector3d> toVertices(const Doubles& array);

void bindMeshes(py::module_& module);

}  // namespace python
}  // namespace fcl_ccd

#endif
