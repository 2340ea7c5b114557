// SPDX-License-Identifier: BSD-3-Clause
//
// FCL's motions in double, which are compiled in libfcl, read where their layout is
// libfcl's.
#include <typeinfo>

#include "fcl/math/motion/interp_motion.h"
#include "fcl/math/motion/screw_motion.h"
#include "fcl/math/motion/spline_motion.h"
#include "fcl/math/motion/translation_motion.h"
#include "fcl/narrowphase/detail/query_numbers.h"

namespace fcl {
namespace detail {
namespace {

PoseNumbers<double> toNumbers(const Transform3<double>& tf) {
  PoseNumbers<double> pose;
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) pose.rotation[3 * i + k] = tf.linear()(i, k);
    pose.translation[i] = tf.translation()[i];
  }
  return pose;
}

/// The transforms that a motion of FCL's was made from, which it keeps to itself.
template <typename Motion>
class MotionEnds : public Motion {
 public:
  static void read(const Motion& motion, PoseNumbers<double> (&pose)[2]) {
    pose[0] = toNumbers(motion.*(&MotionEnds::tf1));
    pose[1] = toNumbers(motion.*(&MotionEnds::tf2));
  }
};

/// Of this class and of none derived from it, which may move otherwise.
template <typename Motion>
const Motion* as(const MotionBase<double>& motion) {
  return typeid(motion) == typeid(Motion) ? static_cast<const Motion*>(&motion) : nullptr;
}

template <typename Motion>
void integrateCopy(const Motion& motion, PoseNumbers<double> (&pose)[2]) {
  // integrate() changes the motion.
  const Motion copy(motion);
  for (int end = 0; end < 2; ++end) {
    Transform3<double> tf;
    copy.integrate(end);
    copy.getCurrentTransform(tf);
    pose[end] = toNumbers(tf);
  }
}

}  // namespace

bool readFclMotion(const MotionBase<double>& motion, PoseNumbers<double> (&pose)[2],
                   bool& is_straight) {
  is_straight = true;
  if (const auto* translation = as<TranslationMotion<double>>(motion)) {
    integrateCopy(*translation, pose);
  } else if (const auto* interpolation = as<InterpMotion<double>>(motion)) {
    MotionEnds<InterpMotion<double>>::read(*interpolation, pose);
  } else if (const auto* screw = as<ScrewMotion<double>>(motion)) {
    MotionEnds<ScrewMotion<double>>::read(*screw, pose);
  } else if (const auto* spline = as<SplineMotion<double>>(motion)) {
    is_straight = false;
    integrateCopy(*spline, pose);
  } else {
    return is_straight = false;
  }
  return true;
}

}  // namespace detail
}  // namespace fcl
