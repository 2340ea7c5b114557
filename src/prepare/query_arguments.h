// SPDX-License-Identifier: BSD-3-Clause
//
// Arguments and errors that all public queries have in common.
#ifndef FCL_CCD_PREPARE_QUERY_ARGUMENTS_H
#define FCL_CCD_PREPARE_QUERY_ARGUMENTS_H

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "fcl/common/exception.h"
#include "fcl/geometry/collision_geometry.h"
#include "fcl/narrowphase/detail/query_numbers.h"
#include "mesh/non_finite_vertex.h"
#include "prepare/convex_shapes.h"
#include "prepare/nearest_rotation.h"
#include "prepare/octree_nodes.h"
#include "prepare/prepared_mesh.h"
#include "query/feature_batch.h"

namespace fcl {
namespace detail {

inline void require(const void* argument, const char* name) {
  if (!argument) throw Exception(std::string(name) + " is null");
}

/// What a geometry is, for messages.
template <typename S>
const char* kindOf(const CollisionGeometry<S>& o) {
  if (deformable::meshKindOf(o) != deformable::MeshKind::kNotAMesh)
    return "a triangle mesh";
  if (o.getObjectType() != OT_BVH) return kindOf(o.getNodeType());
  return o.getNodeType() == BV_UNKNOWN ? "a model whose BV is none of FCL's"
                                       : "a point cloud";
}

template <typename S>
void requireMesh(const CollisionGeometry<S>& o, const char* function,
                 const char* name = "o") {
  if (deformable::meshKindOf(o) == deformable::MeshKind::kNotAMesh)
    throw Exception(std::string(function) + ": " + name + " is not a triangle mesh but " +
                    kindOf(o) +
                    ". Give a BVHModel or a DeformableBVHModel with triangles");
}

/// The width of the time bracket for the engine. The user's 0 becomes the smallest
/// positive double.
inline double requireTocErr(double toc_err, const char* name) {
  if (!(toc_err >= 0))
    throw Exception(std::string(name) + " is negative or NaN. Give 0 or more");
  return std::max(toc_err, std::numeric_limits<double>::min());
}

inline void requireDistance(double distance, const char* name) {
  if (!(distance >= 0) || !std::isfinite(distance))
    throw Exception(std::string(name) +
                    " is negative or not finite. Give 0 or more, in the unit of the "
                    "coordinates");
}

template <typename S>
deformable::Pose toPose(const PoseNumbers<S>& numbers) {
  deformable::Pose pose;
  for (int k = 0; k < 9; ++k) pose.rotation[k] = numbers.rotation[k];
  for (int k = 0; k < 3; ++k) pose.translation[k] = numbers.translation[k];
  return pose;
}

/// A geometry and the poses in which a query prepares it. It must be made in the default
/// floating-point mode. Other modes may flush subnormal floats to zero in the conversion.
template <typename S>
class PlacedGeometry {
 public:
  explicit PlacedGeometry(const MovingGeometry<S>& moving)
      : moving_(moving),
        is_shape_(deformable::isConvexShape(*moving.geometry)),
        kind_(is_shape_ ? deformable::MeshKind::kNotAMesh
                        : deformable::meshKindOf(*moving.geometry)),
        is_octree_(!is_shape_ && deformable::isOctree(*moving.geometry)) {
    using deformable::MeshKind;
    beginning_ = toPose(moving.pose[0]);
    end_ = toPose(moving.pose[1]);
    const bool is_constant = isConstantRotation(moving.pose[0], moving.pose[1]);
    // A rotation that differs by a few roundings only is constant.
    if (isRigid() && is_constant)
      std::copy(beginning_.rotation, beginning_.rotation + 9, end_.rotation);
    const bool bends = moving.path == PathKind::kSpline ||
                       moving.path == PathKind::kBounded || (isTurn() && !is_constant);
    if (kind_ == MeshKind::kDeforming) goes_straight_ = !bends;
    if (isRigid())
      goes_straight_ = !bends && is_constant && moving.path != PathKind::kUnknown;
    if (isMesh() && goes_straight_) return;
    // A turn is defined between rotations only, and a sphere that is sheared is no
    // sphere.
    const bool has_poses =
        moving.path != PathKind::kBounded && moving.path != PathKind::kSpline;
    for (deformable::Pose* pose : {&beginning_, &end_})
      are_rotations_ &= takeRotation(pose->rotation, has_poses);
  }

  const CollisionGeometry<S>& geometry() const { return *moving_.geometry; }
  const MovingGeometry<S>& moving() const { return moving_; }
  const deformable::Pose& beginning() const { return beginning_; }
  const deformable::Pose& end() const { return end_; }

  bool isMesh() const { return kind_ != deformable::MeshKind::kNotAMesh; }
  bool isShape() const { return is_shape_; }
  bool isOctree() const { return is_octree_; }
  bool isRigid() const {
    return kind_ == deformable::MeshKind::kRigid || is_shape_ || is_octree_;
  }

  /// Whether all vertices move on straight lines.
  bool goesStraight() const { return goes_straight_; }

