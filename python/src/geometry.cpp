// SPDX-License-Identifier: BSD-3-Clause
#include "geometry.h"

#include <stdexcept>

namespace fcl_ccd {
namespace python {

Geometry::Reading::Reading(const Geometry& geometry) : geometry_(geometry) {
  if (geometry.is_written_)
    throw std::runtime_error(
        "the mesh is being updated by another thread. Wait until the update has ended");
  ++geometry.num_readers_;
}

Geometry::Writing::Writing(const Geometry& geometry) : geometry_(geometry) {
  if (geometry.is_written_ || geometry.num_readers_ > 0)
    throw std::runtime_error(
        "a query or an update of the mesh has not ended, in another thread or in the "
        "caller of this function. Update the mesh when it has ended");
  geometry.is_written_ = true;
}

}  // namespace python
}  // namespace fcl_ccd
