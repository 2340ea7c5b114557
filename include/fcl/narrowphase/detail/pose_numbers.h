// SPDX-License-Identifier: BSD-3-Clause
//
// Converts FCL's transforms into numbers and back. It is compiled with the program.
#ifndef FCL_NARROWPHASE_DETAIL_POSE_NUMBERS_H
#define FCL_NARROWPHASE_DETAIL_POSE_NUMBERS_H

#include "fcl/common/types.h"
#include "fcl/narrowphase/detail/query_numbers.h"

namespace fcl {
namespace detail {

template <typename S>
PoseNumbers<S> toNumbers(const Matrix3<S>& rotation, const Vector3<S>& translation) {
  PoseNumbers<S> pose;
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) pose.rotation[3 * i + k] = rotation(i, k);
    pose.translation[i] = translation[i];
  }
  return pose;
}

template <typename S>
PoseNumbers<S> toNumbers(const Transform3<S>& tf) {
  return toNumbers<S>(tf.linear(), tf.translation());
}

template <typename S>
Transform3<S> toTransform(const PoseNumbers<S>& pose) {
  Transform3<S> tf = Transform3<S>::Identity();
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) tf.linear()(i, k) = pose.rotation[3 * i + k];
    tf.translation()[i] = pose.translation[i];
  }
  return tf;
}

/// @brief A geometry that goes from one transform to another.
template <typename S>
MovingGeometry<S> movingGeometry(const CollisionGeometry<S>* o,
                                 const Transform3<S>& tf_beg, const Transform3<S>& tf_end,
                                 PathKind path = PathKind::kStraight) {
  return {o, {toNumbers(tf_beg), toNumbers(tf_end)}, path, {}, {}};
}

}  // namespace detail
}  // namespace fcl

#endif
