// SPDX-License-Identifier: BSD-3-Clause
//
// Reads FCL's motions in double. They are compiled in libfcl, which decides their layout.
#include <cstddef>
#include <new>

#include "fcl/math/motion/interp_motion.h"
#include "fcl/math/motion/screw_motion.h"
#include "fcl/math/motion/spline_motion.h"
#include "fcl/math/motion/translation_motion.h"
#include "fcl/narrowphase/detail/query_numbers.h"
#include "prepare/class_cast.h"

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

/// Reads the transforms from which a motion of FCL was made, which are protected.
template <typename Motion>
class MotionEnds : public Motion {
 public:
  static void read(const Motion& motion, PoseNumbers<double> (&pose)[2]) {
    pose[0] = toNumbers(motion.*(&MotionEnds::tf1));
    pose[1] = toNumbers(motion.*(&MotionEnds::tf2));
  }
};

/// A derived class may move differently: only this class itself is read.
template <typename Motion>
const Motion* as(const MotionBase<double>& motion) {
  return isExactly<Motion>(motion) ? static_cast<const Motion*>(&motion) : nullptr;
}

/// More than Eigen's alignment on any machine, and so right for any libfcl.
constexpr std::size_t kMostAlignment = 64;

PoseNumbers<double> integrate(const MotionBase<double>& motion, double t) {
  alignas(kMostAlignment) Transform3<double> tf;
  motion.integrate(t);
  motion.getCurrentTransform(tf);
  return toNumbers(tf);
}

void integrate(const MotionBase<double>& motion, PoseNumbers<double> (&pose)[2]) {
  for (int end = 1; end >= 0; --end) pose[end] = integrate(motion, end);
}

template <typename Motion>
void integrateCopy(const Motion& motion, PoseNumbers<double> (&pose)[2]) {
  // integrate() changes the motion, although it is const.
  // NOLINTNEXTLINE(performance-unnecessary-copy-initialization)
  const Motion copy(motion);
  integrate(copy, pose);
}

/// Whether libfcl's layout of motions is that of this file. libfcl makes a motion, and
/// its own functions are compared with what is read here.
bool isLaidOutAsHere() {
  alignas(kMostAlignment) Transform3<double> beg = Transform3<double>::Identity();
  alignas(kMostAlignment) Transform3<double> end = beg;
  end.translation() = Vector3<double>(1, 2, 3);
  // The memory is larger than the size that this file knows.
  using Motion = InterpMotion<double>;
  alignas(kMostAlignment) unsigned char memory[2 * sizeof(Motion)] = {};
  auto* motion = new (memory) Motion(beg, end);
  PoseNumbers<double> pose[2];
  MotionEnds<Motion>::read(*motion, pose);
  const bool ends_are_there = pose[0].rotation[8] == 1 && pose[1].translation[0] == 1 &&
                              pose[1].translation[1] == 2 && pose[1].translation[2] == 3;
  motion->~Motion();

  // If Eigen aligns to 32 bytes, this is the only class that differs: it has a gap before
  // its last member.
  using Translation = TranslationMotion<double>;
  alignas(kMostAlignment) unsigned char more_memory[2 * sizeof(Translation)] = {};
  auto* translation = new (more_memory) Translation(beg, end);
  const Translation copy(*translation);
  alignas(kMostAlignment) Transform3<double> copied;
  copy.getCurrentTransform(copied);
  const bool copies_are_whole = toNumbers(copied).rotation[8] == 1;
  translation->~Translation();
  return ends_are_there && copies_are_whole;
}

}  // namespace

