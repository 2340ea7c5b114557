// SPDX-License-Identifier: BSD-3-Clause
//
// A prepared mesh whose poses are FCL's transforms.
#ifndef FCL_TEST_SUPPORT_PLACED_MESH_H
#define FCL_TEST_SUPPORT_PLACED_MESH_H

#include "prepare/prepared_mesh.h"

namespace fcl {
namespace test {

template <typename S>
detail::deformable::Pose poseOf(const Transform3<S>& tf) {
  detail::deformable::Pose pose;
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k)
      pose.rotation[3 * i + k] = static_cast<double>(tf.linear()(i, k));
    pose.translation[i] = static_cast<double>(tf.translation()[i]);
  }
  return pose;
}

class PlacedMesh : public detail::deformable::PreparedMesh {
 public:
  template <typename S>
  PlacedMesh(const CollisionGeometry<S>& geometry, const Transform3<S>& beginning,
             const Transform3<S>& end, const char* name)
      : PreparedMesh(geometry, poseOf(beginning), poseOf(end), name) {}
};

}  // namespace test
}  // namespace fcl

#endif
