// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_API_PREPARED_MOTION_H
#define FCL_CCD_API_PREPARED_MOTION_H

#include <optional>
#include <string>

#include "api/prepared_mesh.h"
#include "api/query_arguments.h"
#include "motion/motion_body.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief The path of a geometry that this library answers.
/// @pre placed.isKnown()
/// @throws fcl::Exception  when the rotation of a spline is too large
template <typename S>
MotionPath motionPathOf(const PlacedGeometry<S>& placed);

/// @brief A mesh made ready for a query in which one of the meshes turns. It owns what
/// was computed for the query, as PreparedMesh does. Vertices are in the frame that the
/// motion moves. Exception: if a mesh deforms, its rotation changes and its vertices go
/// straight, the vertices are posed.
class PreparedMotion {
 public:
  /// @param name  how errors call the geometry, for example "o1"
  /// @param toc_err  largest error of time that rounding of the path may cause
  /// @pre placed.isKnown(); the poses are finite; the floating-point mode is the default
  /// @throws fcl::Exception  as PreparedMesh; also when the path is not defined or leaves
  /// the range of numbers
  template <typename S>
  PreparedMotion(const PlacedGeometry<S>& placed, const std::string& name, double toc_err,
                 int num_threads);

  PreparedMotion(const PreparedMotion&) = delete;
  PreparedMotion& operator=(const PreparedMotion&) = delete;

  const MotionBody& body() const { return *body_; }
  double updateTime() const { return mesh_->updateTime(); }

  /// @brief The position of a vertex at time t, and its position one unit of time later
  /// if it kept its velocity.
  VertexPath tangentAt(std::uint32_t vertex, double t) const;

  /// @brief The mesh in its pose at t = 0.
  MeshInstance beginning() const;

 private:
  template <typename S>
  void requireDefined(const PlacedGeometry<S>& placed, const std::string& name,
                      double toc_err) const;
  void requireInRange(const VertexFrames& frames, const std::string& name) const;

  std::optional<PreparedMesh> mesh_;
  std::optional<MotionBody> body_;
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
