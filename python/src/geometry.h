// SPDX-License-Identifier: BSD-3-Clause
//
// What is common to meshes and shapes of the Python module.
#ifndef FCL_CCD_PYTHON_GEOMETRY_H
#define FCL_CCD_PYTHON_GEOMETRY_H

#include <cstdint>
#include <exception>
#include <vector>

#include "fcl/geometry/collision_geometry.h"

namespace fcl_ccd {
namespace python {

/// Something that queries read and updates write. Both run without Python's lock (the
/// GIL), so that two threads of Python may come to one mesh. Any number of queries may
/// read it. An update needs it alone. What would be a data race in C++ is a RuntimeError
/// in Python.
class Guarded {
 public:
  /// @param name  what exceptions call it
  explicit Guarded(const char* name) : name_(name) {}
  Guarded(const Guarded&) = delete;
  Guarded& operator=(const Guarded&) = delete;
  virtual ~Guarded() = default;

  /// How often somebody has written to it.
  std::uint64_t numUpdates() const { return num_updates_; }

  class Reading;
  class Writing;

  /// Who reads it reads these too.
  virtual void addParts(Reading& /*reading*/) const {}

  /// Made and destroyed while the thread has the GIL, which guards the counters.
  class Reading {
   public:
    Reading() = default;
    explicit Reading(const Guarded& read) : Reading() { add(read); }
    ~Reading() {
      for (const Guarded* read : read_) --read->num_readers_;
    }
    Reading(const Reading&) = delete;
    Reading& operator=(const Reading&) = delete;

    void add(const Guarded& read);

   private:
    std::vector<const Guarded*> read_;
  };
  /// An exception that ends it tells that nothing was written.
  class Writing {
   public:
    explicit Writing(const Guarded& written);
    ~Writing() {
      written_.is_written_ = false;
      if (std::uncaught_exceptions() == num_exceptions_) ++written_.num_updates_;
    }
    Writing(const Writing&) = delete;
    Writing& operator=(const Writing&) = delete;

   private:
    const Guarded& written_;
    const int num_exceptions_{std::uncaught_exceptions()};
  };

 private:
  const char* name_;
  mutable int num_readers_{0};
  mutable bool is_written_{false};
  mutable std::uint64_t num_updates_{0};
};

/// A mesh, a shape, an octree or a compound.
class Geometry : public Guarded {
 public:
  Geometry() : Guarded("mesh") {}
  virtual const fcl::CollisionGeometry<double>& geometry() const = 0;
};

}  // namespace python
}  // namespace fcl_ccd

#endif
