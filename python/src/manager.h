// SPDX-License-Identifier: BSD-3-Clause
//
// The objects of a manager, and the manager, as Python has them.
#ifndef FCL_CCD_PYTHON_MANAGER_H
#define FCL_CCD_PYTHON_MANAGER_H

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "fcl/broadphase/continuous_collision_manager.h"
#include "meshes.h"
#include "motions.h"
#include "requests.h"

namespace fcl_ccd {
namespace python {

using FclManager = fcl::ContinuousCollisionManagerd;
using FclRequest = fcl::ContinuousContactRequestd;
using FclResult = fcl::ContinuousManagerResultd;
using FclDistance = fcl::ContinuousManagerDistanced;

/// A path, which keeps its functions of Python alive, and FCL's motion on it.
struct FclMotion {
  std::shared_ptr<fcl::MotionBase<double>> motion;
  Motion path;
};

/// FCL's objects do not own what they refer to, and queries do not write to it.
inline std::shared_ptr<fcl::CollisionGeometry<double>> borrow(const Geometry& geometry) {
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

  /// Where its motion ends.
  fcl::Transform3d lastPose() const { return fcl::detail::lastPoseOf<double>(*this); }

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

/// The fields of a ManagerResult of Python.
py::dict fieldsOf(FclResult& result);

/// The fields of a NearestPair of Python.
py::dict fieldsOf(const FclDistance& nearest);

/// The fields of a Result of Python, without its objects.
py::dict fieldsOfPair(fcl::ContinuousContactResultd& result);

class Manager : public Guarded {
 public:
  Manager() : Guarded("manager") {}

  py::object insert(py::object name, py::object geometry, const Motion& motion,
                    const fcl::ContinuousFilter& filter, bool self_collision,
                    double thickness) {
    const Writing writing(*this);
    py::object owner = py::cast(
        std::make_unique<ManagedObject>(std::move(name), std::move(geometry), motion));
    auto& object = py::cast<ManagedObject&>(owner);
    const Reading reading(object.geometry());
    const auto place = owners_.emplace(&object, owner).first;
    try {
      const py::gil_scoped_release release;
      add(object, filter, self_collision, thickness);
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

  void setThickness(ManagedObject& object, double thickness) {
    const Writing writing(*this);
    manager_.setThickness(&object, thickness);
  }

  void setMinApproachSpeed(ManagedObject& object, double speed) {
    const Writing writing(*this);
    manager_.setMinApproachSpeed(&object, speed);
  }

  /// @param distance  none: that of the two thicknesses
  void setPairDistance(ManagedObject& o1, ManagedObject& o2,
                       std::optional<double> distance) {
    const Writing writing(*this);
    if (distance)
      manager_.setPairDistance(&o1, &o2, *distance);
    else
      manager_.resetPairDistance(&o1, &o2);
  }

  void setSelfCollision(ManagedObject& object, bool enabled) {
    const Writing writing(*this);
    manager_.setSelfCollision(&object, enabled);
  }

  /// @tparam AnyRequest  Request, for contacts, or DistanceRequest
  template <typename AnyRequest>
  py::dict askAll(const AnyRequest& request) const {
    Reading reading;
    addAll(reading);
    return answer(request);
  }

  /// @param object  registered
  template <typename AnyRequest>
  py::dict askOne(ManagedObject& object, const AnyRequest& request) const {
    Reading reading;
    addAll(reading);
    return answer(request, &object);
  }

  template <typename AnyRequest>
  py::dict askGeometry(const py::object& geometry, const Motion& motion,
                       const AnyRequest& request) const {
    ManagedObject object(py::none(), geometry, motion);
    Reading reading(object.geometry());
    addAll(reading);
    return answer(request, &object);
  }

  template <typename AnyRequest>
  py::dict askManager(const Manager& other, const AnyRequest& request) const {
    Reading reading;
    addAll(reading);
    other.addAll(reading);
    return answer(request, other.manager_);
  }

  template <typename Visit>
  void visit(const Visit& visit) const {
    for (const auto& owner : owners_) visit(owner.second);
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

  const FclManager& manager() const { return manager_; }

 private:
  /// Called without the GIL. After an exception the object is not registered.
  void add(ManagedObject& object, const fcl::ContinuousFilter& filter,
           bool self_collision, double thickness) {
    manager_.registerObject(&object);
    try {
      manager_.setFilter(&object, filter);
      manager_.setSelfCollision(&object, self_collision);
      if (thickness != 0) manager_.setThickness(&object, thickness);
    } catch (...) {
      manager_.unregisterObject(&object);
      throw;
    }
  }

  /// @param other  whom the objects meet: nothing, one object or a manager
  template <typename... Other>
  py::dict answer(const Request& request, const Other&... other) const {
    FclResult result;
    {
      TriangleFilter filter(request);
      const py::gil_scoped_release release;
      filter.run([&] { manager_.collide(other..., filter.request(), result); });
    }
    return fieldsOf(result);
  }

  template <typename... Other>
  py::dict answer(const DistanceRequest& request, const Other&... other) const {
    FclDistance nearest;
    {
      TriangleFilter filter(request.contacts);
      const py::gil_scoped_release release;
      filter.run(
          [&] { manager_.distance(other..., request.of(filter.request()), nearest); });
    }
    return fieldsOf(nearest);
  }

  FclManager manager_;
  /// The objects of Python that own what is registered.
  std::unordered_map<const ManagedObject*, py::object> owners_;
};

}  // namespace python
}  // namespace fcl_ccd

#endif