namespace {

/// Reads the control points of a spline, which are protected.
class SplineControl : public SplineMotion<double> {
 public:
  static void read(const SplineMotion<double>& motion, double (&control)[2][4][3]) {
    const Vector3<double>(&translation)[4] = motion.*(&SplineControl::Td);
    const Vector3<double>(&rotation)[4] = motion.*(&SplineControl::Rd);
    for (int i = 0; i < 4; ++i)
      for (int k = 0; k < 3; ++k) {
        control[0][i][k] = translation[i][k];
        control[1][i][k] = rotation[i][k];
      }
  }
};

void setAxis(const Vector3<double>& axis, MovingGeometry<double>& moving) {
  for (int k = 0; k < 3; ++k) moving.axis[k] = axis[k];
}

/// The axis of an interpolation. Its constructor of (tf1, tf2, O) sets neither the axis
/// nor the velocities, so that they have any value from memory. Then there is none: those
/// that a constructor computed are the turn between the poses, in one of two directions,
/// and the way of the reference point.
void readAxis(const InterpMotion<double>& motion, MovingGeometry<double>& moving) {
  constexpr double kRounding = 0x1p-20;
  const Vector3<double>&axis = motion.getAngularAxis(),
        &reference = motion.getReferencePoint();
  const Transform3<double> from = toTransform(moving.pose[0]),
                           to = toTransform(moving.pose[1]);
  const Vector3<double> begin = from * reference, end = to * reference;
  const AngleAxis<double> turn(to.linear() * from.linear().transpose());
  const bool is_set = std::abs(motion.getAngularVelocity() - turn.angle()) <= kRounding &&
                      std::abs(axis.norm() - 1) <= kRounding &&
                      std::abs(std::abs(axis.dot(turn.axis())) - 1) <= kRounding &&
                      (motion.getLinearVelocity() - (end - begin)).norm() <=
                          kRounding * (begin.norm() + end.norm());
  if (is_set) setAxis(axis, moving);
}

/// The axis of a rotation by less than a full turn, times twice the sine of half of its
/// angle, from the poses at t = 0 and t = 0.5.
void setAxisFromHalf(const PoseNumbers<double>& half, MovingGeometry<double>& moving) {
  const Matrix3<double> turn =
      toTransform(half).linear() * toTransform(moving.pose[0]).linear().transpose();
  setAxis({turn(2, 1) - turn(1, 2), turn(0, 2) - turn(2, 0), turn(1, 0) - turn(0, 1)},
          moving);
}

/// If libfcl was compiled for another machine, only its own functions can read its
/// motions. They give the ends of all motions and the axis of a screw, but no reference
/// point and no control points.
bool readForeignMotion(const MotionBase<double>& motion, MovingGeometry<double>& moving) {
  const bool is_turn = as<InterpMotion<double>>(motion),
             is_screw = as<ScrewMotion<double>>(motion),
             is_spline = as<SplineMotion<double>>(motion);
  if (!is_turn && !is_screw && !is_spline && !as<TranslationMotion<double>>(motion))
    return false;
  const PoseNumbers<double> half = integrate(motion, 0.5);
  integrate(motion, moving.pose);
  moving.path = is_screw ? PathKind::kScrew : PathKind::kStraight;
  if (is_screw) setAxisFromHalf(half, moving);
  if (is_spline || (is_turn && !isConstantRotation(moving.pose[0], moving.pose[1])))
    moving.path = PathKind::kUnknown;
  return true;
}

}  // namespace

bool readFclMotion(const MotionBase<double>& motion, MovingGeometry<double>& moving) {
  static const bool is_laid_out_as_here = isLaidOutAsHere();
  if (!is_laid_out_as_here) return readForeignMotion(motion, moving);
  if (const auto* translation = as<TranslationMotion<double>>(motion)) {
    moving.path = PathKind::kStraight;
    integrateCopy(*translation, moving.pose);
  } else if (const auto* interpolation = as<InterpMotion<double>>(motion)) {
    moving.path = PathKind::kTurn;
    MotionEnds<InterpMotion<double>>::read(*interpolation, moving.pose);
    const Vector3<double>& reference = interpolation->getReferencePoint();
    for (int k = 0; k < 3; ++k) moving.reference[k] = reference[k];
    readAxis(*interpolation, moving);
  } else if (const auto* screw = as<ScrewMotion<double>>(motion)) {
    moving.path = PathKind::kScrew;
    MotionEnds<ScrewMotion<double>>::read(*screw, moving.pose);
    setAxis(screw->getAxis(), moving);
  } else if (const auto* spline = as<SplineMotion<double>>(motion)) {
    moving.path = PathKind::kSpline;
    integrateCopy(*spline, moving.pose);
    SplineControl::read(*spline, moving.control);
  } else {
    return false;
  }
  return true;
}

}  // namespace detail
}  // namespace fcl
