// SPDX-License-Identifier: BSD-3-Clause
#include "meshes.h"

#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "classes.h"
#include "errors.h"
#include "fcl/geometry/bvh/weld_vertices.h"

namespace fcl_ccd {
namespace python {
namespace {

using fcl::FreeEdge;
using fcl::Triangle;
using fcl::Vector3d;

void requireCount(py::ssize_t count, const char* what) {
  constexpr py::ssize_t kMost = py::ssize_t{1} << 29;  // as the library
  if (count > kMost)
    throw py::value_error(std::to_string(count) + " " + what +
                          "; at most 2^29 are allowed");
}

std::string refersTo(std::size_t triangle, std::int64_t vertex,
                     std::size_t num_vertices) {
  return "triangle " + std::to_string(triangle) + " refers to vertex " +
         std::to_string(vertex) + " of " + std::to_string(num_vertices) +
         " vertices, which are numbered from 0";
}

/// FCL's triangles have unsigned numbers, and its own models check none of them.
std::vector<Triangle> toTriangles(const Integers& array, std::size_t num_vertices) {
  requireCount(array.size() / 3, "triangles");
  const auto count = static_cast<std::size_t>(array.size()) / 3;
  const std::int64_t* ids = array.data();
  const auto last = static_cast<std::int64_t>(num_vertices) - 1;
  std::vector<Triangle> triangles;
  triangles.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    // A copy: another thread may write to the array between the check and the use.
    const std::array<std::int64_t, 3> t{ids[3 * i], ids[3 * i + 1], ids[3 * i + 2]};
    for (const std::int64_t vertex : t)
      if (vertex < 0 || vertex > last)
        throw py::value_error(refersTo(i, vertex, num_vertices));
    triangles.emplace_back(static_cast<std::size_t>(t[0]), static_cast<std::size_t>(t[1]),
                           static_cast<std::size_t>(t[2]));
  }
  return triangles;
}

/// The library tells which number is too large; FCL's have no sign.
std::vector<std::size_t> toVertexIds(const Integers& array, const char* what,
                                     std::size_t each) {
  requireCount(array.size() / static_cast<py::ssize_t>(each), what);
  const std::int64_t* ids = array.data();
  std::vector<std::size_t> out(static_cast<std::size_t>(array.size()));
  for (std::size_t i = 0; i < out.size(); ++i) {
    if (ids[i] < 0)
      throw py::value_error(what + (" have vertex " + std::to_string(ids[i])) +
                            ". Vertices are numbered from 0");
    out[i] = static_cast<std::size_t>(ids[i]);
  }
  return out;
}

std::vector<FreeEdge> toEdges(const Integers& array) {
  const std::vector<std::size_t> ids = toVertexIds(array, "free edges", 2);
  std::vector<FreeEdge> edges;
  edges.reserve(ids.size() / 2);
  for (std::size_t i = 0; i + 1 < ids.size(); i += 2)
    edges.push_back({ids[i], ids[i + 1]});
  return edges;
}

std::vector<std::size_t> toPoints(const Integers& array) {
  return toVertexIds(array, "free points", 1);
}

template <typename Model>
void requireOk(int code, const Model& model) {
  if (code != fcl::BVH_OK) throw py::value_error(inPython(model.lastError()));
}

std::size_t numPoints(const Doubles& array) {
  return static_cast<std::size_t>(array.size()) / 3;
}

py::array copyOf(const Vector3d* points, int count) {
  py::array_t<double> out({py::ssize_t{count}, py::ssize_t{3}});
  double* to = out.mutable_data();
  for (int i = 0; i < count; ++i)
    for (int k = 0; k < 3; ++k) *to++ = points[i][k];
  return out;
}

py::array copyOf(const Triangle* triangles, int count) {
  py::array_t<std::int64_t> out({py::ssize_t{count}, py::ssize_t{3}});
  std::int64_t* to = out.mutable_data();
  for (int i = 0; i < count; ++i)
    for (int k = 0; k < 3; ++k) *to++ = static_cast<std::int64_t>(triangles[i][k]);
  return out;
}

py::array edgesOf(const fcl::DeformableBVHModel<>& model) {
  const std::size_t count = model.numFreeEdges();
  py::array_t<std::int64_t> out({static_cast<py::ssize_t>(count), py::ssize_t{2}});
  std::int64_t* to = out.mutable_data();
  for (std::size_t i = 0; i < count; ++i)
    for (const std::size_t vertex : model.freeEdge(i))
      *to++ = static_cast<std::int64_t>(vertex);
  return out;
}

py::array pointsOf(const fcl::DeformableBVHModel<>& model) {
  const std::size_t count = model.numFreePoints();
  py::array_t<std::int64_t> out(static_cast<py::ssize_t>(count));
  for (std::size_t i = 0; i < count; ++i)
    out.mutable_data()[i] = static_cast<std::int64_t>(model.freePoint(i));
  return out;
}

/// What a copy is built from, and its current frame.
py::tuple partsOf(const fcl::DeformableBVHModel<>& model) {
  return py::make_tuple(copyOf(model.prev_vertices, model.num_vertices),
                        copyOf(model.tri_indices, model.num_tris), edgesOf(model),
                        pointsOf(model), model.numThreads(),
                        copyOf(model.vertices, model.num_vertices));
}

/// A property that reads the model, while no update runs.
template <typename MeshType, typename Read>
auto readModel(Read&& read) {
  return [read](const MeshType& mesh) {
    const Geometry::Reading reading(mesh);
    return read(mesh.model());
  };
}

/// The map of the vertices, from frames of the same number of vertices.
Integers weldVertices(const std::vector<Doubles>& frames, double eps) {
  std::vector<const double*> data;
  for (const Doubles& frame : frames) {
    requireSize(frame, static_cast<std::size_t>(frames[0].size()), "frames");
    data.push_back(frame.data());
  }
  const std::size_t num_vertices = frames.empty() ? 0 : numPoints(frames[0]);
  std::vector<int> map;
  {
    const py::gil_scoped_release release;
    map = fcl::weldVertices(data, num_vertices, eps);
  }
  Integers out(static_cast<py::ssize_t>(map.size()));
  std::copy(map.begin(), map.end(), out.mutable_data());
  return out;
}

}  // namespace

std::vector<Vector3d> toVertices(const Doubles& array) {
  requireCount(array.size() / 3, "vertices");
  const double* x = array.data();
  std::vector<Vector3d> vertices;
  vertices.reserve(static_cast<std::size_t>(array.size()) / 3);
  for (py::ssize_t i = 0; i + 2 < array.size(); i += 3)
    vertices.emplace_back(x[i], x[i + 1], x[i + 2]);
  return vertices;
}

DeformableMesh::DeformableMesh(const Doubles& vertices, const Integers& triangles,
                               const Integers& edges, const Integers& points,
                               int num_threads) {
  const py::gil_scoped_release release;
  requireOk(model_.setNumThreads(num_threads), model_);
  const std::vector<Vector3d> positions = toVertices(vertices);
  const std::vector<Triangle> faces = toTriangles(triangles, positions.size());
  model_.beginModel(static_cast<int>(faces.size()), static_cast<int>(positions.size()));
  requireOk(model_.addSubModel(positions, faces, toEdges(edges), toPoints(points)),
            model_);
  requireOk(model_.endModel(fcl::FclTree::kSkip), model_);
}

void DeformableMesh::update(const std::optional<Doubles>& previous,
                            const Doubles& current) {
  const Writing writing(*this);
  const py::gil_scoped_release release;
  if (previous)
    requireSize(*previous, static_cast<std::size_t>(current.size()), "previous");
  // The model's frame is 3 doubles a vertex without gaps.
  static_assert(sizeof(Vector3d) == 3 * sizeof(double), "");
  const double* from = previous ? previous->data() : model_.vertices[0].data();
  requireOk(model_.updateFrames(from, current.data(), numPoints(current)), model_);
}

void DeformableMesh::updateTopology(const Integers& triangles, const Doubles& previous,
                                    const Doubles& current,
                                    const std::vector<int>& origins,
                                    const Integers& edges, const Integers& points) {
  const Writing writing(*this);
  const py::gil_scoped_release release;
  requireSize(previous, static_cast<std::size_t>(current.size()), "previous");
  const std::size_t count = numPoints(current);
  const std::vector<Triangle> faces = toTriangles(triangles, count);
  const bool has_free = model_.numFreeEdges() + model_.numFreePoints() > 0;
  requireOk(
      has_free || edges.size() > 0 || points.size() > 0
          ? model_.updateTopology(faces, toEdges(edges), toPoints(points),
                                  previous.data(), current.data(), count)
          : model_.updateTopology(faces, origins, previous.data(), current.data(), count),
      model_);
}

RigidMesh::RigidMesh(const Doubles& vertices, const Integers& triangles) {
  const py::gil_scoped_release release;
  const std::vector<Vector3d> points = toVertices(vertices);
  const std::vector<Triangle> faces = toTriangles(triangles, points.size());
  // What FCL does not check.
  if (faces.empty()) throw py::value_error("the mesh has no triangles. Give some");
  for (std::size_t i = 0; i < points.size(); ++i)
    if (!points[i].allFinite())
      throw py::value_error("vertex " + std::to_string(i) + " is not finite");
  if (model_.beginModel(static_cast<int>(faces.size()),
                        static_cast<int>(points.size())) != fcl::BVH_OK ||
      model_.addSubModel(points, faces) != fcl::BVH_OK ||
      model_.endModel() != fcl::BVH_OK)
    throw std::bad_alloc();  // the only failure that is left
}

void bindMeshes(py::module_& module) {
  module.def("weld_vertices", &weldVertices, py::arg("frames"), py::arg("eps"));
  Class<Geometry>(module, "Geometry")
      .def_property_readonly("_num_updates", &Geometry::numUpdates);
  Class<Mesh, Geometry>(module, "Mesh");
  using Deformable = DeformableMesh::Model;
  Class<DeformableMesh, Mesh>(module, "DeformableMesh")
      .defInit<const Doubles&, const Integers&, const Integers&, const Integers&, int>(
          py::arg("vertices"), py::arg("triangles"), py::arg("edges"), py::arg("points"),
          py::arg("num_threads"))
      .def("_update", &DeformableMesh::update, py::arg("previous"), py::arg("current"))
      .def("_update_topology", &DeformableMesh::updateTopology, py::arg("triangles"),
           py::arg("previous"), py::arg("current"), py::arg("origins"), py::arg("edges"),
           py::arg("points"))
      .def("_parts", readModel<DeformableMesh>(&partsOf))
      .def_property_readonly(
          "num_vertices",
          readModel<DeformableMesh>([](const Deformable& m) { return m.num_vertices; }))
      .def_property_readonly(
          "num_triangles",
          readModel<DeformableMesh>([](const Deformable& m) { return m.num_tris; }))
      .def_property_readonly(
          "num_edges",
          readModel<DeformableMesh>([](const Deformable& m) { return m.numFreeEdges(); }))
      .def_property_readonly("num_points",
                             readModel<DeformableMesh>(
                                 [](const Deformable& m) { return m.numFreePoints(); }))
      .def_property_readonly("num_restructurings",
                             readModel<DeformableMesh>([](const Deformable& m) {
                               return m.numRestructurings();
                             }))
      .def_property_readonly(
          "is_deforming",
          readModel<DeformableMesh>([](const Deformable& m) { return m.isDeforming(); }))
      .def_property_readonly("previous",
                             readModel<DeformableMesh>([](const Deformable& m) {
                               return copyOf(m.prev_vertices, m.num_vertices);
                             }))
      .def_property_readonly("current",
                             readModel<DeformableMesh>([](const Deformable& m) {
                               return copyOf(m.vertices, m.num_vertices);
                             }))
      .def_property_readonly("triangles",
                             readModel<DeformableMesh>([](const Deformable& m) {
                               return copyOf(m.tri_indices, m.num_tris);
                             }))
      .def_property_readonly("edges", readModel<DeformableMesh>(&edgesOf))
      .def_property_readonly("points", readModel<DeformableMesh>(&pointsOf))
      .def_property_readonly(
          "num_threads",
          readModel<DeformableMesh>([](const Deformable& m) { return m.numThreads(); }));
  Class<RigidMesh, Mesh>(module, "RigidMesh")
      .defInit<const Doubles&, const Integers&>(py::arg("vertices"), py::arg("triangles"))
      .def_property_readonly("num_vertices",
                             [](const RigidMesh& m) { return m.model().num_vertices; })
      .def_property_readonly("num_triangles",
                             [](const RigidMesh& m) { return m.model().num_tris; })
      .def_property_readonly("vertices",
                             [](const RigidMesh& m) {
                               return copyOf(m.model().vertices, m.model().num_vertices);
                             })
      .def_property_readonly("triangles", [](const RigidMesh& m) {
        return copyOf(m.model().tri_indices, m.model().num_tris);
      });
}

}  // namespace python
}  // namespace fcl_ccd
