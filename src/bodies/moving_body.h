// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_BODIES_MOVING_BODY_H
#define FCL_CCD_BODIES_MOVING_BODY_H

#include <cassert>
#include <cstdint>
#include <memory>
#include <vector>

#include "base/slot_cache.h"
#include "mesh/feature_pairs.h"
#include "mesh/vertex_frames.h"
#include "numerics/moving_vector.h"
#include "paths/motion_path.h"
#include "shapes/body_boxes.h"
#include "shapes/convex_shape.h"
#include "shapes/octree_cells.h"
#include "tree/mesh_instance.h"
#include "tree/moving_kdop_tree.h"
#include "tree/rigid_tree.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief A node or a triangle of a body's tree, and the place of its box. The cells of
/// an octree count as triangles.
struct BodyPart {
  /// >= 0: a node; < 0: ~triangle.
  std::int32_t child;
  /// RigidTree: the number of FCL's node. MovingKdopTree: eight times the number of the
  /// parent, plus the lane; kRoot for the whole tree. OctreeCells: the number of the
  /// node.
  std::int32_t box;

  static constexpr std::int32_t kRoot = -1;
  bool isTriangle() const { return child < 0; }
};

/// @brief The children of a node, with their boxes at t = 0 and t = 1. Both are equal for
/// a rigid mesh.
struct BodyNode {
  BodyBoxes box[2];
  BodyPart part[BodyBoxes::kWidth];
  int count;
};

/// @brief A triangle in the frame of its body: its corners at t = 0 and t = 1. It may
/// stand for a free edge or a free point (MeshTriangle).
struct BodyTriangle {
  Vec corner[2][3];
  std::int32_t index;
  std::int32_t vertex[3];
  /// As MeshTriangle::owned. A rigid mesh has no owners: each triangle owns all its
  /// features.
  std::uint32_t owned;

  bool isFree() const { return (owned & kFreeLeaf) != 0; }
  bool isFreePoint() const { return isFree() && vertex[0] == vertex[1]; }
};

/// @brief Bound on the acceleration of the corners during the span of the bound.
double accelerationOf(const AccelerationBound& bound, const BodyTriangle& triangle);

/// @brief A pair of features of triangles of two bodies (feature_pairs.h). kFreePair: VE
/// or VV.
FeaturePair featurePair(int pair, const BodyTriangle& a, const BodyTriangle& b);

/// @brief The pair by ids. An edge is the same, in whichever of its triangles it is
/// found.
FeatureIds idsOf(int pair, const BodyTriangle& a, const BodyTriangle& b);

/// @brief A mesh, a shape or an octree that moves along a path, as a query reads it. It
/// does not own them.
class MovingBody {
 public:
  /// @brief A rigid mesh.
  /// @param tree  in the body frame: made with the identity for a pose
  /// @param frames  in the body frame
  MovingBody(const RigidTree& tree, const VertexFrames& frames, TriangleArray triangles,
             const MotionPath& path);

  /// @brief A mesh that deforms in the frame that moves.
  /// @param tree  refit in the body frame
  /// @param frames  in the body frame
  MovingBody(const MovingKdopTree& tree, const VertexFrames& frames,
             const MotionPath& path);

  /// @brief A convex shape. It has one part, which counts as a triangle.
  MovingBody(const ConvexShape& shape, const MotionPath& path);

  /// @brief An octree. Its cells are solid; each counts as a triangle.
  /// @param cells  a query opens its nodes
  /// @pre it is not empty
  MovingBody(OctreeCells& cells, const MotionPath& path);

  const MotionPath& path() const { return path_; }
  MotionPath& path() { return path_; }
  bool isRigid() const { return !tree_; }
  bool isMesh() const { return !shape_ && !octree_; }
  /// @brief Null: a mesh or an octree.
  const ConvexShape* shape() const { return shape_; }
  /// @brief Null: a mesh or a shape.
  OctreeCells* octree() const { return octree_; }

  BodyPart root() const;
  void open(const BodyPart& part, BodyNode& out) const;
  /// @brief The children of a node as its tree has them, without their boxes: two of a
  /// rigid mesh.
  /// @return how many there are
  /// @pre it is a mesh
  int children(const BodyPart& part, BodyPart (&out)[BodyBoxes::kWidth]) const;
  /// @brief The box of a part at t = 0 or t = 1.
  BodyBox box(const BodyPart& part, int frame) const;

