// SPDX-License-Identifier: BSD-3-Clause
//
// Solids that deform by an affine map: a ball that is pressed flat on one side becomes an
// ellipsoid. After Mueller et al. 2005, "Meshless Deformations Based on Shape Matching",
// with its linear deformations; here the map is the state, so that a contact moves the
// whole solid at once, however many vertices it has.
#ifndef FCL_TEST_SUPPORT_AFFINE_BODY_H
#define FCL_TEST_SUPPORT_AFFINE_BODY_H

#include <cmath>
#include <limits>
#include <vector>

#include "fcl/common/types.h"

namespace fcl {
namespace test {

/// @brief A place x -> centre + shape x, metres; or the speed of one, metres a second.
struct AffineState {
  Vector3<double> centre{Vector3<double>::Zero()};
  Matrix3<double> shape{Matrix3<double>::Identity()};
};

/// @brief The rotation closest to `shape`.
Matrix3<double> closestRotation(const Matrix3<double>& shape);

/// @brief A solid of particles on its surface. Rest positions are relative to its centre
/// of mass.
struct AffineBody {
  /// ids in the simulator's mesh
  std::vector<int> vertices;
  double inverse_mass{0};          // 1 / kg
  double radius{0};                // of the particle farthest from the centre, at rest, m
  Matrix3<double> inverse_moment;  // of the sum of mass * rest * rest^T, 1 / (kg m^2)
  double frequency{std::numeric_limits<double>::infinity()};  // see SolidOptions
  AffineState begin;                                          // of the step
  AffineState end;                                            // of the step
  AffineState velocity{Vector3<double>::Zero(), Matrix3<double>::Zero()};
  AffineState wanted_velocity;  // of a body that is slowed
  int held_with{-1};            // the body that it moves with in this step, or -1
  bool is_slowed{false};        // does not go as far in this step as it wanted to

  /// @brief Sets mass and moment from the particles.
  /// @return their centre of mass, which has to be taken from their rest positions
  Vector3<double> setMasses(const std::vector<Vector3<double>>& rest,
                            const std::vector<double>& masses);

  /// @brief How easily a push at a point moves it, 1 / kg: the same in all directions.
  /// @param weight, rest  of the point, as in AffinePoint
  double mobility(double weight, const Vector3<double>& rest) const {
    return weight * weight * inverse_mass + rest.dot(inverse_moment * rest);
  }

  /// @brief Moves the end of the step by an impulse at a point, divided by the step's
  /// length.
  void push(double weight, const Vector3<double>& rest, const Vector3<double>& impulse) {
    end.centre += weight * inverse_mass * impulse;
    end.shape += impulse * (inverse_moment * rest).transpose();
  }

  /// @brief Where the velocity, gravity and the wish for the shape at rest lead to.
  /// @param kept  part of the velocity that a step keeps
  /// @param deforming_kept  part of the velocity of deformation that a step keeps
  void predict(double dt, const Vector3<double>& gravity, double kept,
               double deforming_kept);

  bool isRigid() const { return std::isinf(frequency); }

  /// @brief Makes a rigid solid's shape a rotation again.
  void restoreShape() {
    if (isRigid()) end.shape = closestRotation(end.shape);
  }

  /// @brief Goes half as far in this step; most of the velocity stays, so that the next
  /// step is not the same again.
  void slowDown(double dt);

  /// @brief Takes the velocity from the step and begins the next one.
  void finish(double dt);

  /// @brief No particle is faster, m / s.
  double speedBound() const {
    return velocity.centre.norm() + radius * velocity.shape.norm();
  }

  /// @brief Slows the velocity as a whole to where speedBound() is no more.
  void limitSpeed(double most);
};

}  // namespace test
}  // namespace fcl

#endif
