// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/stl.h>

#include <algorithm>
#include <cstddef>
#include <memory>
#include <stdexcept>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "classes.h"
#include "fcl/broadphase/continuous_collision_manager.h"
#include "meshes.h"
#include "motions.h"
#include "queries.h"
#include "requests.h"

namespace fcl_ccd {
namespace python {
namespace {

using FclManager = fcl::ContinuousCollisionManagerd;
using FclRequest = fcl::ContinuousContactRequestd;
using FclResult = fcl::ContinuousManagerResultd;

/// A path, which keeps its functions of Python alive, and FCL's motion on it.
struct FclMotion {
  std::shared_ptr<fcl::MotionBase<double>> motion;
  Motion path;
};

/// FCL's objects do not own what they refer to, and queries do not write to it.
std::shared_ptr<fcl::CollisionGeometry<double>> borrow(const Geometry& geometry) {
  auto* borrowed = const_cast<fcl::CollisionGeometry<double>*>(&geometry.geometry());
  return {std::shared_ptr<void>(), borrowed};
}

/// A mesh or a shape, its motion, and the name that the user gave it.
class ManagedObject : public fcl::ContinuousCollisionObjectd {
 public:
  ManagedObject(py::object name, py::object owner, const Motion& path)
      : fcl::ContinuousCollisionObjectd(borrow(geometryOf(owner))),
        name_(std::move(name)),
        owner_(std::move(owner)),
        geometry_(geometryOf(owner_)) {
    FclMotion made = makeMotion(path);
    swapMotion(made);
    takeNote();
  }

  const py::object& name() const { return name_; }
  const Geometry& geometry() const { return geometry_; }

  FclMotion makeMotion(const Motion& path) const {
    const bool deforms = dynamic_cast<const DeformableMesh*>(&geometry_) != nullptr;
    return {toFclMotion(path, deforms), path};
  }
  void swapMotion(FclMotion& other) {
    motion.swap(other.motion);
    std::swap(path_, other.path);
  }

  template <typename Visit>
  void visit(const Visit& visit) const {
    visit(name_);
    visit(owner_);
    path_.visit(visit);
  }

  /// The manager has read the mesh.
  void takeNote() { num_updates_ = geometry_.numUpdates(); }
  bool isOutOfDate() const { return num_updates_ != geometry_.numUpdates(); }

  /// What the manager has read: the mesh or shape, its path and the step of the mesh.
  py::tuple read() const { return py::make_tuple(owner_, path_, num_updates_); }

 private:
  static const Geometry& geometryOf(const py::object& owner) {
    return py::cast<const Geometry&>(owner);
  }

