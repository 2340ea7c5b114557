// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/stl.h>

#include <limits>
#include <optional>
#include <stdexcept>

#include "arrays.h"
#include "classes.h"
#include "fcl/narrowphase/continuous_contact.h"
#include "fcl/narrowphase/detail/query_numbers.h"
#include "meshes.h"
#include "motions.h"
#include "queries.h"
#include "requests.h"

namespace fcl_ccd {
namespace python {

using Contact = fcl::ContinuousContact<double>;
template <>
py::dtype makeDtype<Contact>() {
  return RecordType<Contact>()
      .field("kind", "<i4", &Contact::kind)
      .field("b1", "<i8", &Contact::b1)
      .field("b2", "<i8", &Contact::b2)
      .field("part1", "<i4", &Contact::part1)
      .field("part2", "<i4", &Contact::part2)
      .field("vertices", "(5,)<i4", &Contact::vertices)
      .field("first_on_o1", "?", &Contact::first_on_o1)
      .field("within_tolerance", "?", &Contact::within_tolerance)
      .field("toc_lo", "<f8", &Contact::toc_lo)
      .field("toc_hi", "<f8", &Contact::toc_hi)
      .field("pos", "(3,)<f8", &Contact::pos)
      .field("normal", "(3,)<f8", &Contact::normal)
      .field("penetration_depth", "<f8", &Contact::penetration_depth)
      .dtype();
}

namespace {

fcl::ContinuousQuery toQuery(const std::string& name) {
  if (name == "all") return fcl::ContinuousQuery::kAll;
  if (name == "first") return fcl::ContinuousQuery::kFirst;
  if (name == "any") return fcl::ContinuousQuery::kAny;
  throw py::value_error("query is '" + name + "'. Give 'all', 'first' or 'any'");
}

py::dict countsOf(const fcl::StageCounts& counts) {
  using py::literals::operator""_a;
  return py::dict(
      "node_pairs"_a = counts.node_pairs, "triangle_pairs"_a = counts.triangle_pairs,
      "adjacent_pairs"_a = counts.adjacent_pairs, "fan_culled"_a = counts.fan_culled,
      "plane_culled"_a = counts.plane_culled, "feature_pairs"_a = counts.feature_pairs,
      "box_culled"_a = counts.box_culled, "mask_culled"_a = counts.mask_culled,
      "filter_culled"_a = counts.filter_culled, "solver_culled"_a = counts.solver_culled,
      "exact_culled"_a = counts.exact_culled, "exact_tests"_a = counts.exact_tests,
      "contacts"_a = counts.contacts, "crossing_tests"_a = counts.crossing_tests);
}

}  // namespace

py::dict fieldsOf(const Outcome& outcome, Contacts&& contacts) {
  using py::literals::operator""_a;
  std::vector<Contact> crossing;
  if (contacts.initially_crossing) crossing.push_back(contacts.crossing);
  return py::dict("is_collide"_a = outcome.is_collide,
                  "time_of_contact"_a = outcome.toc_lo,
                  "contacts"_a = toArray(std::move(contacts.contacts)),
                  "contacts_cut"_a = contacts.contacts_cut,
                  "initially_crossing"_a = contacts.initially_crossing,
                  "crossing"_a = toArray(std::move(crossing)),
                  "crossings"_a = toArray(std::move(contacts.crossings)),
                  "is_triangle_soup"_a = contacts.is_triangle_soup,
                  "counts"_a = countsOf(contacts.counts),
                  "times"_a = py::dict("update"_a = contacts.times.update,
                                       "traverse"_a = contacts.times.traverse,
                                       "test"_a = contacts.times.test));
}

namespace {

/// Runs ask(request, outcome, contacts) without the GIL.
template <typename Ask>
py::dict answer(const Request& request, const Ask& ask) {
  Outcome outcome{};
  Contacts contacts;
  {
    TriangleFilter filter(request);
    const py::gil_scoped_release release;
    filter.run([&] { ask(filter.request(), outcome, contacts); });
  }
  return fieldsOf(outcome, std::move(contacts));
}

py::dict collideSelf(const Mesh& o, const Request& request) {
  const Geometry::Reading reading(o);
  py::dict result =
      answer(request, [&](const auto& asked, auto& outcome, auto& contacts) {
        fcl::detail::answerSelf(&o.geometry(), asked, outcome, &contacts);
      });
  return result;
}

py::dict collidePair(const Geometry& o1, const Motion& motion1, const Geometry& o2,
                     const Motion& motion2, const Request& request) {
  const Geometry::Reading reading1(o1), reading2(o2);
  const auto moving1 = motion1.of(o1.geometry()), moving2 = motion2.of(o2.geometry());
  double pose_time = 1;
  py::dict result =
      answer(request, [&](const auto& asked, auto& outcome, auto& contacts) {
        if (!fcl::detail::answerPair(moving1, moving2, asked, outcome, &contacts))
          fcl::detail::refuseContacts(moving1, moving2);
        pose_time = outcome.is_collide ? outcome.pose_time : 1;
      });
  const bool is_collide = py::cast<bool>(result["is_collide"]);
  const auto pose = [&](const auto& moving) {
    return toArray(is_collide ? fcl::detail::poseAt(moving, pose_time) : moving.pose[1]);
  };
  result["contact_tf1"] = pose(moving1);
  result["contact_tf2"] = pose(moving2);
  return result;
}

fcl::ContinuousFilter makeFilter(std::uint32_t group, std::uint32_t mask,
                                 std::vector<std::uint32_t> triangle_groups,
                                 std::vector<std::uint32_t> triangle_masks) {
  return {group, mask, std::move(triangle_groups), std::move(triangle_masks)};
}

Request makeRequest(const std::string& query, double toc_err,
                    std::optional<std::size_t> num_max_contacts, bool enable_contact,
                    double t_max, bool enable_crossings,
                    const fcl::ContinuousFilter& filter1,
                    const fcl::ContinuousFilter& filter2, py::object accepts_triangles,
                    int num_threads, double min_distance, bool ignore_initially_closer,
                    double min_approach_speed) {
  Request request;
  request.fields.query = toQuery(query);
  request.fields.toc_err = toc_err;
  request.fields.num_max_contacts =
      num_max_contacts.value_or(std::numeric_limits<std::size_t>::max());
  request.fields.enable_contact = enable_contact;
  request.fields.t_max = t_max;
  request.fields.enable_crossings = enable_crossings;
  request.fields.num_threads = num_threads;
  request.fields.min_distance = min_distance;
  request.fields.ignore_initially_closer = ignore_initially_closer;
  request.fields.min_approach_speed = min_approach_speed;
  request.fields.filter1 = filter1;
  request.fields.filter2 = filter2;
  request.accepts_triangles = std::move(accepts_triangles);
  return request;
}

}  // namespace

void bindCollisions(py::module_& module) {
  module.attr("contact_dtype") = dtypeOf<Contact>();
  Class<fcl::ContinuousFilter>(module, "Filter")
      .def(py::init(&makeFilter), py::arg("group"), py::arg("mask"),
           py::arg("triangle_groups"), py::arg("triangle_masks"))
      .def_readonly("group", &fcl::ContinuousFilter::group)
      .def_readonly("mask", &fcl::ContinuousFilter::mask)
      .def_readonly("_triangle_groups", &fcl::ContinuousFilter::triangle_groups)
      .def_readonly("_triangle_masks", &fcl::ContinuousFilter::triangle_masks);
  Class<Request>(module, "Request")
      .def(py::init(&makeRequest), py::arg("query"), py::arg("toc_err"),
           py::arg("num_max_contacts"), py::arg("enable_contact"), py::arg("t_max"),
           py::arg("enable_crossings"), py::arg("filter1"), py::arg("filter2"),
           py::arg("accepts_triangles"), py::arg("num_threads"), py::arg("min_distance"),
           py::arg("ignore_initially_closer"), py::arg("min_approach_speed"));
  module.def("self_collide", &collideSelf);
  module.def("collide", &collidePair);
}

}  // namespace python
}  // namespace fcl_ccd
