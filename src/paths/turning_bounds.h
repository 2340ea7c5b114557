// SPDX-License-Identifier: BSD-3-Clause
//
// Bounds on the derivatives of products of rotations. A pose of a chain is such a
// product, and so is a rotation between two waypoints.
#ifndef FCL_CCD_PATHS_TURNING_BOUNDS_H
#define FCL_CCD_PATHS_TURNING_BOUNDS_H

#include <algorithm>
#include <cassert>
#include <cmath>
#include <vector>

#include "numerics/error_bounds.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief Those of a polynomial in t: the sum of coefficients[k] t^k.
using Coefficients = std::vector<double>;

inline double valueAt(const Coefficients& p, double t) {
  double value = 0;
  for (std::size_t k = p.size(); k-- > 0;) value = value * t + p[k];
  return value;
}

inline Coefficients derivativeOf(const Coefficients& p) {
  Coefficients out;
  for (std::size_t k = 1; k < p.size(); ++k) out.push_back(static_cast<double>(k) * p[k]);
  return out;
}

/// @brief The sum of |coefficients|: a bound on |p(t)| for t in [0, 1], and the size of
/// the terms that round.
inline double sizeOf(const Coefficients& p) {
  double size = 0;
  for (const double x : p) size += std::abs(x);
  return size;
}

/// @brief Bound on |p(t)| for t in [0, 1], at least 2^-10 of its size unless p is
/// constant. Between the middles of 32 parts p changes by at most its slope. So the bound
/// is too large by 1/64 of the largest slope, and the size of p by 2^-10.
double largestValue(const Coefficients& p);

/// @brief Bounds on the first three derivatives of a function of t.
struct DerivativeBounds {
  double first, second, third;
};

/// @brief Bounds on the derivatives of p.
DerivativeBounds derivativeBounds(const Coefficients& p);

/// @brief Bounds for the rotation by an angle about a fixed axis (spectral norm). R'' is
/// angle'' [a] R + angle'^2 [a]^2 R, of which the two terms are at right angles, and
/// R''' = (angle''' - angle'^3) [a] R + 3 angle' angle'' [a]^2 R.
inline DerivativeBounds boundsOfTurn(const DerivativeBounds& angle) {
  const auto length = [](double x, double y) {
    return std::sqrt(x * x + y * y) * kUpward;
  };
  const double square = angle.first * angle.first;
  return {angle.first, length(square, angle.second),
          length(angle.third + square * angle.first, 3 * angle.first * angle.second)};
}

/// @brief Bounds for the product of a rotation and of a factor whose own size is at most
/// `size`: another rotation, or a vector.
inline DerivativeBounds boundsOfProduct(const DerivativeBounds& rotation,
                                        const DerivativeBounds& factor, double size) {
  assert(!(size < 0));
  return {(rotation.first * size + factor.first) * kUpward,
          (rotation.second * size + 2 * rotation.first * factor.first + factor.second) *
              kUpward,
          (rotation.third * size + 3 * rotation.second * factor.first +
           3 * rotation.first * factor.second + factor.third) *
              kUpward};
}

inline DerivativeBounds operator+(const DerivativeBounds& x, const DerivativeBounds& y) {
  return {x.first + y.first, x.second + y.second, x.third + y.third};
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
