// SPDX-License-Identifier: BSD-3-Clause
#include "shapes.h"

#include <pybind11/stl.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "classes.h"
#include "fcl/geometry/shape/box.h"
#include "fcl/geometry/shape/capsule.h"
#include "fcl/geometry/shape/cone.h"
#include "fcl/geometry/shape/convex.h"
#include "fcl/geometry/shape/cylinder.h"
#include "fcl/geometry/shape/ellipsoid.h"
#include "fcl/geometry/shape/halfspace.h"
#include "fcl/geometry/shape/plane.h"
#include "fcl/geometry/shape/sphere.h"
#include "fcl/geometry/shape/triangle_p.h"
#include "meshes.h"

namespace fcl_ccd {
namespace python {
namespace {

using fcl::Vector3d;

Vector3d toVector(const Doubles& array, const char* name) {
  requireSize(array, 3, name);
  const double* x = array.data();
  return {x[0], x[1], x[2]};
}

py::array toArray(const Vector3d& v) {
  py::array_t<double> out(3);
  for (int k = 0; k < 3; ++k) out.mutable_data()[k] = v[k];
  return out;
}

/// Plane or Halfspace. FCL scales the normal to length 1 with the offset, and takes
/// another plane where that fails.
template <typename Flat>
std::unique_ptr<Shape<Flat>> makeFlat(const Doubles& normal, double offset) {
  const Vector3d n = toVector(normal, "n");
  const double length = n.norm();
  if (!(length > 0 && std::isfinite(length) && std::isnormal(1 / length)))
    throw py::value_error(
        "n has no direction: it is zero, or its length is out of range. Give a vector of "
        "length 1");
  return std::make_unique<Shape<Flat>>(n, offset);
}

std::unique_ptr<Shape<fcl::TriangleP<double>>> makeTriangle(const Doubles& a,
                                                            const Doubles& b,
                                                            const Doubles& c) {
  return std::make_unique<Shape<fcl::TriangleP<double>>>(
      toVector(a, "a"), toVector(b, "b"), toVector(c, "c"));
}

/// FCL's encoding of faces: the number of vertices of a face, then the vertices. FCL
/// checks none of them.
int countFaces(const std::vector<int>& faces, std::size_t num_vertices) {
  int count = 0;
  for (std::size_t i = 0; i < faces.size(); ++count) {
    const auto size = static_cast<std::size_t>(faces[i++]);
    if (size < 3)
      throw py::value_error("face " + std::to_string(count) +
                            " has fewer than 3 vertices");
    if (size > faces.size() - i) throw py::value_error("faces: the last face is cut");
    for (const std::size_t end = i + size; i < end; ++i)
      if (faces[i] < 0 || static_cast<std::size_t>(faces[i]) >= num_vertices)
        throw py::value_error("face " + std::to_string(count) + " refers to vertex " +
                              std::to_string(faces[i]) + " of " +
                              std::to_string(num_vertices) +
                              " vertices, which are numbered from 0");
  }
  return count;
}

std::unique_ptr<Shape<fcl::Convexd>> makeConvex(const Doubles& vertices,
                                                const std::vector<int>& faces) {
  const auto points = std::make_shared<const std::vector<Vector3d>>(toVertices(vertices));
  if (points->empty()) throw py::value_error("the convex has no vertices. Give some");
  const int num_faces = countFaces(faces, points->size());
  return std::make_unique<Shape<fcl::Convexd>>(
      points, num_faces, std::make_shared<const std::vector<int>>(faces));
}

py::array verticesOf(const Shape<fcl::Convexd>& convex) {
  const std::vector<Vector3d>& vertices = convex.shape().getVertices();
  py::array_t<double> out({static_cast<py::ssize_t>(vertices.size()), py::ssize_t{3}});
  double* to = out.mutable_data();
  for (const Vector3d& v : vertices)
    for (int k = 0; k < 3; ++k) *to++ = v[k];
  return out;
}

/// A shape that consists of numbers.
template <typename FclShape>
Class<Shape<FclShape>, Geometry> bindShape(py::module_& module, const char* name) {
  return {module, name};
}

template <typename FclShape, typename Value>
auto readNumber(Value FclShape::*member) {
  return [member](const Shape<FclShape>& shape) { return shape.shape().*member; };
}

template <typename FclShape>
auto readVector(Vector3d FclShape::*member) {
  return
      [member](const Shape<FclShape>& shape) { return toArray(shape.shape().*member); };
}

template <typename FclShape>
void bindRound(py::module_& module, const char* name) {
  bindShape<FclShape>(module, name)
      .def(py::init<double, double>(), py::arg("radius"), py::arg("lz"))
      .def_property_readonly("radius", readNumber(&FclShape::radius))
      .def_property_readonly("lz", readNumber(&FclShape::lz));
}

template <typename Flat>
void bindFlat(py::module_& module, const char* name) {
  bindShape<Flat>(module, name)
      .def(py::init(&makeFlat<Flat>), py::arg("n"), py::arg("d"))
      .def_property_readonly("n", readVector(&Flat::n))
      .def_property_readonly("d", readNumber(&Flat::d));
}

}  // namespace

void bindShapes(py::module_& module) {
  bindShape<fcl::Boxd>(module, "Box")
      .def(py::init<double, double, double>(), py::arg("x"), py::arg("y"), py::arg("z"))
      .def_property_readonly("side", readVector(&fcl::Boxd::side));
  bindShape<fcl::Sphered>(module, "Sphere")
      .def(py::init<double>(), py::arg("radius"))
      .def_property_readonly("radius", readNumber(&fcl::Sphered::radius));
  bindShape<fcl::Ellipsoidd>(module, "Ellipsoid")
      .def(py::init<double, double, double>(), py::arg("a"), py::arg("b"), py::arg("c"))
      .def_property_readonly("radii", readVector(&fcl::Ellipsoidd::radii));
  bindRound<fcl::Capsuled>(module, "Capsule");
  bindRound<fcl::Coned>(module, "Cone");
  bindRound<fcl::Cylinderd>(module, "Cylinder");
  bindShape<fcl::Convexd>(module, "Convex")
      .def(py::init(&makeConvex), py::arg("vertices"), py::arg("faces"))
      .def_property_readonly("vertices", &verticesOf)
      .def_property_readonly(
          "num_faces",
          [](const Shape<fcl::Convexd>& convex) { return convex.shape().getFaceCount(); })
      .def_property_readonly("_faces", [](const Shape<fcl::Convexd>& convex) {
        return convex.shape().getFaces();
      });
  bindFlat<fcl::Planed>(module, "Plane");
  bindFlat<fcl::Halfspaced>(module, "Halfspace");
  using Triangle = fcl::TriangleP<double>;
  bindShape<Triangle>(module, "TriangleP")
      .def(py::init(&makeTriangle), py::arg("a"), py::arg("b"), py::arg("c"))
      .def_property_readonly("a", readVector(&Triangle::a))
      .def_property_readonly("b", readVector(&Triangle::b))
      .def_property_readonly("c", readVector(&Triangle::c));
}

}  // namespace python
}  // namespace fcl_ccd
