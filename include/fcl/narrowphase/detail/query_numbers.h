// SPDX-License-Identifier: BSD-3-Clause
//
// The border between a program and the library. The compiler's flags decide how Eigen
// aligns its types: with -march=native a Transform3, and each type that contains one, has
// another layout than in the library. So functions that are compiled with the program
// convert FCL's types into the plain numbers below, and convert the answer back
// (toNumbers(), toTransform(), movingGeometry()). Only these numbers cross the border,
// and types without alignment of their own: geometries, requests, contacts, vectors of
// three. FCL's motions in double cross too, since libfcl compiles them and decides their
// layout.
#ifndef FCL_NARROWPHASE_DETAIL_QUERY_NUMBERS_H
#define FCL_NARROWPHASE_DETAIL_QUERY_NUMBERS_H

#include <cmath>
#include <cstddef>
#include <cstring>
#include <functional>
#include <limits>
#include <memory>
#include <typeinfo>

#include "fcl/common/types.h"
#include "fcl/geometry/collision_geometry.h"
#include "fcl/math/motion/bounded_motion.h"
#include "fcl/math/motion/motion_base.h"
#include "fcl/narrowphase/collision_object.h"
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

/// @brief Copies the 16 numbers of a Transform3. With AVX, Eigen aligns it to 32 bytes.
/// Before C++17 `new` and std::make_shared align to 16 only, and FCL's own functions, in
/// libfcl, need no more. Eigen would stop the program if it read such a transform here,
/// and the compiler may choose instructions that need the alignment. So it is copied in
/// the library, which knows nothing of the type.
template <typename S>
FCL_EXPORT void copyEntries(const S* from, S* to);

/// @brief The place of an entry in the numbers of a Transform3.
template <typename S>
constexpr int entryOf(int row, int column) {
  return Transform3<S>::MatrixType::IsRowMajor ? 4 * row + column : 4 * column + row;
}

/// @brief FCL's transform as numbers. Compiled with the caller.
/// @param tf  may lack the alignment of its type
template <typename S>
PoseNumbers<S> toNumbers(const Transform3<S>& tf) {
  S entries[16];
  detail::copyEntries(tf.data(), entries);
  PoseNumbers<S> pose;
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k)
      pose.rotation[3 * i + k] = entries[detail::entryOf<S>(i, k)];
    pose.translation[i] = entries[detail::entryOf<S>(i, 3)];
  }
  return pose;
}

/// @brief Numbers as FCL's transform. Compiled with the caller.
template <typename S>
Transform3<S> toTransform(const PoseNumbers<S>& pose) {
  Transform3<S> tf = Transform3<S>::Identity();
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) tf.linear()(i, k) = pose.rotation[3 * i + k];
    tf.translation()[i] = pose.translation[i];
  }
  return tf;
}

/// @brief Numbers into a transform of the program.
/// @param tf  may lack the alignment of its type
template <typename S>
void setTransform(const PoseNumbers<S>& pose, Transform3<S>& tf) {
  S entries[16] = {};
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k)
      entries[detail::entryOf<S>(i, k)] = pose.rotation[3 * i + k];
    entries[detail::entryOf<S>(i, 3)] = pose.translation[i];
  }
  entries[15] = 1;
  detail::copyEntries(entries, tf.data());
}

/// @brief Whether the rows of a matrix have length 1 and are at right angles up to 2^-10.
/// Queries take such a matrix as it is: rotations that were computed in float, or typed
/// with four digits. The sign of its determinant is not looked at.
template <typename S>
bool isRotationAsGiven(const S (&r)[9]) {
  constexpr double kMostDeviation = 1. / (1 << 10);
  bool is_rotation = true;
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k <= i; ++k) {
      double product = i == k ? -1 : 0;
      for (int c = 0; c < 3; ++c)
        product += static_cast<double>(r[3 * i + c]) * static_cast<double>(r[3 * k + c]);
      is_rotation &= std::abs(product) <= kMostDeviation;
    }
  return is_rotation;
}

/// @brief Whether two poses have the same rotation. Rotations are computed from
/// quaternions and products, so that a constant rotation may differ by a few roundings at
/// the end (by one as a rule).
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
  /// On a straight line. If the rotation changes, a rigid mesh turns about its origin,
  /// and each vertex of a mesh that deforms goes straight.
  kStraight,
  kTurn,       ///< turns about a reference point, which goes straight
  kScrew,      ///< turns about an axis and slides along it
  kSpline,     ///< as FCL's SplineMotion
  kUndefined,  ///< a spline between two transforms, which has no control points
  kBounded,    ///< a motion class of the program that is a BoundedMotion
  kUnknown     ///< another motion class of the program
};

