// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_PREPARE_PREPARED_MOTION_H
#define FCL_CCD_PREPARE_PREPARED_MOTION_H

#include <optional>
#include <string>

#include "bodies/moving_body.h"
#include "prepare/convex_shapes.h"
#include "prepare/prepared_mesh.h"
#include "prepare/query_arguments.h"
#include "shapes/octree_cells.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief Refuses transforms that scale, mirror or shear: see
/// PlacedGeometry::areRotations().
/// @param name  the name of the geometry in errors
template <typename S>
void requireRotations(const PlacedGeometry<S>& placed, const char* name);

/// @brief Refuses a path between two transforms that request.ccd_motion_type does not
/// define, and one about a reference point that is not finite.
/// @param name  the name of the geometry in errors
template <typename S>
void requireDefinedPath(const PlacedGeometry<S>& placed, const std::string& name);

/// @brief The path of a geometry that this library answers.
/// @param name  the name of the geometry in errors; must live as long as the path
/// @pre placed.isKnown()
/// @throws fcl::Exception  as requireRotations(); also when the rotation of a spline is
/// too large
template <typename S>
MotionPath motionPathOf(const PlacedGeometry<S>& placed, const char* name);

/// @brief A mesh, a shape or an octree made ready for a query in which one of the objects
/// turns or is no mesh. It owns what was computed for the query, as PreparedMesh does.
/// Vertices are in the frame that the motion moves. Exception: if a mesh deforms, its
/// rotation changes and its vertices go straight, the vertices are posed.
class PreparedMotion {
 public:
  /// @param name  how errors call the geometry, for example "o1"
  /// @param toc_err  largest error of time that rounding of the path may cause
  /// @param other_radius  of a plane or halfspace: how far the other object may come from
  /// the origin of the world
  /// @param scale  of a shape: a power of two by which its lengths are multiplied; the
  /// pose and the other radius are multiplied already
  /// @param shape  of a shape: what convexShapeOf() has made of it, with any other
  /// radius, if it was called before; it is taken. Null: it was not
  /// @pre placed.isKnown(); the poses are finite; the floating-point mode is the default
  /// @throws fcl::Exception  as PreparedMesh, convexShapeOf() and octreeCellsOf(); also
  /// when the path is not defined or leaves the range of numbers
  template <typename S>
  PreparedMotion(const PlacedGeometry<S>& placed, const std::string& name, double toc_err,
                 int num_threads, double other_radius = 0, double scale = 1,
                 ConvexShape* shape = nullptr);

  PreparedMotion(const PreparedMotion&) = delete;
  PreparedMotion& operator=(const PreparedMotion&) = delete;

  /// @brief Whether it is an octree without occupied cells. It has no body.
  bool isEmpty() const { return octree_ && octree_->isEmpty(); }
  const MovingBody& body() const { return *body_; }
  /// @brief Bound on all lengths in a query: coordinates, radii, ways and accelerations.
  double size() const;
  double updateTime() const { return mesh_ ? mesh_->updateTime() : 0; }

  /// @brief The position of a vertex at time t, and its position one unit of time later
  /// if it kept its velocity.
  /// @pre it is a mesh
  VertexPath tangentAt(std::uint32_t vertex, double t) const;

  /// @brief The mesh in its pose at t = 0.
  /// @pre it is a mesh
  MeshInstance beginning() const;

 private:
  template <typename S>
  void requireDefined(const PlacedGeometry<S>& placed, const std::string& name,
                      double toc_err) const;
  void requireInRange(const std::string& name) const;
  void requireFinite(const VertexFrames& frames, const std::string& name) const;

  const std::string name_;
  /// One of them is there.
  std::optional<PreparedMesh> mesh_;
  std::optional<ConvexShape> shape_;
  std::optional<OctreeCells> octree_;
  std::optional<MovingBody> body_;
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
