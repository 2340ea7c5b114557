// SPDX-License-Identifier: BSD-3-Clause
//
// Motions by textbook formulas in Real, for comparison with the library's.
#ifndef FCL_TEST_SUPPORT_REFERENCE_MOTION_H
#define FCL_TEST_SUPPORT_REFERENCE_MOTION_H

#include "fcl/common/types.h"
#include "mesh_generators.h"
#include "paths/motion_path.h"
#include "random_direction.h"
#include "real.h"

namespace fcl {
namespace test {

struct RealPose {
  RealMatrix rotation;
  RealVector translation;

  RealVector operator*(const Vector3<double>& x) const {
    return rotation * x.cast<Real>() + translation;
  }
};

inline RealMatrix rotationAbout(const RealVector& axis, Real angle) {
  return Eigen::AngleAxis<Real>(angle, axis).toRotationMatrix();
}

inline detail::deformable::Pose toPose(const Transform3<double>& tf) {
  detail::deformable::Pose pose;
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) pose.rotation[3 * i + k] = tf.linear()(i, k);
    pose.translation[i] = tf.translation()[i];
  }
  return pose;
}

/// @brief A motion whose axis and angle are given, not computed from its end poses.
struct ReferenceMotion {
  enum class Kind { kInterpolation, kScrew, kSpline };
  Kind kind{Kind::kInterpolation};
  Transform3<double> beginning{Transform3<double>::Identity()};
  Transform3<double> end{Transform3<double>::Identity()};
  Vector3<double> axis{Vector3<double>::UnitX()};
  double angle{0};
  Vector3<double> reference{Vector3<double>::Zero()};
  Vector3<double> translation_points[4];
  Vector3<double> rotation_points[4];
  /// Points of the world are relative to it.
  Vector3<double> origin{Vector3<double>::Zero()};

  /// @brief Sets the rotation at the end.
  void turn(const Vector3<double>& about, double by) {
    axis = about;
    angle = by;
    end.linear() = (rotationAbout(about.cast<Real>().normalized(), by) *
                    beginning.linear().cast<Real>())
                       .cast<double>();
  }

  void move(const Vector3<double>& by) {
    beginning.pretranslate(by);
    end.pretranslate(by);
    for (auto& point : translation_points) point += by;
  }

  RealPose at(Real t) const { return kind == Kind::kSpline ? splineAt(t) : turnAt(t); }

  /// @brief The same motion in the library's form.
  detail::deformable::MotionPath path() const {
    using detail::deformable::MotionPath;
    if (kind == Kind::kScrew) return MotionPath::screw(toPose(beginning), toPose(end));
    if (kind == Kind::kInterpolation)
      return MotionPath::interpolation(toPose(beginning), toPose(end),
                                       {reference[0], reference[1], reference[2]});
    double translation[4][3], rotation[4][3];
    for (int i = 0; i < 4; ++i)
      for (int k = 0; k < 3; ++k) {
        translation[i][k] = translation_points[i][k];
        rotation[i][k] = rotation_points[i][k];
      }
    return MotionPath::spline(translation, rotation);
  }

  /// @brief The reversed motion. A spline's motion is reversed by its points only.
  ReferenceMotion reversed() const {
    ReferenceMotion out = *this;
    std::swap(out.beginning, out.end);
    out.axis = -axis;
    std::swap(out.translation_points[0], out.translation_points[3]);
    std::swap(out.translation_points[1], out.translation_points[2]);
    std::swap(out.rotation_points[0], out.rotation_points[3]);
    std::swap(out.rotation_points[1], out.rotation_points[2]);
    return out;
  }

 private:
  RealPose splineAt(Real t) const {
    const Real w[4] = {(1 - 3 * t + 3 * t * t - t * t * t) / 6,
                       (4 - 6 * t * t + 3 * t * t * t) / 6,
                       (1 + 3 * t + 3 * t * t - 3 * t * t * t) / 6, t * t * t / 6};
    RealPose pose{RealMatrix::Identity(), RealVector::Zero()};
    RealVector vector = RealVector::Zero();
    for (int i = 0; i < 4; ++i) {
      pose.translation +=
          w[i] * (translation_points[i].cast<Real>() - origin.cast<Real>());
      vector += w[i] * rotation_points[i].cast<Real>();
    }
    const Real length = vector.norm();
    if (length > 0) pose.rotation = rotationAbout(vector / length, length);
    return pose;
  }

  RealPose turnAt(Real t) const {
    const RealVector a = axis.cast<Real>().normalized();
    const RealMatrix r0 = beginning.linear().cast<Real>(), r1 = end.linear().cast<Real>();
    const RealVector t0 = beginning.translation().cast<Real>() - origin.cast<Real>(),
                     t1 = end.translation().cast<Real>() - origin.cast<Real>();
    RealPose pose{rotationAbout(a, angle * t) * r0, (1 - t) * t0 + t * t1};
    if (kind == Kind::kInterpolation) {
      const RealVector o = reference.cast<Real>();
      pose.translation += (1 - t) * (r0 * o) + t * (r1 * o) - pose.rotation * o;
    } else if (angle != 0) {
      // About the axis: a triangle with the angles w t / 2 and w (1 - t) / 2.
      const RealVector way = t1 - t0, across = way - a * a.dot(way);
      const Real half = static_cast<Real>(angle) / 2;
      const Real part = sin(half * t) / sin(half);
      pose.translation = t0 + a * (a.dot(way) * t) +
                         across * (part * cos(half * (1 - t))) -
                         a.cross(across) * (part * sin(half * (1 - t)));
    }
    return pose;
  }
};

inline Matrix3<double> randomRotation(Random& random) {
  Quaternion<double> q(random.uniform(-1, 1), random.uniform(-1, 1),
                       random.uniform(-1, 1), random.uniform(-1, 1));
  return q.normalized().toRotationMatrix();
}

/// @brief A motion of any kind between poses inside [-way, way]^3; angles from 0 to 170
/// degrees, tiny ones too.
inline ReferenceMotion randomMotion(Random& random, double way) {
  constexpr double kAngles[] = {0, 1e-10, 1e-5, 0.3, 1, 1.57, 2.5, 2.967};
  ReferenceMotion motion;
  motion.kind = static_cast<ReferenceMotion::Kind>(random.index(3));
  motion.beginning.linear() = randomRotation(random);
  motion.beginning.translation() = random.point(way);
  motion.end.translation() = random.point(way);
  const double angle = kAngles[random.index(8)];
  motion.turn(randomDirection(random), angle);
  if (random.index(2)) motion.reference = random.point(0.7);
  for (int i = 0; i < 4; ++i) {
    motion.translation_points[i] = random.point(way);
    motion.rotation_points[i] = random.point(angle / 1.7);
  }
  return motion;
}

}  // namespace test
}  // namespace fcl

#endif