  /// Whether both poses are rotations, or were replaced by the nearest ones. Always true
  /// for a mesh whose vertices go straight: it may be scaled, mirrored or sheared.
  bool areRotations() const { return are_rotations_; }

  /// Whether a pose was replaced by the nearest rotation.
  bool hasReplacedRotation() const { return has_replaced_rotation_; }

  /// @throws fcl::Exception  a number of a pose is not finite
  void requireFinitePoses(const char* name) const {
    // The numbers of rotations are finite.
    if (!isMesh() && are_rotations_) {
      double sum = 0;  // NaN if a number is not finite
      for (int k = 0; k < 3; ++k)
        sum += 0 * beginning_.translation[k] + 0 * end_.translation[k];
      if (sum == 0) return;
    }
    deformable::requireFinite(beginning_, end_, name);
  }

  /// Whether this library can follow the path.
  bool isKnown() const {
    return (isMesh() || isShape() || isOctree()) &&
           (goes_straight_ || moving_.path != PathKind::kUnknown);
  }

 private:
  bool isTurn() const {
    return moving_.path == PathKind::kTurn || moving_.path == PathKind::kScrew;
  }

  /// Replaces a matrix by the nearest rotation if it is none as it is. The numbers of a
  /// BoundedMotion are not replaced: it promises rotations.
  bool takeRotation(double (&matrix)[9], bool may_replace) {
    if (isRotationAsGiven(matrix)) return deformable::determinantOf(matrix) > 0;
    if (!may_replace || !deformable::toNearestRotation(matrix)) return false;
    has_replaced_rotation_ = true;
    return true;
  }

  const MovingGeometry<S>& moving_;
  bool is_shape_;
  deformable::MeshKind kind_;
  bool is_octree_;
  deformable::Pose beginning_, end_;
  bool goes_straight_{false};
  bool are_rotations_{true};
  bool has_replaced_rotation_{false};
};

enum class Answerer {
  kStraightPaths,  ///< all vertices of both meshes move on straight lines
  kCurvedPaths,    ///< two meshes, and at least one turns or follows a spline
  kShapes,         ///< one is a shape or an octree, the other one of these or a mesh
  kFcl  ///< FCL: one is a point cloud, or follows a motion that is not known, for example
};

/// FCL looks a pair up in a table by the node types, which it does not check.
template <typename S>
void requireNodeType(const CollisionGeometry<S>& o, const char* name) {
  // A model that deforms has no node type while FCL's tree is out of date.
  if (o.getObjectType() == OT_BVH) return;
  const auto type = static_cast<int>(o.getNodeType());
  if (type < 0 || type >= NODE_COUNT)
    throw Exception(std::string(name) + " is a geometry of node type " +
                    std::to_string(type) +
                    ", which FCL has not. Return a value of NODE_TYPE, or give a convex "
                    "or a mesh");
}

template <typename S>
Answerer answererFcl(const PlacedGeometry<S>& o1, const PlacedGeometry<S>& o2) {
  requireNodeType(o1.geometry(), "o1");
  requireNodeType(o2.geometry(), "o2");
  return Answerer::kFcl;
}

/// Which method answers a pair.
/// @throws fcl::Exception  when a node type is not one of FCL's; when one of two meshes
/// does not go straight and a pose is not finite. (A rotation that is not finite is not
/// constant. PreparedMesh checks the poses of straight paths. FCL gets other geometries
/// as they are.)
template <typename S>
Answerer answererOf(const PlacedGeometry<S>& o1, const PlacedGeometry<S>& o2) {
  if (o1.isShape() || o2.isShape() || o1.isOctree() || o2.isOctree()) {
    if (!o1.isKnown() || !o2.isKnown()) return answererFcl(o1, o2);
    o1.requireFinitePoses("o1");
    o2.requireFinitePoses("o2");
    return Answerer::kShapes;
  }
  if (o1.goesStraight() && o2.goesStraight()) return Answerer::kStraightPaths;
  if (o1.isMesh() && o2.isMesh()) {
    o1.requireFinitePoses("o1");
    o2.requireFinitePoses("o2");
  }
  if (!o1.isKnown() || !o2.isKnown()) return answererFcl(o1, o2);
  return Answerer::kCurvedPaths;
}

/// Why FCL answers a pair: the first object that this library cannot follow.
template <typename S>
std::string whyFclAnswers(const PlacedGeometry<S>& o1, const PlacedGeometry<S>& o2) {
  const bool is_first = !o1.isKnown();
  const PlacedGeometry<S>& o = is_first ? o1 : o2;
  const std::string name = is_first ? "o1" : "o2", kind = kindOf(o.geometry());
  if (o.isMesh() || o.isRigid())
    return name + ", " + kind +
           ", follows a motion class that is neither FCL's nor a BoundedMotion";
  return name + " is " + kind + ", not a triangle mesh, a shape or an octree";
}

/// Runs a query. A vertex that is not finite becomes FCL's exception.
template <typename Query>
auto answerOf(Query&& query) {
  try {
    return query();
  } catch (const deformable::NonFiniteVertex& error) {
    throw Exception(error.what());
  }
}

}  // namespace detail
}  // namespace fcl

#endif
