// SPDX-License-Identifier: BSD-3-Clause
//
// Solids that deform by an affine map. For example, a ball that is pressed flat on one
// side becomes an ellipsoid. After Mueller et al. 2005, "Meshless Deformations Based on
// Shape Matching", with its linear deformations. Here the map is the state, so that a
// contact moves the whole solid at once, however many vertices it has.
#ifndef FCL_TEST_REPRODUCTION_AFFINE_BODY_H
#define FCL_TEST_REPRODUCTION_AFFINE_BODY_H

#include <cmath>
#include <limits>
#include <vector>

#include "fcl/common/types.h"

namespace fcl {
namespace test {

/// @brief A position x -> centre + shape x, in metres; or its rate, in metres per second.
struct AffineState {
  Vector3<double> centre{Vector3<double>::Zero()};
  Matrix3<double> shape{Matrix3<double>::Identity()};
};

/// @brief The rotation that is closest to `shape`.
Matrix3<double> closestRotation(const Matrix3<double>& shape);

/// @brief A solid of particles on its surface. Rest positions are relative to its centre
/// of mass.
struct AffineBody {
  /// vertex ids in the simulator's mesh
  std::vector<int> vertices;
  double inverse_mass{0};          // 1 / kg
  double radius{0};                // of the particle farthest from the centre, at rest, m
  Matrix3<double> inverse_moment;  // of the sum of mass * rest * rest^T, 1 / (kg m^2)
  double frequency{std::numeric_limits<double>::infinity()};  // see SolidOptions
  AffineState begin;  // at the beginning of the step
  AffineState end;    // at the end of the step
  AffineState velocity{Vector3<double>::Zero(), Matrix3<double>::Zero()};
  AffineState wanted_velocity;  // of a body that is slowed
  int held_with{-1};            // the body with which it moves in this step, or -1
  bool is_slowed{false};        // moves less in this step than it wanted to

  /// @brief Sets mass and moment from the particles.
  /// @return their centre of mass; the caller subtracts it from their rest positions
  Vector3<double> setMasses(const std::vector<Vector3<double>>& rest,
                            const std::vector<double>& masses);

  /// @brief The inverse mass for a push at a point, 1 / kg. It is the same in all
  /// directions.
  /// @param weight, rest  those of the point, as in AffinePoint
  double mobility(double weight, const Vector3<double>& rest) const {
    return weight * weight * inverse_mass + rest.dot(inverse_moment * rest);
  }

  /// @brief Moves the end of the step by an impulse at a point. `impulse` is multiplied
  /// by the length of the step: kg m.
  void push(double weight, const Vector3<double>& rest, const Vector3<double>& impulse) {
    end.centre += weight * inverse_mass * impulse;
    end.shape += impulse * (inverse_moment * rest).transpose();
  }

  /// @brief Moves the end of the step to where velocity, gravity and the force to the
  /// shape at rest lead.
  /// @param kept  the fraction of the velocity that remains after a step
  /// @param deforming_kept  the same for the velocity of deformation
  void predict(double dt, const Vector3<double>& gravity, double kept,
               double deforming_kept);

  bool isRigid() const { return std::isinf(frequency); }

  /// @brief Replaces the shape of a rigid solid by the closest rotation.
  void restoreShape() {
    if (isRigid()) end.shape = closestRotation(end.shape);
  }

  /// @brief Halves the motion in this step. Most of the velocity stays, so that the next
  /// step differs from this one.
  void slowDown(double dt);

  /// @brief Computes the velocity from the step, and begins the next step.
  void finish(double dt);

  /// @brief A bound on the speed of the particles, m / s.
  double speedBound() const {
    return velocity.centre.norm() + radius * velocity.shape.norm();
  }

  /// @brief Scales the velocity down until speedBound() is at most this.
  void limitSpeed(double most);
};

}  // namespace test
}  // namespace fcl

#endif
