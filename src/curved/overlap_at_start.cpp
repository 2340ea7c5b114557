// SPDX-License-Identifier: BSD-3-Clause
#include "curved/overlap_at_start.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "numerics/error_bounds.h"
#include "paths/posed_vector.h"
#include "shapes/convex_distance.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

double overlapOfFlat(const ConvexShape& flat, const Pose& pose_flat,
                     const ConvexShape& other, const Pose& pose_other) {
  const FlatShape& shape = *flat.flat();
  const Vec normal = rotated(pose_flat.rotation, shape.normal),
            up = (1 / norm(normal)) * normal,
            way = (vecOf(pose_other.translation) - vecOf(pose_flat.translation)) -
                  rotated(pose_flat.rotation, shape.foot()),
            in_other = rotatedBack(pose_other.rotation, up);
  const double height = dot(up, way);
  const double below = other.outerReach(-1. * in_other) - height;
  if (shape.is_solid) return below;
  return std::min(below, height + other.outerReach(in_other));
}

/// A radius of balls that the rotation, if it is one up to rounding, does not make
/// smaller than this.
double innerRadius(const ConvexShape& shape, const Pose& pose) {
  constexpr double kRounding = 0x1p-30;
  const double least = shape.innerRadius(0);
  if (shape.innerRadius(1) == least) return least;
  const double(&r)[9] = pose.rotation;
  for (int i = 0; i < 3; ++i)
    for (int k = i; k < 3; ++k) {
      const double product = r[i] * r[k] + r[3 + i] * r[3 + k] + r[6 + i] * r[6 + k];
      if (!(std::abs(product - (i == k ? 1 : 0)) < kRounding)) return least;
    }
  return shape.innerRadius(1 - 4 * kRounding);
}

/// The heights of the points of a mesh above a flat, at t = 0.
class HeightsAtStart {
 public:
  HeightsAtStart(const MovingBody& flat, const MovingBody& mesh)
      : mesh_(mesh), is_solid_(flat.shape()->flat()->is_solid) {
    const FlatShape& shape = *flat.shape()->flat();
    const Pose pose_flat = flat.path().pose(0), pose_mesh = mesh.path().pose(0);
    const Vec normal = rotated(pose_flat.rotation, shape.normal),
              up = (1 / norm(normal)) * normal;
    up_ = rotatedBack(pose_mesh.rotation, up);
    origin_ = dot(up, (vecOf(pose_mesh.translation) - vecOf(pose_flat.translation)) -
                          rotated(pose_flat.rotation, shape.foot()));
  }

  /// Goes down the tree to the triangle that is likely to be lowest; or, for a plane, to
  /// one that it is likely to cross. All triangles of a box below a halfspace are as
  /// good.
  /// @return how deep this triangle is; negative: it does not touch
  double findTouch() const {
    BodyPart part = mesh_.root(), children[BodyBoxes::kWidth];
    bool is_below = false;
    while (!part.isTriangle()) {
      const int count = mesh_.children(part, children);
      assert(0 < count && count <= BodyBoxes::kWidth);
      part = children[0];
      if (is_below) continue;
      double least = HUGE_VAL;
      for (int i = 0; i < count && !is_below; ++i) {
        const Heights heights = heightsOf(mesh_.box(children[i], 0));
        if (!(heights.least() < least)) continue;
        least = heights.least();
        is_below = is_solid_ && heights.most() <= 0;
        part = children[i];
      }
      if (!(least <= 0)) return -1;
    }
    return depthOf(part);
  }

 private:
  /// The heights of the points of a box, or, from a plane, their distances.
  struct Heights {
    double center, half_width;
    double least() const { return center - half_width; }
    double most() const { return center + half_width; }
  };

  Heights heightsOf(const BodyBox& box) const {
    const double center = origin_ + dot(up_, vecOf(box.center));
    double half_width = box.pad;
    for (int i = 0; i < 3; ++i)
      half_width += box.extent[i] * std::abs(dot(up_, vecOf(box.axis[i])));
    return {is_solid_ ? center : std::abs(center), half_width};
  }

  double depthOf(const BodyPart& part) const {
    if (!mesh_.isReadable(~part.child)) return -1;
    const BodyTriangle triangle = mesh_.triangle(~part.child);
    double lowest = HUGE_VAL, highest = -HUGE_VAL;
    for (const Vec& corner : triangle.corner[0]) {
      const double height = origin_ + dot(up_, corner);
      lowest = std::min(lowest, height);
      highest = std::max(highest, height);
    }
    return is_solid_ ? -lowest : std::min(-lowest, highest);
  }

  const MovingBody& mesh_;
  bool is_solid_;
  /// The upward unit normal in the frame of the mesh, and the height of its origin.
  Vec up_;
  double origin_;
};

}  // namespace

bool overlapDeeplyAtStart(const ConvexShape& a, const Pose& pose_a, const ConvexShape& b,
                          const Pose& pose_b) {
  assert(!a.flat() || !b.flat());
  if (a.flat())
    return isDeepOverlap(overlapOfFlat(a, pose_a, b, pose_b), b.outerRadius());
  if (b.flat())
    return isDeepOverlap(overlapOfFlat(b, pose_b, a, pose_a), a.outerRadius());
  const double smaller = std::min(a.outerRadius(), b.outerRadius());
  // Coordinates round less in a frame with its origin in a.
  PosedConvex first{&a, nullptr, pose_a, {}}, second{&b, nullptr, pose_b, {}};
  for (int k = 0; k < 3; ++k) {
    first.pose.translation[k] = 0;
    second.pose.translation[k] -= pose_a.translation[k];
  }
  const Vec way = posed(second.pose, b.center()) - rotated(pose_a.rotation, a.center());
  const double distance = norm(way);
  if (distance > kUpward * (a.outerRadius() + b.outerRadius())) return false;
  if (a.containsCenter() && b.containsCenter() &&
      isDeepOverlap(innerRadius(a, pose_a) + innerRadius(b, pose_b) - distance, smaller))
    return true;
  const double radii = coreDistance(&a, &b, 0);
  // It is deep long before the distance of the cores is this small.
  const ConvexGap gap = convexGap(first, second, way, radii, radii - 0x1p-15 * smaller);
  return isDeepOverlap(radii + overlapOf(gap), smaller);
}

bool overlapDeeplyAtStart(const MovingBody& a, const MovingBody& b) {
  const auto isFlat = [](const MovingBody& body) {
    return body.shape() && body.shape()->flat();
  };
  if (isFlat(a) && b.isMesh())
    return isDeepOverlap(HeightsAtStart(a, b).findTouch(), b.radius());
  return isFlat(b) && a.isMesh() &&
         isDeepOverlap(HeightsAtStart(b, a).findTouch(), a.radius());
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
