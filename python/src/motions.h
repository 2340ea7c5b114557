// SPDX-License-Identifier: BSD-3-Clause
//
// How a mesh or a shape moves during a step.
#ifndef FCL_CCD_PYTHON_MOTIONS_H
#define FCL_CCD_PYTHON_MOTIONS_H

#include <memory>

#include "arrays.h"
#include "fcl/narrowphase/detail/query_numbers.h"

namespace fcl_ccd {
namespace python {

/// A path without the object that follows it.
struct Motion {
  fcl::detail::MovingGeometry<double> path;

  fcl::detail::MovingGeometry<double> of(
      const fcl::CollisionGeometry<double>& mesh) const {
    fcl::detail::MovingGeometry<double> moving = path;
    moving.geometry = &mesh;
    return moving;
  }
};

/// FCL's motion on the same path.
/// @throws ValueError  deforms and the path is straight and turns: FCL has no such motion
std::shared_ptr<fcl::MotionBase<double>> toFclMotion(const Motion& motion, bool deforms);

/// A pose as a 4x4 array.
py::array toArray(const fcl::detail::PoseNumbers<double>& pose);

void bindMotions(py::module_& module);

}  // namespace python
}  // namespace fcl_ccd

#endif
