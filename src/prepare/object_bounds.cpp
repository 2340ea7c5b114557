// SPDX-License-Identifier: BSD-3-Clause
#include "prepare/object_bounds.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <vector>

#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "fcl/geometry/shape/halfspace.h"
#include "fcl/geometry/shape/plane.h"
#include "numerics/error_bounds.h"
#include "paths/posed_vector.h"
#include "prepare/convex_shapes.h"
#include "prepare/prepared_motion.h"
#include "prepare/query_arguments.h"

namespace fcl {
namespace detail {
namespace {

using namespace deformable;

constexpr double kUnbounded = std::numeric_limits<double>::infinity();
/// A pair query adds up to 2^-44 of the coordinates of both objects, for rounding and for
/// its tolerance (curved_query.cpp, numerics.md). The boxes of both have room for it.
constexpr double kRoom = 0x1p-40;
/// The deviation from straight lines is at most this share of the radius of an object, if
/// this needs no more than kMostSpans.
constexpr double kDeviation = 0x1p-4;
/// FCL's default. A larger rounding error of an InterpMotion's reference point is
/// refused.
constexpr double kDefaultTocErr = 1e-4;

double accelerationOf(const AccelerationBound& bound, const BodyBox (&box)[2]) {
  if (bound.isZero() && bound.per_displacement == 0) return 0;
  const auto center = [](const BodyBox& at) -> Vec {
    return {at.center[0], at.center[1], at.center[2]};
  };
  return bound.between(center(box[0]), center(box[1]),
                       std::max(box[0].radius, box[1].radius)) +
         bound.per_displacement * box[0].displacement;
}

/// The box of a body at t in the world, without the deviation in a span.
/// @param pose  at t
HalfAxisBox boxAt(const BodyBox (&box)[2], const Pose& pose, double t, double pad) {
  assert(0 <= t && t <= 1 && !(pad < 0));
  const BodyBox &from = box[0], &to = box[1];
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

int numSpans(const BodyBox (&box)[2], double acceleration, int most) {
  const double deviation = 0.125 * acceleration,
               wanted = kDeviation * std::max(box[0].radius, box[1].radius);
  int n = 1;
  while (n < most && deviation > wanted * n * n) n *= 2;
  assert(1 <= n && n <= most && most <= kMostSpans);
  return n;
}

[[noreturn]] void refuse(const std::string& name) {
  throw Exception(
      name +
      ": its geometry or its path is not finite, or too large for doubles. Give "
      "finite numbers");
}

bool isFinite(const HalfAxisBox& box) {
  return std::all_of(box.half, box.half + HalfAxisBox::kSides,
                     [](double x) { return std::isfinite(x); });
}

void appendUnbounded(BoundsList& list) {
  HalfAxisBox box;
  std::fill(box.half, box.half + HalfAxisBox::kSides, kUnbounded);
  list.items.push_back({list.boxes.size(), 1});
  list.boxes.insert(list.boxes.end(), 2, box);
}

/// A plane, or the halfspace n x <= d. Its normal is along an axis at all times: then it
/// is bounded along this axis.
/// @return whether it is
bool appendFlatAlongAxis(const FlatShape& shape, const MotionPath& path,
                         BoundsList& list) {
  if (!path.isTranslation()) return false;
  for (int end = 0; end < 2; ++end) {
    const Pose pose = path.pose(end);
    const Vec turned = rotated(pose.rotation, shape.normal);
    const double normal[3] = {turned.x, turned.y, turned.z};
    HalfAxisBox& box = list.boxes[list.items.back().first + std::size_t(end)];
    bool is_bounded = false;
    for (int k = 0; k < 3; ++k) {
      if (normal[k] == 0 || normal[(k + 1) % 3] != 0 || normal[(k + 2) % 3] != 0)
        continue;
      const double at = shape.offset / normal[k] + pose.translation[k],
                   room = kRoom * (std::abs(shape.offset / normal[k]) +
                                   path.largestTranslation());
      if (!shape.is_solid || normal[k] > 0) box.half[k + 3] = at + room;
      if (!shape.is_solid || normal[k] < 0) box.half[k] = room - at;
      is_bounded = true;
    }
    if (!is_bounded) return false;
  }
  return true;
}

/// The plane through the foot p(t) = R f + T with the normal n(t) = R m. The height of a
/// point x is n . (x - p) = n . (x - o) - n . (p - o), o the pivot. For x that goes
/// straight with the velocity v its second derivative is
///
///   n'' . (x - o) + 2 n' . v - (n'' . (p - o) + 2 n' . p' + n . p''),
///
/// with |n| <= stretch, |n'| <= w, |n''| <= A. The pivot is p(1/2), so that |p - o| is at
/// most half of the way of p. A bounds p'' of the body's point m, less that of its
/// origin. A turn and a spline have a number for this; a motion of the program may give
/// up to the sum of both.
MovingFlat movingFlat(const FlatShape& shape, const MotionPath& path) {
  const Vec foot = shape.foot();
  const double distance = norm(foot) * kUpward;
  const AccelerationBound bound = path.acceleration(0, 1);
  const double of_foot = bound.of(foot, 0), w = path.turnSpeed(),
               of_normal = bound.motion
                               ? bound.of(shape.normal, 0) + bound.of({0, 0, 0}, 0)
                               : bound.per_radius + bound.per_distance,
               speed = path.speed(distance);
  MovingFlat flat;
  flat.is_solid = shape.is_solid;
  flat.stretch = path.stretch() * kUpward;
  flat.bend = flat.bend_per_distance = flat.bend_per_speed = 0;
  if (!path.isTranslation() || of_foot > 0) {
    flat.bend_per_distance = of_normal * kUpward;
    flat.bend_per_speed = 2 * w * kUpward;
    flat.bend =
        (0.5 * of_normal * speed + 2 * w * speed + flat.stretch * of_foot) * kUpward;
  }
  // A query adds four times the error of a position (numerics.md).
  const double size = path.largestTranslation() + flat.stretch * distance;
  flat.room =
      kRoom * size + 8 * (path.positionError(distance) + path.rotationError() * speed);
  flat.room_per_distance = kRoom + 8 * path.rotationError();
  assert(!(flat.room < 0) && !(flat.bend < 0));
  const int n = flat.goesStraight() ? 1 : kMostSpans;
  const Vec pivot = posed(path.pose(0.5), foot);
  flat.pivot[0] = pivot.x;
  flat.pivot[1] = pivot.y;
  flat.pivot[2] = pivot.z;
  for (int i = 0; i <= n; ++i) {
    const Pose pose = path.pose(double(i) / n);
    const Vec normal = rotated(pose.rotation, shape.normal);
    flat.knots.push_back(
        {{normal.x, normal.y, normal.z}, dot(normal, posed(pose, foot) - pivot)});
  }
  return flat;
}

template <typename Shape>
void appendFlat(const Shape& flat, const MotionPath& path, BoundsList& list) {
  const double length =
      norm(Vec{double{flat.n[0]}, double{flat.n[1]}, double{flat.n[2]}});
  if (!std::isfinite(length) || !std::isfinite(flat.d)) refuse(path.name());
  appendUnbounded(list);
  if (!(length > 0)) return;  // a query refuses it
  const ConvexShape shape = convexShapeOf(flat, "object", 0);
  if (appendFlatAlongAxis(*shape.flat(), path, list)) return;
  list.items.back().flat = list.flats.size();
  list.flats.push_back(movingFlat(*shape.flat(), path));
}

/// A plane or a halfspace.
template <typename S>
bool isFlat(const CollisionGeometry<S>& o) {
  return o.getNodeType() == GEOM_PLANE || o.getNodeType() == GEOM_HALFSPACE;
}

/// @pre it is a plane or a halfspace
template <typename S>
void appendFlat(const PlacedGeometry<S>& placed, BoundsList& list) {
  requireFinite(placed.beginning(), placed.end(), "object");
  const CollisionGeometry<S>& o = placed.geometry();
  const MotionPath path = motionPathOf(placed, "object");
  if (o.getNodeType() == GEOM_PLANE)
    return appendFlat(static_cast<const Plane<S>&>(o), path, list);
  appendFlat(static_cast<const Halfspace<S>&>(o), path, list);
}

}  // namespace

const Pose& PathPoses::at(int i, int n) {
  assert(0 <= i && i <= n && 0 < n && kMostSpans % n == 0);
  std::optional<Pose>& pose = poses_[std::size_t(i * (kMostSpans / n))];
  if (!pose) pose = path_.pose(double(i) / n);
  return *pose;
}

void appendBox(const BodyBox (&body)[2], PathPoses& poses, int most_spans,
               BoundsList& list) {
  const MotionPath& path = poses.path();
  for (const BodyBox& box : body)
    if (!std::isfinite(norm(box.center) + box.radius)) refuse(path.name());
  const double acceleration = accelerationOf(poses.acceleration(), body);
  const int n = numSpans(body, acceleration, most_spans);
  const double stretch = path.stretch();
  double size = path.largestTranslation(), pad = 0;
  for (const BodyBox& box : body) {
    size = std::max(
        size, path.largestTranslation() + stretch * (norm(box.center) + box.radius));
    pad = std::max(pad,
                   stretch * box.pad + path.positionError(norm(box.center) + box.radius));
  }
  const std::size_t first = list.boxes.size();
  assert(!(acceleration < 0) && !(pad < 0));
  for (int i = 0; i <= n; ++i)
    list.boxes.push_back(boxAt(body, poses.at(i, n), double(i) / n, pad + kRoom * size));
  double before = 0;
  for (int i = 0; i <= n; ++i) {
    const double dt = 1. / n;
    double after = 0;
    if (i < n)
      after = 0.125 * dt * dt * kUpward *
              (n == 1 || path.hasConstantAcceleration()
                   ? acceleration
                   : accelerationOf(path.acceleration(i * dt, (i + 1) * dt), body));
    for (double& half : list.boxes[first + static_cast<std::size_t>(i)].half)
      half += std::max(before, after);
    before = after;
  }
  assert(list.boxes.size() == first + static_cast<std::size_t>(n) + 1);
  const auto end = list.boxes.end();
  if (!std::all_of(end - (n + 1), end, isFinite)) refuse(path.name());
  list.items.push_back({first, n});
}

void appendBody(const BoundedBody& body, BoundsList& list) {
  PathPoses poses(body.path);
  appendBox(body.box, poses, kMostSpans, list);
}

template <typename S>
bool isBounded(const PlacedGeometry<S>& placed) {
  return placed.moving().path != PathKind::kUnknown &&
         (placed.isShape()    ? !isFlat(placed.geometry())
          : placed.compound() ? placed.compound()->has_box
                              : placed.isMesh() || placed.isOctree());
}

template <typename S>
BoundedBody boundedBodyOf(const PlacedGeometry<S>& placed, const char* name) {
  assert(isBounded(placed));
  requireFinite(placed.beginning(), placed.end(), name);
  if (placed.isShape()) {
    const MotionPath path = motionPathOf(placed, name);
    const BodyBox box = convexShapeOf(placed.geometry(), name, 0).outerBox();
    return {{box, box}, path};
  }
  if (const auto* compound = placed.compound()) {
    requireParts(*compound, name);
    return {{compound->box, compound->box}, motionPathOf(placed, name)};
  }
  const PreparedMotion motion(placed, name, kDefaultTocErr, 1);
  if (motion.isEmpty()) return {{BodyBox(), BodyBox()}, motionPathOf(placed, name)};
  const MovingBody& body = motion.body();
  BoundedBody out{{body.box(body.root(), 0), body.box(body.root(), 1)}, body.path()};
  out.path.setName(name);
  return out;
}

template <typename S>
void appendBounds(const MovingGeometry<S>& moving, BoundsList& list) {
  const PlacedGeometry<S> placed(moving);
  if (isBounded(placed))
    appendBody(boundedBodyOf(placed, "object"), list);
  else if (placed.isShape() && moving.path != PathKind::kUnknown)
    appendFlat(placed, list);
  else
    appendUnbounded(list);
  visitModels(placed, [&list](const DeformableMesh& model) {
    list.addRevision(model.revision());
  });
}

#define FCL_CCD_INSTANTIATE(S)                                               \
  template bool isBounded(const PlacedGeometry<S>&);                         \
  template BoundedBody boundedBodyOf(const PlacedGeometry<S>&, const char*); \
  template void appendBounds(const MovingGeometry<S>&, BoundsList&);
FCL_CCD_INSTANTIATE(double)
FCL_CCD_INSTANTIATE(float)
#undef FCL_CCD_INSTANTIATE

}  // namespace detail
}  // namespace fcl
