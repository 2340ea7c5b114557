// SPDX-License-Identifier: BSD-3-Clause
//
// How a mesh moves during a step.
#ifndef FCL_CCD_PYTHON_MOTIONS_H
#define FCL_CCD_PYTHON_MOTIONS_H

#include "arrays.h"
#include "fcl/narrowphase/detail/query_numbers.h"

namespace fcl_ccd {
namespace python {

/// A path without the mesh that follows it.
struct Motion {
  fcl::detail::MovingGeometry<double> path;

  fcl::detail::MovingGeometry<double> of(
      const fcl::CollisionGeometry<double>& mesh) const {
    fcl::detail::MovingGeometry<double> moving = path;
    moving.geometry = &mesh;
    return moving;
  }
};

/// A pose as a 4x4 array.
py::array toArray(const fcl::detail::PoseNumbers<double>& pose);

void bindMotions(py::module_& module);

}  // namespace python
}  // namespace fcl_ccd

#endif
