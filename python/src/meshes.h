// SPDX-License-Identifier: BSD-3-Clause
//
// The meshes of the Python module.
#ifndef FCL_CCD_PYTHON_MESHES_H
#define FCL_CCD_PYTHON_MESHES_H

#include <optional>

#include "arrays.h"
#include "fcl/geometry/bvh/deformable_bvh_model.h"

namespace fcl_ccd {
namespace python {

/// A mesh, and who uses it. Queries and updates run without Python's lock (the GIL), so
/// that two threads of Python may come to one mesh. Any number of queries may read it. An
/// update needs it alone. What would be a data race in C++ is a RuntimeError in Python.
class Mesh {
 public:
  virtual ~Mesh() = default;
  virtual const fcl::CollisionGeometry<double>& geometry() const = 0;

  /// Made and destroyed while the thread has the GIL, which guards the counters.
  class Reading {
   public:
    explicit Reading(const Mesh& mesh);
    ~Reading() { --mesh_.num_readers_; }
    Reading(const Reading&) = delete;
    Reading& operator=(const Reading&) = delete;

   private:
    const Mesh& mesh_;
  };
  class Writing {
   public:
    explicit Writing(const Mesh& mesh);
    ~Writing() { mesh_.is_written_ = false; }
    Writing(const Writing&) = delete;
    Writing& operator=(const Writing&) = delete;

   private:
    const Mesh& mesh_;
  };

 private:
  mutable int num_readers_{0};
  mutable bool is_written_{false};
};

class DeformableMesh : public Mesh {
 public:
  using Model = fcl::DeformableBVHModel<>;

  DeformableMesh(const Doubles& vertices, const Integers& triangles, int num_threads);

  const fcl::CollisionGeometry<double>& geometry() const override { return model_; }
  const Model& model() const { return model_; }

  void update(const std::optional<Doubles>& previous, const Doubles& current);
  void updateTopology(const Integers& triangles, const Doubles& previous,
                      const Doubles& current, const std::vector<int>& origins);

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

void bindMeshes(py::module_& module);

}  // namespace python
}  // namespace fcl_ccd

#endif
