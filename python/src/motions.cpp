// SPDX-License-Identifier: BSD-3-Clause
#include "motions.h"

#include <algorithm>

#include "fcl/math/motion/spline_motion.h"

namespace fcl_ccd {
namespace python {
namespace {

using fcl::Vector3d;
using fcl::detail::PathKind;

/// @param poses  begin and end, each 4 x 4
Motion betweenPoses(const Doubles& poses, PathKind kind) {
  requireSize(poses, 2 * 16, "the poses");
  Motion motion{};
  motion.path.path = kind;
  for (int end = 0; end < 2; ++end) {
    auto& pose = motion.path.pose[end];
    const double* matrix = poses.data() + 16 * end;
    for (int row = 0; row < 3; ++row) {
      std::copy_n(matrix + 4 * row, 3, pose.rotation + 3 * row);
      pose.translation[row] = matrix[4 * row + 3];
    }
  }
  return motion;
}

Motion turn(const Doubles& poses, const Doubles& reference) {
  Motion motion = betweenPoses(poses, PathKind::kTurn);
  requireSize(reference, 3, "reference");
  std::copy_n(reference.data(), 3, motion.path.reference);
  return motion;
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

}  // namespace

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
  py::class_<Motion>(module, "Motion")
      .def_static(
          "straight",
          [](const Doubles& poses) { return betweenPoses(poses, PathKind::kStraight); })
      .def_static("turn", &turn)
      .def_static(
          "screw",
          [](const Doubles& poses) { return betweenPoses(poses, PathKind::kScrew); })
      .def_static("spline", &spline);
}

}  // namespace python
}  // namespace fcl_ccd