  py::object name_, owner_;
  Motion path_{};
  const Geometry& geometry_;
  std::uint64_t num_updates_{0};
};

py::tuple toTuple(fcl::ContinuousPairResult<double>& pair) {
  const auto& o1 = *static_cast<const ManagedObject*>(pair.o1);
  const auto& o2 = *static_cast<const ManagedObject*>(pair.o2);
  const auto pose = [](const fcl::Transform3d& tf) {
    return toArray(fcl::detail::toNumbers<double>(tf));
  };
  auto& result = pair.result;
  py::dict fields = fieldsOf({result.is_collide, result.time_of_contact, 0, 0},
                             std::move(static_cast<Contacts&>(result)));
  fields["contact_tf1"] = pose(result.contact_tf1);
  fields["contact_tf2"] = pose(result.contact_tf2);
  const py::tuple read1 = o1.read(), read2 = &o1 == &o2 ? read1 : o2.read();
  return py::make_tuple(o1.name(), o2.name(), fields, read1, read2);
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

class Manager : public Guarded {
 public:
  Manager() : Guarded("manager") {}

  py::object insert(py::object name, py::object geometry, const Motion& motion,
                    const fcl::ContinuousFilter& filter, bool self_collision) {
    const Writing writing(*this);
    py::object owner = py::cast(
        std::make_unique<ManagedObject>(std::move(name), std::move(geometry), motion));
    auto& object = py::cast<ManagedObject&>(owner);
    const Reading reading(object.geometry());
    const auto place = owners_.emplace(&object, owner).first;
    try {
      const py::gil_scoped_release release;
      add(object, filter, self_collision);
    } catch (...) {
      owners_.erase(place);
      throw;
    }
    return owner;
  }

  void remove(ManagedObject& object) {
    const Writing writing(*this);
    const auto place = owners_.find(&object);
    if (place == owners_.end()) throw py::value_error("the object is not registered");
    manager_.unregisterObject(&object);
    // Python may run when the last owner goes. The table is in order then.
    const py::object owner = std::move(place->second);
    owners_.erase(place);
  }

  /// @param objects  each once
  /// @param motions  one for each object; or none: they keep theirs
  void update(const std::vector<ManagedObject*>& objects,
              const std::vector<const Motion*>& motions) {
    const auto is_none = [](const void* p) { return p == nullptr; };
    if (std::any_of(objects.begin(), objects.end(), is_none) ||
        std::any_of(motions.begin(), motions.end(), is_none))
      throw py::type_error("an object or a motion is None");
    const Writing writing(*this);
    Reading reading;
    std::vector<fcl::ContinuousCollisionObjectd*> addresses;
    for (ManagedObject* object : objects) {
      reading.add(object->geometry());
      addresses.push_back(object);
    }
    std::vector<FclMotion> others;
    for (std::size_t i = 0; i < motions.size(); ++i)
      others.push_back(objects.at(i)->makeMotion(*motions[i]));
    const auto swap_motions = [&] {
      for (std::size_t i = 0; i < others.size(); ++i) objects[i]->swapMotion(others[i]);
    };
    swap_motions();
    try {
      const py::gil_scoped_release release;
      manager_.update(addresses);
    } catch (...) {
      swap_motions();
      throw;
    }
    for (ManagedObject* object : objects) object->takeNote();
  }

  void setFilter(ManagedObject& object, const fcl::ContinuousFilter& filter) {
    const Writing writing(*this);
    manager_.setFilter(&object, filter);
  }

  void setSelfCollision(ManagedObject& object, bool enabled) {
    const Writing writing(*this);
    manager_.setSelfCollision(&object, enabled);
  }

  py::dict collideAll(const Request& request) const {
    Reading reading;
    addAll(reading);
    return answer(request, [&](const FclRequest& asked, FclResult& result) {
      manager_.collide(asked, result);
    });
  }

  /// @param object  registered
  py::dict collideOne(ManagedObject& object, const Request& request) const {
    Reading reading;
    addAll(reading);
    return answer(request, [&](const FclRequest& asked, FclResult& result) {
      manager_.collide(&object, asked, result);
    });
  }

  py::dict collideGeometry(const py::object& geometry, const Motion& motion,
                           const Request& request) const {
    ManagedObject object(py::none(), geometry, motion);
    Reading reading(object.geometry());
    addAll(reading);
    return answer(request, [&](const FclRequest& asked, FclResult& result) {
      manager_.collide(&object, asked, result);
    });
  }

  py::dict collideManager(const Manager& other, const Request& request) const {
    Reading reading;
    addAll(reading);
    other.addAll(reading);
    return answer(request, [&](const FclRequest& asked, FclResult& result) {
      manager_.collide(other.manager_, asked, result);
    });
  }

  template <typename Visit>
  void visit(const Visit& visit) const {
    for (const auto& owner : owners_) visit(owner.second);
  }

 private:
  /// Called without the GIL. After an exception the object is not registered.
  void add(ManagedObject& object, const fcl::ContinuousFilter& filter,
           bool self_collision) {
    manager_.registerObject(&object);
    try {
      manager_.setFilter(&object, filter);
      manager_.setSelfCollision(&object, self_collision);
    } catch (...) {
      manager_.unregisterObject(&object);
      throw;
    }
  }

  /// Adds the manager and all that it has. An object that has changed since the manager
  /// read it has a box that is out of date, and contacts would be missed.
  void addAll(Reading& reading) const {
    reading.add(*this);
    std::vector<fcl::ContinuousCollisionObjectd*> objects;
    manager_.getObjects(objects);
    for (const auto* o : objects) {
      const auto& object = *static_cast<const ManagedObject*>(o);
      reading.add(object.geometry());
      if (object.isOutOfDate())
        throw std::runtime_error(
            "the mesh of object " + py::cast<std::string>(py::repr(object.name())) +
            " was updated after the manager had read it. Call the manager's update()");
    }
  }

  template <typename Ask>
  static py::dict answer(const Request& request, const Ask& ask) {
    FclResult result;
    {
      TriangleFilter filter(request);
      const py::gil_scoped_release release;
      filter.run([&] { ask(filter.request(), result); });
    }
    return fieldsOf(result);
  }

  FclManager manager_;
  /// The objects of Python that own what is registered.
  std::unordered_map<const ManagedObject*, py::object> owners_;
};

}  // namespace

void bindManager(py::module_& module) {
  Class<ManagedObject>(module, "ManagedObject", seenByCollector<ManagedObject>());
  Class<Manager>(module, "Manager", seenByCollector<Manager>())
      .def(py::init<>())
      .def("_insert", &Manager::insert)
      .def("_remove", &Manager::remove)
      .def("_update", &Manager::update)
      .def("_set_filter", &Manager::setFilter)
      .def("_set_self_collision", &Manager::setSelfCollision)
      .def("_collide_all", &Manager::collideAll)
      .def("_collide_one", &Manager::collideOne)
      .def("_collide_geometry", &Manager::collideGeometry)
      .def("_collide_manager", &Manager::collideManager);
}

}  // namespace python
}  // namespace fcl_ccd
