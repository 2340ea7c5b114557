// SPDX-License-Identifier: BSD-3-Clause
#include "arrays.h"
#include "classes.h"
#include "fcl/narrowphase/continuous_distance.h"
#include "meshes.h"
#include "motions.h"
#include "queries.h"
#include "requests.h"

namespace fcl_ccd {
namespace python {

fcl::ContinuousDistanceRequestd DistanceRequest::of(
    const fcl::ContinuousContactRequestd& from) const {
  fcl::ContinuousDistanceRequestd request;
  request.abs_err = abs_err;
  request.rel_err = rel_err;
  request.max_distance = max_distance;
  request.t_max = from.t_max;
  request.toc_err = from.toc_err;
  request.filter1 = from.filter1;
  request.filter2 = from.filter2;
  request.accepts_triangles = from.accepts_triangles;
  request.num_threads = from.num_threads;
  return request;
}

py::dict fieldsOf(const fcl::ContinuousDistanceResultd& found) {
  using py::literals::operator""_a;
  py::array_t<double> points({2, 3});
  for (int k = 0; k < 2; ++k)
    for (int i = 0; i < 3; ++i)
      points.mutable_at(k, i) = found.nearest_points[static_cast<std::size_t>(k)][i];
  return py::dict("distance_lo"_a = found.distance_lo,
                  "distance_hi"_a = found.distance_hi, "time"_a = found.time,
                  "nearest_points"_a = points, "b1"_a = found.b1, "b2"_a = found.b2,
                  "part1"_a = found.part1, "part2"_a = found.part2,
                  "is_collide"_a = found.is_collide, "is_cut_off"_a = found.is_cut_off);
}

namespace {

DistanceRequest makeDistanceRequest(const Request& contacts, double abs_err,
                                    double rel_err, double max_distance) {
  return {contacts, abs_err, rel_err, max_distance};
}

py::dict distanceOfPair(const Geometry& o1, const Motion& motion1, const Geometry& o2,
                        const Motion& motion2, const DistanceRequest& request) {
  const Geometry::Reading reading1(o1), reading2(o2);
  const auto moving1 = motion1.of(o1.geometry()), moving2 = motion2.of(o2.geometry());
  fcl::ContinuousDistanceResultd found;
  {
    TriangleFilter filter(request.contacts);
    const py::gil_scoped_release release;
    filter.run([&] {
      fcl::detail::answerDistance(moving1, moving2, request.of(filter.request()), found);
    });
  }
  return fieldsOf(found);
}

}  // namespace

void bindDistances(py::module_& module) {
  Class<DistanceRequest>(module, "DistanceRequest")
      .def(py::init(&makeDistanceRequest), py::arg("contacts"), py::arg("abs_err"),
           py::arg("rel_err"), py::arg("max_distance"));
  module.def("distance", &distanceOfPair);
}

}  // namespace python
}  // namespace fcl_ccd