/// @brief The frame of a part of a compound in that of the body.
struct PartOffset {
  /// False: the geometry is no part, and its frame is that of the body.
  bool is_set;
  double rotation[9];
  double translation[3];
};

/// @brief A geometry and how it moves during the step.
template <typename S>
struct MovingGeometry {
  const CollisionGeometry<S>* geometry;
  /// Poses at t = 0 and t = 1. Not used for a rigid mesh whose path is unknown.
  PoseNumbers<S> pose[2];
  PathKind path;
  /// kTurn: the reference point, in the frame of the geometry.
  double reference[3];
  /// kSpline: the control points of the translation and of the rotation vector.
  double control[2][4][3];
  /// kBounded: the motion.
  const BoundedMotion* motion;
  /// kTurn, kScrew: the axis of the motion object, which tells which way round a half
  /// turn goes. Zero: the way of FCL's constructors.
  double axis[3];
  /// Of a part: all above is of the body that carries it. Not with kBounded.
  PartOffset offset;
};

/// @brief A geometry that goes from one transform to another. Compiled with the caller.
template <typename S>
MovingGeometry<S> movingGeometry(const CollisionGeometry<S>* o,
                                 const Transform3<S>& tf_beg, const Transform3<S>& tf_end,
                                 PathKind path = PathKind::kStraight) {
  return {o,    {detail::toNumbers(tf_beg), detail::toNumbers(tf_end)},
          path, {},
          {},   nullptr,
          {},   {}};
}

/// @brief What a geometry of this type is, for messages.
inline const char* kindOf(NODE_TYPE type) {
  switch (type) {
    case BV_AABB:
      return "a model of AABBs";
    case BV_OBB:
      return "a model of OBBs";
    case BV_RSS:
      return "a model of RSSs";
    case BV_kIOS:
      return "a model of kIOSs";
    case BV_OBBRSS:
      return "a model of OBBRSSs";
    case BV_KDOP16:
    case BV_KDOP18:
    case BV_KDOP24:
      return "a model of KDOPs";
    case GEOM_BOX:
      return "a box";
    case GEOM_SPHERE:
      return "a sphere";
    case GEOM_CAPSULE:
      return "a capsule";
    case GEOM_ELLIPSOID:
      return "an ellipsoid";
    case GEOM_CONE:
      return "a cone";
    case GEOM_CYLINDER:
      return "a cylinder";
    case GEOM_CONVEX:
      return "a convex";
    case GEOM_PLANE:
      return "a plane";
    case GEOM_HALFSPACE:
      return "a halfspace";
    case GEOM_TRIANGLE:
      return "a TriangleP";
    case GEOM_OCTREE:
      return "an octree";
    default:
      return "a geometry that is none of FCL's";
  }
}

/// @brief The answer: the fields of FCL's own result, with the time bracket of the first
/// contact, and the time of the poses in place of these.
template <typename S>
struct QueryOutcome {
  bool is_collide;
  S toc_lo;
  S toc_hi;
  S pose_time;
};

/// @brief The continuous query of a pair.
/// @tparam Request  ContinuousCollisionRequest or ContinuousContactRequest, of S
/// @param contacts  takes the contacts; null if the request is not for contacts
/// @return false when FCL has to answer the pair; nothing has changed then.
/// @throws fcl::Exception as continuousCollide()
template <typename S, typename Request>
FCL_EXPORT bool answerPair(const MovingGeometry<S>& o1, const MovingGeometry<S>& o2,
                           const Request& request, QueryOutcome<S>& outcome,
                           ContinuousContacts<S>* contacts);

/// @brief Throws fcl::Exception, which tells why there are no contacts of a pair for
/// which answerPair() returned false, and the way out.
template <typename S>
FCL_EXPORT void refuseContacts(const MovingGeometry<S>& o1, const MovingGeometry<S>& o2);

/// @brief Throws fcl::Exception, which tells why answerPair() returned false for a pair
/// between transforms in float, where FCL has no query either, and the way out.
[[noreturn]] FCL_EXPORT void refuseTransforms(const MovingGeometry<float>& o1,
                                              const MovingGeometry<float>& o2);

