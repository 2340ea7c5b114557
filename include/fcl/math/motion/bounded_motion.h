// SPDX-License-Identifier: BSD-3-Clause
//
// Motion classes of a program that continuous queries can follow.
#ifndef FCL_MATH_MOTION_BOUNDED_MOTION_H
#define FCL_MATH_MOTION_BOUNDED_MOTION_H

namespace fcl {

/// @brief What the queries of this library need to know about a motion class of a
/// program. Derive the class from `MotionBase<S>` and from this one. Then the @ref
/// continuous_queries of meshes, shapes and octrees follow it like FCL's own motions:
/// with contacts, never late, no contact missed. If a rigid mesh, a shape or an octree
/// follows a motion class that is no BoundedMotion, FCL answers, from samples.
///
/// t runs from 0 to 1. A point x of the body is at p(t) = R(t) x + T(t). The true path is
/// a smooth one for which the bounds hold and from which placementAt() and rateAt()
/// differ by rounding only: by at most 2^-47 in an entry of R, 2^-49 of the largest |T|
/// in T, and 2^-46 of the speed of a point in its velocity. A motion that rounds more,
/// such as a product of many rotations, says so in moreRounding(). R is a rotation up to
/// 2^-40. If a bound is too small, contacts may be missed. If it is too large, queries
/// are slower.
///
/// Queries know a BoundedMotion by its RTTI, so it does not compile with -fno-rtti.
///
/// Thread-safety: queries call the functions from their threads, possibly several at the
/// same time. What a function throws reaches the caller of the query.
class BoundedMotion {
 public:
  /// @brief R row by row, and T; or their derivatives by t.
  struct Placement {
    double rotation[9];
    double translation[3];
  };

  /// @brief Rounding beyond that of the contract: bounds on the errors of R(t) x and of
  /// R'(t) x for |x| = 1, and of T(t) and T'(t), for t in [0, 1].
  struct Rounding {
    double rotation;
    double rotation_rate;
    double translation;
    double translation_rate;
  };

#if !defined(__GXX_RTTI) && !defined(__cpp_rtti)
  BoundedMotion() = delete;  // Queries know it by its RTTI: compile without -fno-rtti
#endif

  virtual ~BoundedMotion() = default;

  /// @brief R(t) and T(t).
  virtual Placement placementAt(double t) const = 0;

  /// @brief R'(t) and T'(t).
  virtual Placement rateAt(double t) const = 0;

  /// @brief Bound on the acceleration |p''(t)| during [t0, t1] of all points within
  /// `radius` of `center`, in the frame of the body; at least 0, finite.
  virtual double accelerationBound(const double (&center)[3], double radius, double t0,
                                   double t1) const = 0;

  /// @brief Bound on the angular velocity during [t0, t1], in radians a step: |R'(t) x|
  /// is at most this times |x|. At least 0, finite.
  virtual double angularSpeedBound(double t0, double t1) const = 0;

  /// @brief Rounding of placementAt() and rateAt() that the contract does not cover; each
  /// at least 0, finite. The tolerance of a query grows with it.
  virtual Rounding moreRounding() const { return {0, 0, 0, 0}; }
};

}  // namespace fcl

#endif
