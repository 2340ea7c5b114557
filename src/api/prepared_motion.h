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

/// @brief The path of a geometry that is answered here.
/// @pre placed.isKnown()
/// @throws fcl::Exception  a spline whose rotation is too large
template <typename S>
MotionPath motionPathOf(const PlacedGeometry<S>& placed);

/// @brief A mesh made ready for a query of meshes of which one turns, with what had to be
/// computed for it: as PreparedMesh, in the frame that the motion moves. Only a mesh that
/// deforms and whose vertices go straight between poses that turn has them posed.
class PreparedMotion {
 public:
  /// @param name  how errors call the geometry, for example "o1"
  /// @param toc_err  how much of the step rounding may be
  /// @pre placed.isKnown(); the poses are finite; the floating-point mode is the default
  /// @throws fcl::Exception as PreparedMesh; a path that is not defined, or leaves the
  /// range of numbers
  template <typename S>
  PreparedMotion(const PlacedGeometry<S>& placed, const std::string& name, double toc_err,
                 int num_threads);

  PreparedMotion(const PreparedMotion&) = delete;
  PreparedMotion& operator=(const PreparedMotion&) = delete;

  const MotionBody& body() const { return *body_; }
  double updateTime() const { return mesh_->updateTime(); }

  /// @brief Where a vertex is at a time, and a unit of time later if it went on as then.
  VertexPath tangentAt(std::uint32_t vertex, double t) const;

  /// @brief The mesh as it is at t = 0.
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