  /// @brief The largest coordinate of the points of a part along a direction of the body
  /// frame, at a time. Of an octree these are points of the box around the part's cells.
  /// @param[in,out] room  in: how many triangles may be looked at; out: less those that
  /// were. The answer counts only if it is not negative.
  /// @pre it is no plane or halfspace
  double reach(const BodyPart& part, double t, const Vec& direction,
               std::int64_t& room) const;
  /// @brief Whether a mesh has free edges or points. A rigid mesh has none.
  bool hasFree() const { return tree_ && tree_->freeLeaves().count() > 0; }
  /// @brief The number of triangles, free edges and free points.
  /// @pre it is a mesh that deforms
  std::int32_t numTriangles() const {
    assert(tree_);
    return static_cast<std::int32_t>(tree_->triangles().size());
  }
  /// @pre it is a mesh
  std::size_t numVertices() const {
    assert(isMesh());
    return frames_.size();
  }
  /// @brief The mesh in the body frame: a deforming one goes straight there.
  /// @pre it is a mesh
  MeshInstance meshInBodyFrame() const;
  /// @brief For each triangle of the mesh its place in the tree; empty: they are the
  /// same.
  /// @pre it is a mesh
  std::vector<std::int32_t> placesOfTriangles() const;
  /// @throws NonFiniteVertex
  /// @throws fcl::Exception  an index out of range
  /// @pre it is a mesh
  BodyTriangle triangle(std::int32_t place) const;
  /// @brief Whether triangle() does not throw.
  bool isReadable(std::int32_t place) const;
  /// @brief The triangles among the children of a node, in their lanes. Those for which
  /// triangle() would throw are NaN.
  void setTriangles(const BodyNode& node, BodyTriangles& out) const;

  /// @brief Bound on the distance of the body from the origin of the body frame, in both
  /// frames.
  double radius() const { return radius_; }
  /// @brief How far the body stands out from its boxes: the radius of a shape, else 0.
  double shapeRadius() const { return shape_ ? shape_->radius() : 0; }
  /// @brief Bound on the motion of a vertex in the body frame.
  double displacement() const { return displacement_; }

  /// @brief Bounds on the rounding of a vertex that is posed, and of its velocity.
  double positionError() const;
  double rateError() const;
  /// @brief Bound on the velocity of a vertex.
  double speed() const;
  /// @brief Size of the terms whose sum is a posed vertex.
  double size() const { return path_.largestTranslation() + path_.stretch() * radius_; }

 private:
  void openOctree(std::int32_t node, BodyNode& out) const;
  bool containTriangles(const BodyNode& node) const;
  bool containsTop(const BodyBox& root, int frame) const;
  double reachOfMesh(const BodyPart& part, double t, const Vec& direction,
                     std::int64_t& room) const;
  BodyBox rigidBox(int node) const;
  BodyBox movingBox(std::int32_t box, int frame) const;
  BodyBox movingRoot(int frame) const;

  const RigidTree* rigid_{nullptr};
  const MovingKdopTree* tree_{nullptr};
  const ConvexShape* shape_{nullptr};
  OctreeCells* octree_{nullptr};
  VertexFrames frames_;
  TriangleArray triangles_;
  MotionPath path_;
  double radius_{0};
  double displacement_{0};
};

/// @brief A body, as one traversal reads it. It keeps the last opened nodes in a small
/// table. For one thread.
class MovingBodyReader {
 public:
  static constexpr int kSlots = 64;

  explicit MovingBodyReader(const MovingBody& body) : body_(body) {}

  /// @brief The slot of a node.
  /// @pre it is no triangle
  static std::size_t slotOf(const BodyPart& part) {
    assert(!part.isTriangle());
    return static_cast<std::uint32_t>(part.child) % kSlots;
  }

  /// @brief The children of a node; valid until the next call.
  const BodyNode& open(const BodyPart& part) {
    return nodes_.get(slotOf(part), part.child,
                      [&](BodyNode& node) { body_.open(part, node); });
  }

  /// @brief The triangles among the children of a node, in their lanes; valid until the
  /// next call. The other lanes have any values.
  /// @pre the body is a mesh
  const BodyTriangles& triangles(const BodyPart& part) {
    if (!triangles_) triangles_ = std::make_unique<TriangleCache>(-1, BodyTriangles{});
    return triangles_->get(slotOf(part), part.child, [&](BodyTriangles& out) {
      body_.setTriangles(open(part), out);
    });
  }
  const MovingBody& body() const { return body_; }

 private:
  using TriangleCache = SlotCache<std::int32_t, BodyTriangles, kSlots>;

  const MovingBody& body_;
  SlotCache<std::int32_t, BodyNode, kSlots> nodes_{-1};
  /// Null until they are asked for: they take 74 KB.
  std::unique_ptr<TriangleCache> triangles_;
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
