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
#include "paths/path_matrix.h"
#include "prepare/compound_parts.h"
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
  if (compoundPartsOf(o)) return "a compound";
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

inline void requireTimeLimit(double t_max, const char* name) {
  if (!(t_max >= 0 && t_max <= 1))
    throw Exception(std::string(name) + " is " + std::to_string(t_max) +
                    "; it must be in [0, 1]");
}

inline void requireDistance(double distance, const char* name) {
  if (!(distance >= 0) || !std::isfinite(distance))
    throw Exception(std::string(name) +
                    " is negative or not finite. Give 0 or more, in the unit of the "
                    "coordinates");
}

/// @tparam Numbers  PoseNumbers or PartOffset
template <typename Numbers>
deformable::Pose toPose(const Numbers& numbers) {
  deformable::Pose pose;
  for (int k = 0; k < 9; ++k) pose.rotation[k] = numbers.rotation[k];
  for (int k = 0; k < 3; ++k) pose.translation[k] = numbers.translation[k];
  return pose;
}

/// A geometry at rest in its own frame.
template <typename S>
MovingGeometry<S> unmoved(const CollisionGeometry<S>* geometry) {
  const PoseNumbers<S> still{{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};
  return {geometry, {still, still}, PathKind::kStraight, {}, {}, nullptr, {}, {}};
}

/// The pose of a part whose body is in a pose. For rotations it rounds by 9 u, and a
/// coordinate by 3 u of the offset and u of itself.
inline deformable::Pose partPose(const deformable::Pose& body, const PartOffset& offset) {
  deformable::Pose out;
  deformable::multiply(body.rotation, offset.rotation, out.rotation);
  deformable::set(out.translation, posed(body, deformable::vecOf(offset.translation)));
  return out;
}

/// A geometry and the poses in which a query prepares it. It must be made in the default
/// floating-point mode. Other modes may flush subnormal floats to zero in the conversion.
template <typename S>
class PlacedGeometry {
 public:
  explicit PlacedGeometry(const MovingGeometry<S>& moving)
      : moving_(moving),
        is_shape_(deformable::isConvexShape(*moving.geometry)),
        mesh_(is_shape_ ? deformable::MeshClass{deformable::MeshKind::kNotAMesh, nullptr}
                        : deformable::meshClassOf(*moving.geometry)),
        is_octree_(!is_shape_ && deformable::isOctree(*moving.geometry)),
        compound_(is_shape_ || isMesh() || is_octree_
                      ? nullptr
                      : compoundPartsOf(*moving.geometry)) {
    using deformable::MeshKind;
    beginning_ = toPose(moving.pose[0]);
    end_ = toPose(moving.pose[1]);
    const bool is_constant = isConstantRotation(moving.pose[0], moving.pose[1]);
    // A rotation that differs by a few roundings only is constant.
    if (isRigid() && is_constant)
      std::copy(beginning_.rotation, beginning_.rotation + 9, end_.rotation);
    const bool bends = moving.path == PathKind::kSpline ||
                       moving.path == PathKind::kBounded || (isTurn() && !is_constant);
    if (mesh_.kind == MeshKind::kDeforming) goes_straight_ = !bends;
    if (isRigid())
      goes_straight_ = !bends && is_constant && moving.path != PathKind::kUnknown;
    if (isMesh() && goes_straight_ && !moving.offset.is_set) return;
    // A turn is defined between rotations only, and a sphere that is sheared is no
    // sphere. All parts of a body go with the same rotation.
    const bool has_poses =
        moving.path != PathKind::kBounded && moving.path != PathKind::kSpline;
    for (deformable::Pose* pose : {&beginning_, &end_})
      are_rotations_ &= takeRotation(pose->rotation, has_poses);
    applyOffset();
  }

  const CollisionGeometry<S>& geometry() const { return *moving_.geometry; }
  const MovingGeometry<S>& moving() const { return moving_; }
  const deformable::Pose& beginning() const { return beginning_; }
  const deformable::Pose& end() const { return end_; }
  /// The poses of the body that carries a part. Of other geometries: as above.
  const deformable::Pose& bodyBeginning() const {
    return moving_.offset.is_set ? body_[0] : beginning_;
  }
  const deformable::Pose& bodyEnd() const {
    return moving_.offset.is_set ? body_[1] : end_;
  }

  /// A DeformableBVHModel whose moving tree is up to date; null otherwise.
  const DeformableMesh* model() const { return mesh_.model; }

  bool isMesh() const { return mesh_.kind != deformable::MeshKind::kNotAMesh; }
  bool isShape() const { return is_shape_; }
  bool isOctree() const { return is_octree_; }
  /// Null: it is none.
  const CompoundParts<S>* compound() const { return compound_; }
  bool isRigid() const {
    return mesh_.kind == deformable::MeshKind::kRigid || is_shape_ || is_octree_ ||
           compound_;
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
    return (isMesh() || isShape() || isOctree() || compound_) &&
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

  void applyOffset() {
    if (!moving_.offset.is_set) return;
    body_[0] = beginning_;
    body_[1] = end_;
    beginning_ = partPose(body_[0], moving_.offset);
    end_ = partPose(body_[1], moving_.offset);
  }

  const MovingGeometry<S>& moving_;
  bool is_shape_;
  deformable::MeshClass mesh_;
  bool is_octree_;
  const CompoundParts<S>* compound_;
  deformable::Pose beginning_, end_;
  /// Of a part.
  deformable::Pose body_[2];
  bool goes_straight_{false};
  bool are_rotations_{true};
  bool has_replaced_rotation_{false};
};

enum class Answerer {
  kStraightPaths,  ///< all vertices of both meshes move on straight lines
  kCurvedPaths,    ///< two meshes, and at least one turns or follows a spline
  kShapes,  ///< one is a shape, an octree or a compound, the other one of these or a mesh
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

template <typename S>
Answerer answererFcl(const PlacedGeometry<S>& o1, const PlacedGeometry<S>& o2) {
  if (o1.compound() || o2.compound())
    throw Exception(
        whyFclAnswers(o1, o2) +
        ", and FCL has no compounds. Give a mesh, a shape, an octree or a compound that "
        "follows one of FCL's motions, or derive the motion class from BoundedMotion "
        "too");
  requireNodeType(o1.geometry(), "o1");
  requireNodeType(o2.geometry(), "o2");
  return Answerer::kFcl;
}

/// Which method answers a pair.
/// @throws fcl::Exception  when a node type is not one of FCL's, or one is a compound and
/// this library does not answer; when one of two meshes
/// does not go straight and a pose is not finite. (A rotation that is not finite is not
/// constant. PreparedMesh checks the poses of straight paths. FCL gets other geometries
/// as they are.)
template <typename S>
Answerer answererOf(const PlacedGeometry<S>& o1, const PlacedGeometry<S>& o2) {
  const auto is_no_mesh = [](const PlacedGeometry<S>& o) {
    return o.isShape() || o.isOctree() || o.compound();
  };
  if (is_no_mesh(o1) || is_no_mesh(o2)) {
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

/// Runs a query. A vertex that is not finite becomes FCL's exception.
template <typename Query>
auto answerOf(Query&& query) {
  try {
    return query();
  } catch (const deformable::NonFiniteVertex& error) {
    throw Exception(error.what());
  }
}

/// Calls visit for the DeformableBVHModel of an object, or for those of a compound.
template <typename S, typename Visit>
void visitModels(const PlacedGeometry<S>& placed, const Visit& visit) {
  if (placed.model()) visit(*placed.model());
  if (!placed.compound()) return;
  for (const auto& part : placed.compound()->parts)
    if (part.model) visit(*part.model);
}

}  // namespace detail
}  // namespace fcl

#endif
