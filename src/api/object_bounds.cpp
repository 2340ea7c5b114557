// SPDX-License-Identifier: BSD-3-Clause
#include "api/object_bounds.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "api/convex_shapes.h"
#include "api/prepared_motion.h"
#include "api/query_arguments.h"
#include "fcl/geometry/shape/halfspace.h"
#include "fcl/geometry/shape/plane.h"
#include "motion/posed_vector.h"
#include "numerics/error_bounds.h"

namespace fcl {
namespace detail {
namespace {

using namespace deformable;

constexpr double kUnbounded = std::numeric_limits<double>::infinity();
/// A pair query adds up to 2^-44 of the coordinates of both objects, for rounding and for
/// its tolerance (motion_query.cpp, numerics.md). The boxes of both have room for it.
constexpr double kRoom = 0x1p-40;
/// The deviation from straight lines is at most this share of the radius of an object, if
/// this needs no more than kMostSpans.
constexpr double kDeviation = 0x1p-4;
constexpr int kMostSpans = 16;
/// FCL's default. A larger rounding error of an InterpMotion's reference point is
/// refused.
constexpr double kDefaultTocErr = 1e-4;

/// What the bounds of a body are made from: boxes in its frame, at t = 0 and t = 1, and
/// its path.
struct BoundedBody {
  MotionBox box[2];
  MotionPath path;
};

double accelerationOf(const AccelerationBound& bound, const MotionBox (&box)[2]) {
  if (bound.isZero() && bound.per_displacement == 0) return 0;
  const auto center = [](const MotionBox& at) -> Vec {
    return {at.center[0], at.center[1], at.center[2]};
  };
  return bound.between(center(box[0]), center(box[1]),
                       std::max(box[0].radius, box[1].radius)) +
         bound.per_displacement * box[0].displacement;
}

/// The box of the body at t in the world, without the deviation in a span.
HalfAxisBox boxAt(const BoundedBody& body, double t, double pad) {
  const Pose pose = body.path.pose(t);
  const MotionBox &from = body.box[0], &to = body.box[1];
  double center[3], extent[3];
  for (int k = 0; k < 3; ++k) {
    center[k] = (1 - t) * from.center[k] + t * to.center[k];
    extent[k] = (1 - t) * from.extent[k] + t * to.extent[k];
  }
  HalfAxisBox out;
  for (int k = 0; k < 3; ++k) {
    const double* row = pose.rotation + 3 * k;
    const double middle = row[0] * center[0] + row[1] * center[1] + row[2] * center[2] +
                          pose.translation[k];
    double half = pad;
    // The axes are the same at both ends.
    for (int j = 0; j < 3; ++j)
      half += std::abs(row[0] * from.axis[j][0] + row[1] * from.axis[j][1] +
                       row[2] * from.axis[j][2]) *
              extent[j];
    out.half[k] = half - middle;
    out.half[k + 3] = half + middle;
  }
  return out;
}

int numSpans(const BoundedBody& body) {
  const double deviation = 0.125 * accelerationOf(body.path.acceleration(0, 1), body.box);
  const double wanted = kDeviation * std::max(body.box[0].radius, body.box[1].radius);
  int n = 1;
  while (n < kMostSpans && deviation > wanted * n * n) n *= 2;
  return n;
}

[[noreturn]] void refuse() {
  throw Exception(
      "object: its geometry or its path is not finite, or too large for doubles. Give "
      "finite numbers");
}

bool isFinite(const HalfAxisBox& box) {
  return std::all_of(box.half, box.half + HalfAxisBox::kSides,
                     [](double x) { return std::isfinite(x); });
}

void appendBody(const BoundedBody& body, BoundsList& list) {
  for (const MotionBox& box : body.box)
    if (!std::isfinite(norm(box.center) + box.radius)) refuse();
  const int n = numSpans(body);
  const double stretch = body.path.stretch();
  double size = body.path.translationReach(), pad = 0;
  for (const MotionBox& box : body.box) {
    size = std::max(
        size, body.path.translationReach() + stretch * (norm(box.center) + box.radius));
    pad = std::max(
        pad, stretch * box.pad + body.path.positionError(norm(box.center) + box.radius));
  }
  const std::size_t first = list.boxes.size();
  for (int i = 0; i <= n; ++i)
    list.boxes.push_back(boxAt(body, double(i) / n, pad + kRoom * size));
  double before = 0;
  for (int i = 0; i <= n; ++i) {
    const double dt = 1. / n;
    double after = 0;
    if (i < n)
      after = 0.125 * dt * dt * kUpward *
              accelerationOf(body.path.acceleration(i * dt, (i + 1) * dt), body.box);
    for (double& half : list.boxes[first + static_cast<std::size_t>(i)].half)
      half += std::max(before, after);
    before = after;
  }
  const auto end = list.boxes.end();
  if (!std::all_of(end - (n + 1), end, isFinite)) refuse();
  list.items.push_back({first, n});
}

void appendUnbounded(BoundsList& list) {
  HalfAxisBox box;
  std::fill(box.half, box.half + HalfAxisBox::kSides, kUnbounded);
  list.items.push_back({list.boxes.size(), 1});
  list.boxes.insert(list.boxes.end(), 2, box);
}

/// A plane, or the halfspace n x <= d: bounded along an axis that is parallel to the
/// normal at all times.
template <typename Shape>
void appendFlat(const Shape& shape, bool is_plane, const MotionPath& path,
                BoundsList& list) {
  const double n[3] = {double{shape.n[0]}, double{shape.n[1]}, double{shape.n[2]}};
  const double d = double{shape.d};
  if (!std::isfinite(norm(n)) || !std::isfinite(d)) refuse();
  appendUnbounded(list);
  if (!path.isTranslation()) return;
  for (int end = 0; end < 2; ++end) {
    const Pose pose = path.pose(end);
    double normal[3];
    for (int k = 0; k < 3; ++k)
      normal[k] = pose.rotation[3 * k] * n[0] + pose.rotation[3 * k + 1] * n[1] +
                  pose.rotation[3 * k + 2] * n[2];
    HalfAxisBox& box = list.boxes[list.items.back().first + std::size_t(end)];
    for (int k = 0; k < 3; ++k) {
      if (normal[k] == 0 || normal[(k + 1) % 3] != 0 || normal[(k + 2) % 3] != 0)
        continue;
      const double at = d / normal[k] + pose.translation[k],
                   room = kRoom * (std::abs(d / normal[k]) + path.translationReach());
      if (is_plane || normal[k] > 0) box.half[k + 3] = at + room;
      if (is_plane || normal[k] < 0) box.half[k] = room - at;
    }
  }
}

template <typename S>
void appendShape(const PlacedGeometry<S>& placed, BoundsList& list) {
  requireFinite(placed.beginning(), placed.end(), "object");
  const CollisionGeometry<S>& o = placed.geometry();
  const MotionPath path = motionPathOf(placed, "object");
  if (o.getNodeType() == GEOM_PLANE)
    return appendFlat(static_cast<const Plane<S>&>(o), true, path, list);
  if (o.getNodeType() == GEOM_HALFSPACE)
    return appendFlat(static_cast<const Halfspace<S>&>(o), false, path, list);
  const ConvexShape shape = convexShapeOf(o, "object", 0);
  MotionBox box = shape.box();
  box.pad += shape.radius();
  box.radius = (box.radius + shape.radius()) * kUpward;
  appendBody({{box, box}, path}, list);
}

}  // namespace

template <typename S>
void appendBounds(const MovingGeometry<S>& moving, BoundsList& list) {
  const PlacedGeometry<S> placed(moving);
  if (moving.path == PathKind::kUnknown) return appendUnbounded(list);
  if (placed.isShape()) return appendShape(placed, list);
  if (!placed.isMesh() && !placed.isOctree()) return appendUnbounded(list);
  requireFinite(placed.beginning(), placed.end(), "object");
  const PreparedMotion motion(placed, "object", kDefaultTocErr, 1);
  if (motion.isEmpty())
    return appendBody({{MotionBox(), MotionBox()}, motionPathOf(placed, "object")}, list);
  const MotionBody& body = motion.body();
  appendBody({{body.box(body.root(), 0), body.box(body.root(), 1)}, body.path()}, list);
}

template void appendBounds(const MovingGeometry<double>&, BoundsList&);
template void appendBounds(const MovingGeometry<float>&, BoundsList&);

}  // namespace detail
}  // namespace fcl
