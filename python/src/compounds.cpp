// SPDX-License-Identifier: BSD-3-Clause
//
// Bodies of several geometries, as Python has them.
#include "compounds.h"

#include <pybind11/stl.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "arrays.h"
#include "classes.h"
#include "fcl/geometry/compound_geometry.h"
#include "geometry.h"
#include "motions.h"

namespace fcl_ccd {
namespace python {
namespace {

/// It never changes, but a mesh that is a part may.
class Compound : public Geometry {
 public:
  /// @param owners  of the parts
  Compound(const std::vector<py::object>& owners, const std::vector<Doubles>& offsets) {
    if (owners.size() != offsets.size())
      throw py::value_error("there are not as many offsets as parts");
    for (std::size_t i = 0; i < owners.size(); ++i) {
      const auto& part = py::cast<const Geometry&>(owners[i]);
      const Reading reading(part);
      // The owner keeps it alive.
      compound_.addPart({std::shared_ptr<void>(), &part.geometry()},
                        toTransform(offsets[i], "the offset"));
      parts_.push_back({owners[i], &part, part.numUpdates()});
    }
  }

  const fcl::CollisionGeometry<double>& geometry() const override { return compound_; }
  std::size_t numParts() const { return parts_.size(); }

  void addParts(Reading& reading) const override {
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      reading.add(*parts_[i].geometry);
      if (parts_[i].num_updates != parts_[i].geometry->numUpdates())
        throw std::runtime_error(
            "the mesh of part " + std::to_string(i) +
            " was updated after the Compound had read it. Make another Compound");
    }
  }

  template <typename Visit>
  void visit(const Visit& visit) const {
    for (const Part& part : parts_) visit(part.owner);
  }

 private:
  struct Part {
    py::object owner;
    const Geometry* geometry;
    /// Of the mesh, when it was read.
    std::uint64_t num_updates;
  };

  fcl::CompoundGeometryd compound_;
  std::vector<Part> parts_;
};

}  // namespace

void bindCompounds(py::module_& module) {
  Class<Compound, Geometry>(module, "Compound", seenByCollector<Compound>())
      .def(py::init<const std::vector<py::object>&, const std::vector<Doubles>&>(),
           py::arg("parts"), py::arg("offsets"))
      .def_property_readonly("num_parts", &Compound::numParts);
}

}  // namespace python
}  // namespace fcl_ccd
