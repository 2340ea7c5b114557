// SPDX-License-Identifier: BSD-3-Clause
#include "motion/overlap_at_start.h"

#include <cmath>

#include "motion/convex_distance.h"
#include "motion/posed_vector.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

constexpr double kUpward = 1 + 0x1p-40;

bool reachesFlat(const ConvexShape& flat, const Pose& pose_flat, const ConvexShape& other,
                 const Pose& pose_other) {
  const FlatShape& shape = *flat.flat();
  const Vec normal = rotated(pose_flat.rotation, shape.normal),
            up = (1 / norm(normal)) * normal,
            way = (vecOf(pose_other.translation) - vecOf(pose_flat.translation)) -
                  rotated(pose_flat.rotation, shape.foot()),
            in_other = rotatedBack(pose_other.rotation, up);
  const double height = dot(up, way);
  if (!(height - other.reach(-1. * in_other) - other.radius() <= 0)) return false;
  return shape.is_solid || height + other.reach(in_other) + other.radius() >= 0;
}

/// A radius of balls that the rotation, if it is one up to rounding, does not make
/// smaller than this.
double innerRadius(const ConvexShape& shape, const Pose& pose) {
  constexpr double kRounding = 0x1p-30;
  const double inner = shape.innerRadius();
  if (inner == 0) return shape.radius();
  const double(&r)[9] = pose.rotation;
  for (int i = 0; i < 3; ++i)
    for (int k = i; k < 3; ++k) {
      const double product = r[i] * r[k] + r[3 + i] * r[3 + k] + r[6 + i] * r[6 + k];
      if (!(std::abs(product - (i == k ? 1 : 0)) < kRounding)) return shape.radius();
    }
  return shape.radius() + inner * (1 - 4 * kRounding);
}

double outerRadius(const ConvexShape& shape) {
  return shape.box().radius + shape.radius();
}

}  // namespace

bool overlapAtStart(const ConvexShape& a, const Pose& pose_a, const ConvexShape& b,
                    const Pose& pose_b) {
  if (a.flat()) return reachesFlat(a, pose_a, b, pose_b);
  if (b.flat()) return reachesFlat(b, pose_b, a, pose_a);
  // Coordinates round less in a frame with its origin in a.
  PosedConvex first{&a, nullptr, pose_a, {}}, second{&b, nullptr, pose_b, {}};
  for (int k = 0; k < 3; ++k) {
    first.pose.translation[k] = 0;
    second.pose.translation[k] -= pose_a.translation[k];
  }
  const Vec way = posed(second.pose, b.center()) - rotated(pose_a.rotation, a.center());
  const double distance = norm(way);
  if (distance > kUpward * (outerRadius(a) + outerRadius(b))) return false;
  if (a.containsCenter() && b.containsCenter() &&
      distance <= innerRadius(a, pose_a) + innerRadius(b, pose_b))
    return true;
  const double radii = a.radius() + b.radius();
  const ConvexGap gap = convexGap(first, second, way, radii, radii);
  return gap.depth > 0 || gap.distance <= radii;
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
