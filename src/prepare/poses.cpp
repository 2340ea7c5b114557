// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cassert>

#include "base/default_floating_point.h"
#include "fcl/narrowphase/detail/query_numbers.h"
#include "prepare/prepared_motion.h"
#include "prepare/query_arguments.h"

namespace fcl {
namespace detail {
namespace {

template <typename S>
PoseNumbers<S> toNumbers(const deformable::Pose& pose) {
  PoseNumbers<S> out;
  const auto round = [](double x) { return static_cast<S>(x); };
  std::transform(pose.rotation, pose.rotation + 9, out.rotation, round);
  std::transform(pose.translation, pose.translation + 3, out.translation, round);
  return out;
}

}  // namespace

template <typename S>
PoseNumbers<S> poseAt(const MovingGeometry<S>& o, S t) {
  assert(!(t < 0) && !(t > 1));
  const deformable::DefaultFloatingPoint mode;
  const PlacedGeometry<S> placed(o);
  if (!placed.goesStraight())
    return toNumbers<S>(
        deformable::motionPathOf(placed, "the object").pose(static_cast<double>(t)));
  const PoseNumbers<S> first = toNumbers<S>(placed.beginning()),
                       last = toNumbers<S>(placed.end());
  // A matrix that scales is no quaternion.
  if (t == 0) return first;
  Transform3<S> tf = toTransform(first);
  const Transform3<S> end = toTransform(last);
  tf.translation() = ((1 - t) * tf.translation() + t * end.translation()).eval();
  if (!isConstantRotation(first, last))
    tf.linear() = Quaternion<S>(tf.linear())
                      .slerp(t, Quaternion<S>(end.linear()))
                      .toRotationMatrix();
  return toNumbers(tf);
}

template <typename S>
PoseNumbers<S> lastPose(const MovingGeometry<S>& o) {
  const deformable::DefaultFloatingPoint mode;
  const PlacedGeometry<S> placed(o);
  return placed.hasReplacedRotation() ? toNumbers<S>(placed.end()) : o.pose[1];
}

template PoseNumbers<double> poseAt(const MovingGeometry<double>&, double);
template PoseNumbers<float> poseAt(const MovingGeometry<float>&, float);
template PoseNumbers<double> lastPose(const MovingGeometry<double>&);
template PoseNumbers<float> lastPose(const MovingGeometry<float>&);

}  // namespace detail
}  // namespace fcl
