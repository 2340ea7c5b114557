// SPDX-License-Identifier: BSD-3-Clause
#include "paths/joint_tree.h"

#include <cassert>

#include "numerics/error_bounds.h"
#include "paths/path_matrix.h"
#include "paths/posed_vector.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

/// Columns of m [a]: rows of m, times a.
void timesCross(const double (&m)[9], const Vec& a, double (&out)[9]) {
  for (int i = 0; i < 3; ++i) {
    const Vec row = cross({m[3 * i], m[3 * i + 1], m[3 * i + 2]}, a);
    out[3 * i] = row.x;
    out[3 * i + 1] = row.y;
    out[3 * i + 2] = row.z;
  }
}

}  // namespace

RoundedPose operator*(const RoundedPose& x, const RoundedPose& y) {
  RoundedPose out;
  multiply(x.pose.rotation, y.pose.rotation, out.pose.rotation);
  const Vec way = vecOf(y.pose.translation),
            there = rotated(x.pose.rotation, way) + vecOf(x.pose.translation);
  set(out.pose.translation, there);
  out.rotation_error = (x.rotation_error + y.rotation_error + 9 * kUnit) * kUpward;
  out.translation_error =
      (x.translation_error + y.translation_error +
       (x.rotation_error + 6 * kUnit) * norm(way) + 2 * kUnit * norm(there)) *
      kUpward;
  return out;
}

int JointTree::add(Type type, const Pose& origin, const Vec& axis, int parent) {
  assert(-1 <= parent && parent < static_cast<int>(links_.size()));
  assert(isRotation(origin.rotation, 0x1p-44) && (type == Type::kFixed || isUnit(axis)));
  const RoundedPose own{origin, 0, 0};
  const Link carrier =
      parent < 0 ? Link{-1, {}} : links_[static_cast<std::size_t>(parent)];
  const RoundedPose in_carrier = parent < 0 ? own : carrier.pose * own;
  if (type == Type::kFixed) {
    links_.push_back({carrier.joint, in_carrier, parent, false});
  } else {
    // Each joint comes after the one that carries it.
    assert(carrier.joint < static_cast<int>(joints_.size()));
    Joint joint{type == Type::kRevolute, carrier.joint, in_carrier, axis, {}, {}, {}};
    const double(&rotation)[9] = joint.origin.pose.rotation;
    joint.axis_in_parent = rotated(rotation, axis);
    timesCross(rotation, axis, joint.sine_rotation);
    timesCross(joint.sine_rotation, axis, joint.cosine_rotation);
    links_.push_back({static_cast<int>(joints_.size()), {}, parent, true});
    joints_.push_back(joint);
  }
  assert(links_.back().joint < static_cast<int>(joints_.size()));
  return static_cast<int>(links_.size()) - 1;
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
