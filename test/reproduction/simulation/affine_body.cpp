// SPDX-License-Identifier: BSD-3-Clause
#include "affine_body.h"

#include <Eigen/SVD>
#include <algorithm>

namespace fcl {
namespace test {

Matrix3<double> closestRotation(const Matrix3<double>& shape) {
  const Eigen::JacobiSVD<Matrix3<double>> svd(shape,
                                              Eigen::ComputeFullU | Eigen::ComputeFullV);
  Matrix3<double> u = svd.matrixU();
  if (u.determinant() * svd.matrixV().determinant() < 0) u.col(2) = -u.col(2);
  return u * svd.matrixV().transpose();
}

Vector3<double> AffineBody::setMasses(const std::vector<Vector3<double>>& rest,
                                      const std::vector<double>& masses) {
  double mass = 0;
  Vector3<double> centre = Vector3<double>::Zero();
  for (std::size_t i = 0; i < rest.size(); ++i) {
    mass += masses[i];
    centre += masses[i] * rest[i];
  }
  centre /= mass;
  radius = 0;
  Matrix3<double> moment = Matrix3<double>::Zero();
  for (std::size_t i = 0; i < rest.size(); ++i) {
    const Vector3<double> r = rest[i] - centre;
    moment += masses[i] * r * r.transpose();
    radius = std::max(radius, r.norm());
  }
  inverse_mass = 1 / mass;
  inverse_moment = moment.inverse();
  return centre;
}

void AffineBody::predict(double dt, const Vector3<double>& gravity, double kept,
                         double deforming_kept) {
  // The skew part of the velocity's gradient is the rotation, the rest is the
  // deformation.
  const Matrix3<double> gradient = velocity.shape * begin.shape.inverse();
  const Matrix3<double> turning = 0.5 * (gradient - gradient.transpose());
  const Matrix3<double> deforming = gradient - turning;
  velocity.shape = kept * (turning + deforming_kept * deforming) * begin.shape;
  if (!isRigid()) {
    const double pull = std::min(1.0, frequency * frequency * dt * dt) / dt;
    velocity.shape += pull * (closestRotation(begin.shape) - begin.shape);
  }
  velocity.centre = kept * velocity.centre + dt * gravity;
  end.centre = begin.centre + dt * velocity.centre;
  end.shape = begin.shape + dt * velocity.shape;
  restoreShape();
}

void AffineBody::slowDown(double dt) {
  if (!is_slowed) {
    wanted_velocity.centre = 0.8 / dt * (end.centre - begin.centre);
    wanted_velocity.shape = 0.8 / dt * (end.shape - begin.shape);
  }
  is_slowed = true;
  end.centre = 0.5 * (begin.centre + end.centre);
  end.shape = 0.5 * (begin.shape + end.shape);
}

void AffineBody::finish(double dt) {
  if (is_slowed) {
    velocity = wanted_velocity;
  } else {
    velocity.centre = (end.centre - begin.centre) / dt;
    velocity.shape = (end.shape - begin.shape) / dt;
  }
  begin = end;
}

void AffineBody::limitSpeed(double most) {
  const double bound = speedBound();
  if (bound <= most) return;
  velocity.centre *= most / bound;
  velocity.shape *= most / bound;
}

}  // namespace test
}  // namespace fcl