/// @brief The continuous query of a mesh with itself.
/// @tparam Request  as of answerPair()
/// @param contacts  as of answerPair()
template <typename S, typename Request>
FCL_EXPORT void answerSelf(const CollisionGeometry<S>* o, const Request& request,
                           QueryOutcome<S>& outcome, ContinuousContacts<S>* contacts);

/// @brief The same type as ContinuousCandidateSink.
using CandidateSink =
    std::function<bool(const ContinuousCandidate* candidates, std::size_t count)>;

/// @brief The pose at t of a geometry that this library answers. If a mesh deforms and
/// its vertices go straight, its translation is linear in t and it rotates at constant
/// speed; the vertices do not follow this rotation.
template <typename S>
FCL_EXPORT PoseNumbers<S> poseAt(const MovingGeometry<S>& o, S t);

/// @brief The pose at t = 1 as the query takes it: with the nearest rotation if it is
/// none.
template <typename S>
FCL_EXPORT PoseNumbers<S> lastPose(const MovingGeometry<S>& o);

/// @brief The candidates of a pair.
template <typename S>
FCL_EXPORT bool answerCandidates(const MovingGeometry<S>& o1, const MovingGeometry<S>& o2,
                                 const CandidateSink& sink, double min_distance);

/// @brief The candidates of a mesh with itself.
template <typename S>
FCL_EXPORT bool answerSelfCandidates(const CollisionGeometry<S>* o,
                                     const CandidateSink& sink, double min_distance);

/// @brief Whether a geometry is a mesh whose two frames differ.
template <typename S>
FCL_EXPORT bool isDeformingMesh(const CollisionGeometry<S>& o);

/// @brief Whether a geometry is a DeformableBVHModel.
template <typename S>
FCL_EXPORT bool isDeformableModel(const CollisionGeometry<S>& o);

/// @brief Reads the path of a motion whose class is exactly one of FCL's. Returns false
/// for any other class. The motion is not changed. The ends of the path are the
/// transforms that the motion was made from, where FCL keeps them. FCL's integrate() may
/// end elsewhere: for an InterpMotion it reads a reference point that the constructor of
/// two transforms does not set, and a ScrewMotion without rotation goes too far.
FCL_EXPORT bool readFclMotion(const MotionBase<double>& motion,
                              MovingGeometry<double>& moving);

// A program may be compiled with -fno-rtti. Then its headers can use neither typeid nor
// dynamic_cast, and the classes that it compiles have no typeinfo: to read it would
// crash.

/// @brief The table of virtual functions of an object whose first base has one.
inline const void* const* virtualTableOf(const void* object) {
  const void* const* table;
  std::memcpy(&table, object, sizeof table);
  return table;
}

/// @brief The typeinfo of the class of an object: the entry before the virtual functions
/// (Itanium C++ ABI, 2.5.2). Null if the class was compiled with -fno-rtti.
inline const std::type_info* typeInfoOf(const void* object) {
  return static_cast<const std::type_info*>(virtualTableOf(object)[-1]);
}

/// @brief Whether two objects have exactly the same class. Without a typeinfo, their
/// tables of virtual functions tell.
/// @tparam Base  the polymorphic class through which both are known
template <typename Base>
bool haveSameClass(const Base& x, const Base& y) {
  if (detail::virtualTableOf(&x) == detail::virtualTableOf(&y)) return true;
  const std::type_info *of_x = detail::typeInfoOf(&x), *of_y = detail::typeInfoOf(&y);
  return of_x && of_y && *of_x == *of_y;
}

/// @brief The motion as a BoundedMotion; null if it is none.
template <typename S>
FCL_EXPORT const BoundedMotion* asBoundedMotion(const MotionBase<S>& motion);

/// @brief The transform of an object. libfcl decides the layout of the object, so it is
/// read by libfcl's functions.
FCL_EXPORT PoseNumbers<double> transformOf(const CollisionObject<double>& o);

/// @brief A copy of a BVHModel that shares nothing with it. Returns the model itself when
/// its bounding volumes are not FCL's.
template <typename S>
FCL_EXPORT std::shared_ptr<const CollisionGeometry<S>> copyModel(
    const CollisionGeometry<S>& o);

}  // namespace detail
}  // namespace fcl

#endif
