// SPDX-License-Identifier: BSD-3-Clause
#include "manager.h"

#include <pybind11/stl.h>

#include "classes.h"
#include "queries.h"

namespace fcl_ccd {
namespace python {
namespace {

py::tuple toTuple(fcl::ContinuousPairResult<double>& pair) {
  const auto& o1 = *static_cast<const ManagedObject*>(pair.o1);
  const auto& o2 = *static_cast<const ManagedObject*>(pair.o2);
  const py::tuple read1 = o1.read(), read2 = &o1 == &o2 ? read1 : o2.read();
  return py::make_tuple(o1.name(), o2.name(), fieldsOfPair(pair.result), read1, read2);
}

}  // namespace

py::dict fieldsOfPair(fcl::ContinuousContactResultd& result) {
  const auto pose = [](const fcl::Transform3d& tf) {
    return toArray(fcl::detail::toNumbers<double>(tf));
  };
  py::dict fields = fieldsOf({result.is_collide, result.time_of_contact, 0, 0},
                             std::move(static_cast<Contacts&>(result)));
  fields["contact_tf1"] = pose(result.contact_tf1);
  fields["contact_tf2"] = pose(result.contact_tf2);
  return fields;
}

py::dict fieldsOf(FclResult& result) {
  using py::literals::operator""_a;
  py::list pairs;
  for (auto& pair : result.pairs) pairs.append(toTuple(pair));
  return py::dict("is_collide"_a = result.is_collide,
                  "time_of_contact"_a = result.time_of_contact, "pairs"_a = pairs,
                  "num_box_pairs"_a = result.num_box_pairs,
                  "num_tested"_a = result.num_tested);
}

py::dict fieldsOf(const FclDistance& nearest) {
  using py::literals::operator""_a;
  const auto nameOf = [](const fcl::ContinuousCollisionObjectd* object) -> py::object {
    return object ? static_cast<const ManagedObject*>(object)->name() : py::none();
  };
  return py::dict("o1"_a = nameOf(nearest.o1), "o2"_a = nameOf(nearest.o2),
                  "result"_a = fieldsOf(nearest.result),
                  "num_tested"_a = nearest.num_tested);
}

void bindManager(py::module_& module) {
  Class<ManagedObject>(module, "ManagedObject", seenByCollector<ManagedObject>())
      .def("_last_pose", [](const ManagedObject& object) {
        return toArray(fcl::detail::toNumbers<double>(object.lastPose()));
      });
  Class<Manager>(module, "Manager", seenByCollector<Manager>())
      .def(py::init<>())
      .def("_insert", &Manager::insert)
      .def("_remove", &Manager::remove)
      .def("_update", &Manager::update)
      .def("_set_filter", &Manager::setFilter)
      .def("_set_self_collision", &Manager::setSelfCollision)
      .def("_set_thickness", &Manager::setThickness)
      .def("_set_min_approach_speed", &Manager::setMinApproachSpeed)
      .def("_set_pair_distance", &Manager::setPairDistance)
      .def("_ask_all", &Manager::askAll<Request>)
      .def("_ask_all", &Manager::askAll<DistanceRequest>)
      .def("_ask_one", &Manager::askOne<Request>)
      .def("_ask_one", &Manager::askOne<DistanceRequest>)
      .def("_ask_geometry", &Manager::askGeometry<Request>)
      .def("_ask_geometry", &Manager::askGeometry<DistanceRequest>)
      .def("_ask_manager", &Manager::askManager<Request>)
      .def("_ask_manager", &Manager::askManager<DistanceRequest>);
}

}  // namespace python
}  // namespace fcl_ccd
