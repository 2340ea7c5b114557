// SPDX-License-Identifier: BSD-3-Clause
//
// A Python module of a user that binds FCL's own continuousCollide(). It uses FCL's names
// only, and is linked with -lfcl. python_extension.py calls it.
#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/math/bv/OBBRSS.h>
#include <fcl/narrowphase/continuous_collision.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <array>
#include <memory>
#include <vector>

namespace {

using Model = fcl::BVHModel<fcl::OBBRSSd>;
using Point = std::array<double, 3>;

std::shared_ptr<Model> makeModel(const std::vector<std::array<Point, 3>>& triangles) {
  const auto vector = [](const Point& p) { return fcl::Vector3d(p[0], p[1], p[2]); };
  auto model = std::make_shared<Model>();
  model->beginModel();
  for (const auto& t : triangles)
    model->addTriangle(vector(t[0]), vector(t[1]), vector(t[2]));
  model->endModel();
  return model;
}

/// The time of contact of a model at rest and a model that goes from one place to
/// another.
double timeOfContact(const Model& still, const Model& moving, const Point& from,
                     const Point& to) {
  const fcl::Transform3d rest = fcl::Transform3d::Identity();
  fcl::Transform3d beg = rest, end = rest;
  for (int k = 0; k < 3; ++k) {
    beg.translation()[k] = from[static_cast<std::size_t>(k)];
    end.translation()[k] = to[static_cast<std::size_t>(k)];
  }
  fcl::ContinuousCollisionRequestd request;
  fcl::ContinuousCollisionResultd result;
  fcl::continuousCollide(&still, rest, rest, &moving, beg, end, request, result);
  return result.is_collide ? result.time_of_contact : 1;
}

}  // namespace

PYBIND11_MODULE(fcl_extension, module) {
  pybind11::class_<Model, std::shared_ptr<Model>>(module, "Model")
      .def(pybind11::init(&makeModel));
  module.def("time_of_contact", &timeOfContact);
}
