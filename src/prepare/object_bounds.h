// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_PREPARE_OBJECT_BOUNDS_H
#define FCL_CCD_PREPARE_OBJECT_BOUNDS_H

#include <optional>

#include "broadphase/broad_phase.h"
#include "fcl/narrowphase/detail/query_numbers.h"
#include "paths/motion_path.h"
#include "prepare/query_arguments.h"
#include "shapes/body_boxes.h"

namespace fcl {
namespace detail {

/// @brief What the moving bounds of an object are made from: boxes in its frame, at t = 0
/// and t = 1, and its path.
struct BoundedBody {
  deformable::BodyBox box[2];
  deformable::MotionPath path;
};

/// @brief The largest number of spans of moving bounds, a power of two.
constexpr int kMostSpans = 16;

/// @brief The poses of a path at the ends of spans, each computed once.
class PathPoses {
 public:
  /// @param path  lives as long as this
  explicit PathPoses(const deformable::MotionPath& path)
      : path_(path), acceleration_(path.acceleration(0, 1)) {}

  const deformable::MotionPath& path() const { return path_; }
  /// @brief During the step.
  const deformable::AccelerationBound& acceleration() const { return acceleration_; }
  /// @brief The pose at i / n. @param n  a power of two up to kMostSpans
  const deformable::Pose& at(int i, int n);

 private:
  const deformable::MotionPath& path_;
  const deformable::AccelerationBound acceleration_;
  std::optional<deformable::Pose> poses_[kMostSpans + 1];
};

/// @brief Whether an object has boxes. Not: planes, halfspaces, compounds with one of
/// these, and what appendBounds() has no bounds for.
template <typename S>
bool isBounded(const PlacedGeometry<S>& placed);

/// @param name  of the object in errors; lives as long as the path
/// @pre isBounded(); the floating-point mode is the default one
/// @throws fcl::Exception  as appendBounds()
template <typename S>
BoundedBody boundedBodyOf(const PlacedGeometry<S>& placed, const char* name);

/// @brief As appendBounds(), of a body with these boxes in its frame at t = 0 and t = 1.
/// @param most_spans  a power of two up to kMostSpans; fewer spans cost less, and the
/// bounds are wider
void appendBox(const deformable::BodyBox (&body)[2], PathPoses& poses, int most_spans,
               deformable::BoundsList& list);

/// @brief As appendBounds().
void appendBody(const BoundedBody& body, deformable::BoundsList& list);

/// @brief Adds the moving bounds of an object. They contain it at each time of the step,
/// and what rounding or the tolerance of a query adds to it.
///
/// A path is followed by boxes at the ends of spans. Between them points deviate from
/// straight lines by at most M dt^2 / 8, where M bounds their acceleration. The number of
/// spans, up to 16, is such that this is small compared with the object.
///
/// The box of an octree contains its occupied cells. It is made of the octree's upper
/// nodes, of which at most 256 are opened. So it may be wider than the cells, by up to
/// about a tenth of the size of the map.
///
/// No bounds: a motion that is not known (PathKind::kUnknown), point clouds, geometries
/// of the program. A plane or halfspace whose normal is along an axis at all times has a
/// box; another one is bounded by itself (MovingFlat).
///
/// @pre the floating-point mode is the default one
/// @throws fcl::Exception  a mesh as in PreparedMotion; a pose or a shape is not finite
template <typename S>
void appendBounds(const MovingGeometry<S>& moving, deformable::BoundsList& list);

}  // namespace detail
}  // namespace fcl

#endif
