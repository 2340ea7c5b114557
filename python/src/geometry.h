// SPDX-License-Identifier: BSD-3-Clause
//
// What is common to meshes and shapes of the Python module.
#ifndef FCL_CCD_PYTHON_GEOMETRY_H
#define FCL_CCD_PYTHON_GEOMETRY_H

#include <cstdint>

#include "fcl/geometry/collision_geometry.h"

namespace fcl_ccd {
namespace python {

/// A mesh or a shape, and who uses it. Queries and updates run without Python's lock (the
/// GIL), so that two threads of Python may come to one mesh. Any number of queries may
/// read it. An update needs it alone. What would be a data race in C++ is a RuntimeError
/// in Python.
class Geometry {
 public:
  virtual ~Geometry() = default;
  virtual const fcl::CollisionGeometry<double>& geometry() const = 0;

  /// How often somebody has written to it.
  std::uint64_t numUpdates() const { return num_updates_; }

  /// Made and destroyed while the thread has the GIL, which guards the counters.
  class Reading {
   public:
    explicit Reading(const Geometry& geometry);
    ~Reading() { --geometry_.num_readers_; }
    Reading(const Reading&) = delete;
    Reading& operator=(const Reading&) = delete;

   private:
    const Geometry& geometry_;
  };
  class Writing {
   public:
    explicit Writing(const Geometry& geometry);
    ~Writing() {
      geometry_.is_written_ = false;
      ++geometry_.num_updates_;
    }
    Writing(const Writing&) = delete;
    Writing& operator=(const Writing&) = delete;

   private:
    const Geometry& geometry_;
  };

 private:
  mutable int num_readers_{0};
  mutable bool is_written_{false};
  mutable std::uint64_t num_updates_{0};
};

}  // namespace python
}  // namespace fcl_ccd

#endif
