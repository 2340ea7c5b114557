// SPDX-License-Identifier: BSD-3-Clause
#include "scene_pose.h"

#include <cmath>
#include <cstddef>
#include <string>

#include "number_text.h"
#include "prepare/nearest_rotation.h"

namespace fcl_ccd {
namespace {

using fcl::Transform3d;
using fcl::detail::deformable::kMostDeviation;

/// The quaternion is normalised here. The library does so with a matrix.
fcl::Matrix3d readRotation(const JsonFile& file, const JsonValue& value) {
  const JsonValue::List& entries = file.list(value, 4);
  double q[4];
  for (std::size_t i = 0; i < 4; ++i) q[i] = file.number(entries[i]);
  const double length = std::hypot(std::hypot(q[0], q[1]), std::hypot(q[2], q[3]));
  if (!(std::abs(length - 1) <= kMostDeviation))
    file.refuse(value, "the quaternion [w, x, y, z] has the length " +
                           numberText(length, 6) +
                           ", which is further from 1 than 2^-6. Divide it by its "
                           "length");
  return fcl::Quaterniond(q[0], q[1], q[2], q[3]).normalized().toRotationMatrix();
}

Transform3d readMatrix(const JsonFile& file, const JsonValue& value) {
  const JsonValue::List& rows = file.list(value, 4);
  double rotation[9];
  Transform3d pose = Transform3d::Identity();
  for (std::size_t i = 0; i < 4; ++i) {
    const JsonValue::List& row = file.list(rows[i], 4);
    for (std::size_t k = 0; k < 4; ++k) {
      const double x = file.number(row[k]);
      if (i == 3 && x != (k == 3 ? 1 : 0))
        file.refuse(rows[i], "the last row of a matrix is [0, 0, 0, 1]. Write this");
      if (i == 3) continue;
      pose.matrix()(static_cast<int>(i), static_cast<int>(k)) = x;
      if (k < 3) rotation[3 * i + k] = x;
    }
  }
  using namespace fcl::detail::deformable;
  if (!(deviationFromRotation(rotation) <= kMostDeviation) || determinantOf(rotation) < 0)
    file.refuse(value,
                "the matrix scales, mirrors or shears, by more than 2^-6. Write a "
                "rotation and a translation, and change the geometry instead");
  return pose;
}

Transform3d readPose(const JsonFile& file, const JsonValue& value) {
  if (value.as<JsonValue::List>() != nullptr) return readMatrix(file, value);
  file.fields(value, {"translation", "rotation"});
  Transform3d pose = Transform3d::Identity();
  if (const JsonValue* translation = file.find(value, "translation"))
    pose.translation() = readPoint(file, *translation);
  if (const JsonValue* rotation = file.find(value, "rotation"))
    pose.linear() = readRotation(file, *rotation);
  return pose;
}

}  // namespace

fcl::Vector3d readPoint(const JsonFile& file, const JsonValue& value) {
  const JsonValue::List& entries = file.list(value, 3);
  return {file.number(entries[0]), file.number(entries[1]), file.number(entries[2])};
}

std::vector<Transform3d> readPoses(const JsonFile& file, const JsonValue& value) {
  std::vector<Transform3d> poses;
  for (const JsonValue& pose : file.list(value)) poses.push_back(readPose(file, pose));
  return poses;
}

}  // namespace fcl_ccd
