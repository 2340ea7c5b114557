// SPDX-License-Identifier: BSD-3-Clause
#include "motions.h"

#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "classes.h"
#include "fcl/math/motion/interp_motion.h"
#include "fcl/math/motion/joint_chain.h"
#include "fcl/math/motion/screw_motion.h"
#include "fcl/math/motion/spline_motion.h"
#include "fcl/math/motion/twist_motion.h"
#include "fcl/math/motion/waypoint_motion.h"
#include "geometry.h"

namespace fcl_ccd {
namespace python {
namespace {

using fcl::Vector3d;
using fcl::detail::PathKind;
using fcl::detail::PoseNumbers;

/// As the library: a rotation that was typed with a few digits is taken, a matrix that
/// scales is not.
constexpr double kMostDeviation = 0x1p-6;

double determinant(const double (&r)[9]) {
  return r[0] * (r[4] * r[8] - r[5] * r[7]) - r[1] * (r[3] * r[8] - r[5] * r[6]) +
         r[2] * (r[3] * r[7] - r[4] * r[6]);
}

/// What BoundedMotion asks for.
constexpr double kMostDeviationOfOwn = 0x1p-40;

/// How far the rows are from length 1 and right angles: the most that a product of two
/// rows is off.
double deviationOf(const double (&r)[9]) {
  double most = 0;
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k <= i; ++k) {
      const double product =
          r[3 * i] * r[3 * k] + r[3 * i + 1] * r[3 * k + 1] + r[3 * i + 2] * r[3 * k + 2];
      most = std::max(most, std::abs(product - (i == k)));
    }
  return most;
}

/// @param name  what the exception calls the pose
void requireRotation(const double (&r)[9], const std::string& name,
                     double most_deviation) {
  if (determinant(r) < 0)
    throw py::value_error(name +
                          " is not a rotation and a translation: it mirrors. Mirror the "
                          "vertices instead");
  const double deviation = deviationOf(r);
  if (deviation <= most_deviation) return;
  if (deviation <= kMostDeviation)
    throw py::value_error(name +
                          " is a rotation only up to more than 2^-40. Compute it in "
                          "double precision, or normalise it");
  throw py::value_error(name +
                        " is not a rotation and a translation: the products of its rows "
                        "are off by " +
                        std::to_string(deviation) +
                        ", more than 2^-6. Normalise its rotation, or scale the "
                        "vertices instead");
}

/// The rotation and the translation of a matrix.
PoseNumbers<double> partsOf(const double* matrix) {
  PoseNumbers<double> pose;
  for (int row = 0; row < 3; ++row) {
    std::copy_n(matrix + 4 * row, 3, pose.rotation + 3 * row);
    pose.translation[row] = matrix[4 * row + 3];
  }
  return pose;
}

/// @param matrix  4 x 4, row by row
/// @param name  what an exception calls it
PoseNumbers<double> toPose(const double* matrix, const std::string& name,
                           double most_deviation = kMostDeviation) {
  if (!std::all_of(matrix, matrix + 16, [](double x) { return std::isfinite(x); }))
    throw py::value_error(name + " has a number that is not finite");
  if (matrix[12] != 0 || matrix[13] != 0 || matrix[14] != 0 || matrix[15] != 1)
    throw py::value_error(name + ": the last row of a pose is 0 0 0 1");
  const PoseNumbers<double> pose = partsOf(matrix);
  requireRotation(pose.rotation, name, most_deviation);
  return pose;
}

Motion betweenPoses(const Doubles& begin, const Doubles& end, PathKind kind,
                    const std::string& name) {
  requireSize(begin, 16, "the pose at t = 0");
  requireSize(end, 16, "the pose at t = 1");
  Motion motion{};
  motion.path.path = kind;
  motion.path.pose[0] = toPose(begin.data(), name);
  motion.path.pose[1] = toPose(end.data(), name);
  return motion;
}

Motion straight(const Doubles& begin, const Doubles& end, const std::string& name) {
  return betweenPoses(begin, end, PathKind::kStraight, name);
}

Motion turn(const Doubles& begin, const Doubles& end, const Doubles& reference,
            const std::string& name) {
  Motion motion = betweenPoses(begin, end, PathKind::kTurn, name);
  requireSize(reference, 3, "reference");
  std::copy_n(reference.data(), 3, motion.path.reference);
  return motion;
}

Motion screw(const Doubles& begin, const Doubles& end, const std::string& name) {
  return betweenPoses(begin, end, PathKind::kScrew, name);
}

/// @param translation, rotation  4 control points each
Motion spline(const Doubles& translation, const Doubles& rotation) {
  requireSize(translation, 12, "translation");
  requireSize(rotation, 12, "rotation");
  const auto at = [](const Doubles& points, int i) {
    const double* p = points.data() + 3 * i;
    return Vector3d(p[0], p[1], p[2]);
  };
  const fcl::SplineMotion<double> motion(
      at(translation, 0), at(translation, 1), at(translation, 2), at(translation, 3),
      at(rotation, 0), at(rotation, 1), at(rotation, 2), at(rotation, 3));
  Motion out{};
  if (!fcl::detail::readFclMotion(motion, out.path))
    throw std::runtime_error("FCL's SplineMotion is not readable");
  return out;
}

/// @tparam Bounded  a BoundedMotion too
template <typename Bounded>
Motion following(const std::shared_ptr<Bounded>& bounded) {
  Motion motion{};
  motion.bounded = bounded;
  motion.path.path = PathKind::kBounded;
  motion.path.motion = fcl::detail::asBoundedMotion<double>(*bounded);
  for (const int end : {0, 1}) {
    const auto at = bounded->placementAt(end);
    std::copy_n(at.rotation, 9, motion.path.pose[end].rotation);
    std::copy_n(at.translation, 3, motion.path.pose[end].translation);
  }
  return motion;
}

Motion bounded(const py::function& pose, const py::function& rate,
               const py::function& acceleration, const py::function& angular_speed) {
  const auto own =
      std::make_shared<PythonMotion>(pose, rate, acceleration, angular_speed);
  Motion motion = following(own);
  motion.functions = py::make_tuple(pose, rate, acceleration, angular_speed);
  // Wrong functions are found here as far as this is possible, not in a query.
  for (const double t : {0., 1.}) own->rateAt(t);
  own->accelerationBound({0, 0, 0}, 1, 0, 1);
  own->angularSpeedBound(0, 1);
  return motion;
}

/// The pose of an object at t, as a 4x4 array.
py::array poseAt(const Motion& motion, const Geometry& o, double t) {
  const Geometry::Reading reading(o);
  return toArray(fcl::detail::poseAt(motion.of(o.geometry()), t));
}

Vector3d toVector(const Doubles& numbers, const char* name) {
  requireSize(numbers, 3, name);
  return Vector3d(numbers.data());
}

int addJoint(fcl::JointChain& chain, const std::string& kind, const Doubles& origin,
             const Doubles& axis, int parent) {
  const fcl::Transform3d tf = toTransform(origin, "origin");
  const Vector3d about = toVector(axis, "axis");
  if (kind == "revolute") return chain.addRevolute(tf, about, parent);
  if (kind == "prismatic") return chain.addPrismatic(tf, about, parent);
  return chain.addFixed(tf, parent);
}

fcl::ChainMotion linearValues(const fcl::JointChain& chain,
                              const std::vector<double>& begin,
                              const std::vector<double>& end, const Doubles& base) {
  return fcl::ChainMotion(chain, begin, end, toTransform(base, "base"));
}

fcl::ChainMotion polynomials(const fcl::JointChain& chain,
                             const std::vector<std::vector<double>>& values,
                             const Doubles& base) {
  return fcl::ChainMotion::polynomial(chain, values, toTransform(base, "base"));
}

Motion twist(const Doubles& pose, const Doubles& linear, const Doubles& angular,
             const Doubles& reference, bool is_screw) {
  return following(std::make_shared<fcl::TwistMotion<double>>(
      toTransform(pose, "pose"), toVector(linear, "linear"), toVector(angular, "angular"),
      is_screw ? fcl::ReferencePath::kScrew : fcl::ReferencePath::kStraight,
      toVector(reference, "reference")));
}

/// @param poses  4 x 4 each
Motion waypoints(const Doubles& poses, const std::vector<double>& times) {
  fcl::aligned_vector<fcl::Transform3d> tfs;
  for (py::ssize_t i = 0; i < poses.size() / 16; ++i)
    tfs.push_back(fcl::detail::toTransform(
        toPose(poses.data() + 16 * i, "pose " + std::to_string(i))));
  return following(std::make_shared<fcl::WaypointMotion<double>>(tfs, times));
}

Motion linkOf(const fcl::ChainMotion& motion, int number) {
  return following(motion.link(number));
}

py::array urdfOrigin(const Doubles& xyz, const Doubles& rpy) {
  return toArray(fcl::detail::toNumbers(
      fcl::urdfOrigin(toVector(xyz, "xyz"), toVector(rpy, "rpy"))));
}

fcl::BoundedMotion::Placement toPlacement(const PoseNumbers<double>& parts) {
  fcl::BoundedMotion::Placement placement;
  std::copy_n(parts.rotation, 9, placement.rotation);
  std::copy_n(parts.translation, 3, placement.translation);
  return placement;
}

[[noreturn]] void throwNotAsked() {
  throw std::logic_error("FCL does not follow a motion of Python");
}

}  // namespace

fcl::Transform3d toTransform(const Doubles& matrix, const char* name) {
  requireSize(matrix, 16, name);
  return fcl::detail::toTransform(toPose(matrix.data(), name));
}

fcl::BoundedMotion::Placement PythonMotion::placementAt(double t) const {
  const py::gil_scoped_acquire acquire;
  const auto matrix = py::cast<Doubles>(pose_(t));
  requireSize(matrix, 16, "pose(t)");
  return toPlacement(toPose(matrix.data(), "pose(t)", kMostDeviationOfOwn));
}

fcl::BoundedMotion::Placement PythonMotion::rateAt(double t) const {
  const py::gil_scoped_acquire acquire;
  const auto matrix = py::cast<Doubles>(rate_(t));
  requireSize(matrix, 16, "rate(t)");
  if (!std::all_of(matrix.data() + 12, matrix.data() + 16,
                   [](double x) { return x == 0; }))
    throw py::value_error("rate(t): the last row of the derivative of a pose is 0 0 0 0");
  return toPlacement(partsOf(matrix.data()));
}

double PythonMotion::accelerationBound(const double (&center)[3], double radius,
                                       double t0, double t1) const {
  const py::gil_scoped_acquire acquire;
  return py::cast<double>(
      acceleration_(py::make_tuple(center[0], center[1], center[2]), radius, t0, t1));
}

double PythonMotion::angularSpeedBound(double t0, double t1) const {
  const py::gil_scoped_acquire acquire;
  return py::cast<double>(angular_speed_(t0, t1));
}

bool PythonMotion::integrate(double) const { throwNotAsked(); }
double PythonMotion::computeMotionBound(const fcl::BVMotionBoundVisitor<double>&) const {
  throwNotAsked();
}
double PythonMotion::computeMotionBound(
    const fcl::TriangleMotionBoundVisitor<double>&) const {
  throwNotAsked();
}
void PythonMotion::getCurrentTransform(fcl::Transform3<double>&) const {
  throwNotAsked();
}
void PythonMotion::getTaylorModel(fcl::TMatrix3<double>&, fcl::TVector3<double>&) const {
  throwNotAsked();
}

std::shared_ptr<fcl::MotionBase<double>> toFclMotion(const Motion& motion, bool deforms) {
  const auto& path = motion.path;
  if (motion.bounded) return motion.bounded;
  if (path.path == PathKind::kSpline) {
    const auto at = [&](int of, int i) { return Vector3d(path.control[of][i]); };
    return std::make_shared<fcl::SplineMotion<double>>(
        at(0, 0), at(0, 1), at(0, 2), at(0, 3), at(1, 0), at(1, 1), at(1, 2), at(1, 3));
  }
  const fcl::Transform3d begin = fcl::detail::toTransform(path.pose[0]),
                         end = fcl::detail::toTransform(path.pose[1]);
  if (path.path == PathKind::kScrew)
    return std::make_shared<fcl::ScrewMotion<double>>(begin, end);
  // A rigid body on a straight path turns about its origin, if it turns.
  if (deforms && path.path == PathKind::kStraight &&
      !fcl::detail::isConstantRotation(path.pose[0], path.pose[1]))
    throw py::value_error(
        "the rotations of the two poses of a DeformableMesh differ. In a manager give a "
        "LinearMotion, in whose frame it deforms, or vertices in the world frame");
  return std::make_shared<fcl::InterpMotion<double>>(begin, end,
                                                     Vector3d(path.reference));
}

py::array toArray(const fcl::detail::PoseNumbers<double>& pose) {
  py::array_t<double> out({4, 4});
  double* to = out.mutable_data();
  for (int row = 0; row < 3; ++row) {
    to = std::copy_n(pose.rotation + 3 * row, 3, to);
    *to++ = pose.translation[row];
  }
  for (const double x : {0., 0., 0., 1.}) *to++ = x;
  return out;
}

void bindMotions(py::module_& module) {
  Class<Motion>(module, "Motion", seenByCollector<Motion>())
      .def_property_readonly(
          "is_straight",
          [](const Motion& m) { return m.path.path == PathKind::kStraight; })
      .def("pose_at", &poseAt, py::arg("o"), py::arg("t"))
      .def_static("straight", &straight)
      .def_static("turn", &turn)
      .def_static("screw", &screw)
      .def_static("spline", &spline)
      .def_static("bounded", &bounded)
      .def_static("link", &linkOf)
      .def_static("twist", &twist)
      .def_static("waypoints", &waypoints);
  Class<fcl::JointChain>(module, "JointChain")
      .defInit<>()
      .def("add", &addJoint)
      .def("copy", [](const fcl::JointChain& chain) { return fcl::JointChain(chain); })
      .def("num_links", &fcl::JointChain::numLinks)
      .def("num_values", &fcl::JointChain::numValues);
  Class<fcl::ChainMotion>(module, "ChainMotion")
      .def_static("linear", &linearValues)
      .def_static("polynomial", &polynomials);
  module.def("urdf_origin", &urdfOrigin);
}

}  // namespace python
}  // namespace fcl_ccd
