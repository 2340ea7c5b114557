// SPDX-License-Identifier: BSD-3-Clause
//
// The border between a program and the library. Eigen aligns its types as the compiler's
// flags allow, so that with -march=native a Transform3, and what contains one, has
// another layout than in the library. Functions that are compiled with the program take
// FCL's types apart into the plain numbers below and put the answer back; only these
// numbers, and types without alignment of their own (geometries, requests, contacts,
// vectors of three), cross. FCL's motions in double cross too: they are compiled, and
// laid out, in libfcl.
#ifndef FCL_NARROWPHASE_DETAIL_QUERY_NUMBERS_H
#define FCL_NARROWPHASE_DETAIL_QUERY_NUMBERS_H

#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <memory>

#include "fcl/geometry/collision_geometry.h"
#include "fcl/math/motion/motion_base.h"
#include "fcl/narrowphase/continuous_contact.h"

namespace fcl {

struct ContinuousCandidate;

namespace detail {

/// @brief A transform as numbers: its rotation row by row, then its translation.
template <typename S>
struct PoseNumbers {
  S rotation[9];
  S translation[3];
};

/// @brief Whether two poses have one rotation. Rotations are made of quaternions and
/// products: one that stays the same may differ at the end, by a few roundings (one as a
/// rule).
template <typename S>
bool isConstantRotation(const PoseNumbers<S>& beg, const PoseNumbers<S>& end) {
  const S rounding = 8 * std::numeric_limits<S>::epsilon();
  bool is_constant = true;
  for (int i = 0; i < 9; ++i)
    is_constant &= std::abs(end.rotation[i] - beg.rotation[i]) <= rounding;
  return is_constant;
}

/// @brief How a geometry gets from its first pose to its last.
enum class PathKind {
  /// On a straight line. A rigid mesh whose rotation changes turns about its origin; the
  /// vertices of a mesh that deforms all go straight.
  kStraight,
  kTurn,       ///< turns about a reference point, which goes straight
  kScrew,      ///< turns about an axis and slides along it
  kSpline,     ///< as FCL's SplineMotion
  kUndefined,  ///< a spline between two transforms, which has no control points
  kUnknown     ///< a class of motion of the program's own
};

/// @brief A geometry and how it moves during the step.
template <typename S>
struct MovingGeometry {
  const CollisionGeometry<S>* geometry;
  /// Poses at t = 0 and t = 1; of a rigid mesh whose path is unknown they do not count.
  PoseNumbers<S> pose[2];
  PathKind path;
  /// kTurn: the reference point, in the frame of the geometry.
  double reference[3];
  /// kSpline: the control points of the translation and of the rotation vector.
  double control[2][4][3];
};

/// @brief What errors say of a pair that is FCL's.
constexpr const char* kNotAnsweredHere =
    " of continuous collision need two triangle meshes, and motions that are FCL's: "
    "TranslationMotion, InterpMotion, ScrewMotion or SplineMotion";

/// @brief What is asked for.
struct QuerySettings {
  double toc_err;
  /// Whether a request for contacts was made: the rest counts only then.
  bool with_contacts;
  ContinuousQuery query;
  std::size_t num_max_contacts;
  bool enable_contact;
  int num_threads;
};

/// @brief What is answered: the part of the result that FCL's own type has, with the time
/// bracket of the first contact in place of poses.
template <typename S>
struct QueryOutcome {
  bool is_collide;
  S toc_lo;
  S toc_hi;
};

/// @brief The continuous query of a pair.
/// @param contacts  where contacts go; null without settings.with_contacts
/// @return false when the pair is FCL's; nothing has changed then.
/// @throws fcl::Exception as continuousCollide()
template <typename S>
FCL_EXPORT bool answerPair(const MovingGeometry<S>& o1, const MovingGeometry<S>& o2,
                           const QuerySettings& settings, QueryOutcome<S>& outcome,
                           ContinuousContacts<S>* contacts);

/// @brief The continuous query of a mesh with itself.
template <typename S>
FCL_EXPORT void answerSelf(const CollisionGeometry<S>* o, const QuerySettings& settings,
                           QueryOutcome<S>& outcome, ContinuousContacts<S>* contacts);

/// @brief ContinuousCandidateSink.
using CandidateSink =
    std::function<bool(const ContinuousCandidate* candidates, std::size_t count)>;

/// @brief Where a geometry that is answered here is at t, on its path. Of a mesh that
/// deforms and goes straight: translation on a straight line, rotation at constant speed
/// (its vertices do not follow that).
template <typename S>
FCL_EXPORT PoseNumbers<S> poseAt(const MovingGeometry<S>& o, S t);

/// @brief The candidates of a pair.
template <typename S>
FCL_EXPORT bool answerCandidates(const MovingGeometry<S>& o1, const MovingGeometry<S>& o2,
                                 const CandidateSink& sink);

/// @brief The candidates of a mesh with itself.
template <typename S>
FCL_EXPORT bool answerSelfCandidates(const CollisionGeometry<S>* o,
                                     const CandidateSink& sink);

/// @brief Whether a geometry is a mesh whose two frames differ.
template <typename S>
FCL_EXPORT bool isDeformingMesh(const CollisionGeometry<S>& o);

/// @brief Whether a geometry is a DeformableBVHModel.
template <typename S>
FCL_EXPORT bool isDeformableModel(const CollisionGeometry<S>& o);

/// @brief Reads the path of a motion that is exactly one of FCL's own classes, which
/// stays as it is; false for any other. Where FCL keeps the transforms that a motion was
/// made from, these are the ends: FCL's integrate() reads a reference point that its
/// constructor of two transforms never sets (InterpMotion), and goes too far without a
/// rotation (ScrewMotion). These classes are compiled in libfcl, and are laid out as
/// there.
FCL_EXPORT bool readFclMotion(const MotionBase<double>& motion,
                              MovingGeometry<double>& moving);

/// @brief A copy of a BVHModel that shares nothing with it; the model itself when its
/// bounding volumes are none of FCL's.
template <typename S>
FCL_EXPORT std::shared_ptr<const CollisionGeometry<S>> copyModel(
    const CollisionGeometry<S>& o);

/// @brief The part of FCL's result that its function may set; poses only with a
/// collision.
struct FclOutcome {
  bool is_collide;
  float time_of_contact;
  PoseNumbers<float> contact_pose[2];
};

/// @brief FCL's own answer in float, which libfcl does not have.
/// @return what FCL returns
/// @throws fcl::Exception  an interpolated or a screw motion, which FCL has not in float
FCL_EXPORT float askFclInFloat(const MovingGeometry<float>& o1,
                               const MovingGeometry<float>& o2,
                               const ContinuousCollisionRequest<float>& request,
                               FclOutcome& outcome);

}  // namespace detail
}  // namespace fcl

#endif
