// SPDX-License-Identifier: BSD-3-Clause
//
// Robots, as Python has them.
#include "fcl/broadphase/collision_robot.h"

#include <pybind11/stl.h>

#include <cstdint>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "classes.h"
#include "manager.h"
#include "queries.h"

namespace fcl_ccd {
namespace python {
namespace {

using FclRobot = fcl::CollisionRobotd;
using FclEdge = fcl::RobotEdgeResultd;

class Robot : public Guarded {
 public:
  Robot(const fcl::JointChain& chain, const std::vector<std::string>& names)
      : Guarded("robot"), robot_(chain, names) {}

  int attach(int link, py::object owner, const Doubles& origin,
             const std::vector<int>& touch_links) {
    const Writing writing(*this);
    const auto& geometry = py::cast<const Geometry&>(owner);
    const Reading reading(geometry);
    const int part =
        robot_.attach(link, borrow(geometry), toTransform(origin, "origin"), touch_links);
    try {
      parts_.emplace(part, Part{std::move(owner), geometry.numUpdates()});
    } catch (...) {
      robot_.detach(part);
      throw;
    }
    return part;
  }

  void detach(int part) {
    const Writing writing(*this);
    robot_.detach(part);
    // Python may run when the last owner goes. The table is in order then.
    const auto place = parts_.find(part);
    const py::object owner = std::move(place->second.owner);
    parts_.erase(place);
  }

  void update() {
    const Writing writing(*this);
    Reading reading;
    for (const auto& part : parts_) reading.add(part.second.geometry());
    robot_.update();
    for (auto& part : parts_)
      part.second.num_updates = part.second.geometry().numUpdates();
  }

  void allow(int link1, int link2) {
    const Writing writing(*this);
    robot_.allow(link1, link2);
  }
  void allowNeighbours() {
    const Writing writing(*this);
    robot_.allowNeighbours();
  }
  void setFilter(int link, std::uint32_t group, std::uint32_t mask) {
    const Writing writing(*this);
    robot_.setFilter(link, group, mask);
  }
  std::string nameOf(int link) const { return robot_.nameOf(link); }

  py::dict check(const fcl::ChainMotion& motion, const Manager* obstacles,
                 const Request& request) const {
    Reading reading(*this);
    for (const auto& part : parts_) {
      reading.add(part.second.geometry());
      if (part.second.isOutOfDate())
        throw std::runtime_error(
            "the mesh of part " + std::to_string(part.first) +
            " was updated after the robot had read it. Call the robot's update()");
    }
    if (obstacles) obstacles->addAll(reading);
    FclEdge result;
    {
      TriangleFilter filter(request);
      const py::gil_scoped_release release;
      filter.run([&] {
        robot_.checkMotion(motion, obstacles ? &obstacles->manager() : nullptr,
                           filter.request(), result);
      });
    }
    return fieldsOfEdge(result);
  }

  template <typename Visit>
  void visit(const Visit& visit) const {
    for (const auto& part : parts_) visit(part.second.owner);
  }

 private:
  struct Part {
    py::object owner;
    /// Of the mesh, when the robot read it.
    std::uint64_t num_updates;

    const Geometry& geometry() const { return py::cast<const Geometry&>(owner); }
    bool isOutOfDate() const { return num_updates != geometry().numUpdates(); }
  };

  /// What the robot has read: the mesh or shape, and its step.
  py::tuple read(int number) const {
    const Part& part = parts_.at(number);
    return py::make_tuple(part.owner, part.num_updates);
  }

  py::dict fieldsOfEdge(FclEdge& result) const {
    using py::literals::operator""_a;
    py::list pairs;
    for (auto& pair : result.pairs) {
      const auto* object = static_cast<const ManagedObject*>(pair.object);
      pairs.append(py::make_tuple(pair.part1, pair.link1,
                                  object ? object->name() : py::none(), pair.part2,
                                  pair.link2, fieldsOfPair(pair.result), read(pair.part1),
                                  object ? object->read() : read(pair.part2)));
    }
    return py::dict(
        "is_free"_a = result.is_free, "time_of_contact"_a = result.time_of_contact,
        "joint_values"_a = result.joint_values, "pairs"_a = pairs,
        "num_box_pairs"_a = result.num_box_pairs, "num_tested"_a = result.num_tested);
  }

  FclRobot robot_;
  std::map<int, Part> parts_;
};

}  // namespace

void bindRobots(py::module_& module) {
  Class<Robot>(module, "Robot", seenByCollector<Robot>())
      .def(py::init<const fcl::JointChain&, const std::vector<std::string>&>())
      .def("_attach", &Robot::attach)
      .def("_detach", &Robot::detach)
      .def("_update", &Robot::update)
      .def("_allow", &Robot::allow)
      .def("_allow_neighbours", &Robot::allowNeighbours)
      .def("_set_filter", &Robot::setFilter)
      .def("_name_of", &Robot::nameOf)
      .def("_check", &Robot::check);
}

}  // namespace python
}  // namespace fcl_ccd
