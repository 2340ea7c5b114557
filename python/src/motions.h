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

/// A motion that functions of Python tell. FCL's functions of a motion are not there:
/// this library answers all pairs that follow it.
class PythonMotion : public fcl::MotionBase<double>, public fcl::BoundedMotion {
 public:
  /// @param pose, rate  functions of t that give 4x4 arrays
  /// @param acceleration  function of center, radius, t0, t1
  /// @param angular_speed  function of t0, t1
  /// The functions must live as long as the motion. Its owners hold them.
  PythonMotion(py::handle pose, py::handle rate, py::handle acceleration,
               py::handle angular_speed)
      : pose_(pose),
        rate_(rate),
        acceleration_(acceleration),
        angular_speed_(angular_speed) {}

  /// Queries call these without the GIL. An exception of Python reaches their caller.
  Placement placementAt(double t) const override;
  Placement rateAt(double t) const override;
  double accelerationBound(const double (&center)[3], double radius, double t0,
                           double t1) const override;
  double angularSpeedBound(double t0, double t1) const override;

  bool integrate(double t) const override;
  double computeMotionBound(const fcl::BVMotionBoundVisitor<double>&) const override;
  double computeMotionBound(
      const fcl::TriangleMotionBoundVisitor<double>&) const override;
  void getCurrentTransform(fcl::Transform3<double>&) const override;
  void getTaylorModel(fcl::TMatrix3<double>&, fcl::TVector3<double>&) const override;

 private:
  py::handle pose_, rate_, acceleration_, angular_speed_;
};

/// A path without the object that follows it.
struct Motion {
  fcl::detail::MovingGeometry<double> path;
  /// If the path is a BoundedMotion: the motion. If it is one of Python: the tuple of its
  /// functions.
  std::shared_ptr<fcl::MotionBase<double>> bounded;
  py::object functions;

  fcl::detail::MovingGeometry<double> of(
      const fcl::CollisionGeometry<double>& mesh) const {
    fcl::detail::MovingGeometry<double> moving = path;
    moving.geometry = &mesh;
    return moving;
  }

  template <typename Visit>
  void visit(const Visit& visit) const {
    visit(functions);
  }
};

/// FCL's motion on the same path.
/// @throws ValueError  deforms and the path is straight and turns: FCL has no such motion
std::shared_ptr<fcl::MotionBase<double>> toFclMotion(const Motion& motion, bool deforms);

/// A 4x4 array as a transform.
/// @param name  what an exception calls it
fcl::Transform3d toTransform(const Doubles& matrix, const char* name);

/// A pose as a 4x4 array.
py::array toArray(const fcl::detail::PoseNumbers<double>& pose);

void bindMotions(py::module_& module);

}  // namespace python
}  // namespace fcl_ccd

#endif
