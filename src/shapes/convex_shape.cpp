// SPDX-License-Identifier: BSD-3-Clause
#include "shapes/convex_shape.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "numerics/error_bounds.h"
#include "paths/posed_vector.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

/// Pieces of a cone, a cylinder and a capsule.
constexpr int kBase = 0, kTip = 1, kTop = 1;

/// As norm(), also where squares are too small or too large for doubles.
double anyNorm(const Vec& v) {
  const double square = dot(v, v);
  return square > 0x1p-900 && square < 0x1p900 ? std::sqrt(square)
                                               : std::hypot(v.x, v.y, v.z);
}

/// The farthest point of a circle around the z axis.
Vec onCircle(double radius, double height, const Vec& d) {
  const double length = anyNorm({d.x, d.y, 0});
  if (!(length > 0)) return {0, 0, height};
  return {radius * (d.x / length), radius * (d.y / length), height};
}

double circleReach(double radius, const Vec& d) {
  return radius * anyNorm({d.x, d.y, 0});
}

}  // namespace

ConvexShape ConvexShape::hull(std::vector<Vec> points) {
  ConvexShape shape(Kind::kHull, {0, 0, 0});
  shape.points_ = std::move(points);
  shape.setBoxOfHull();
  return shape;
}

ConvexShape ConvexShape::capsule(double radius, double half_length) {
  ConvexShape shape(Kind::kCapsule, {0, 0, half_length});
  shape.radius_ = radius;
  shape.setBox({0, 0, 0}, shape.size_);
  shape.fills_box_ = true;
  return shape;
}

ConvexShape ConvexShape::cuboid(const Vec& half_sides) {
  ConvexShape shape(Kind::kCuboid, half_sides);
  shape.setBox({0, 0, 0}, half_sides);
  shape.fills_box_ = true;
  return shape;
}

ConvexShape ConvexShape::ellipsoid(const Vec& half_axes) {
  ConvexShape shape(Kind::kEllipsoid, half_axes);
  shape.setBox({0, 0, 0}, half_axes);
  return shape;
}

ConvexShape ConvexShape::cone(double radius, double height) {
  ConvexShape shape(Kind::kCone, {radius, radius, 0.5 * height});
  shape.setBox({0, 0, 0}, shape.size_);
  return shape;
}

ConvexShape ConvexShape::cylinder(double radius, double height) {
  ConvexShape shape(Kind::kCylinder, {radius, radius, 0.5 * height});
  shape.setBox({0, 0, 0}, shape.size_);
  return shape;
}

ConvexShape ConvexShape::flat(const FlatShape& flat, double reach) {
  const Vec foot = flat.foot();
  ConvexShape shape(Kind::kFlat, {0, 0, 0});
  shape.flat_ = flat;
  for (int i = 0; i < 3; ++i) shape.box_.axis[i][i] = 1;
  shape.box_.center[0] = foot.x;
  shape.box_.center[1] = foot.y;
  shape.box_.center[2] = foot.z;
  shape.box_.radius = (reach + std::sqrt(dot(foot, foot))) * kUpward;
  return shape;
}

ConvexShape ConvexShape::scaled(double factor, double reach) const {
  if (kind_ == Kind::kFlat)
    return flat({flat_.normal, factor * flat_.offset, flat_.is_solid}, reach);
  if (kind_ == Kind::kHull) {
    std::vector<Vec> points = points_;
    for (Vec& p : points) p = factor * p;
    return hull(std::move(points));
  }
  ConvexShape out(kind_, factor * size_);
  out.radius_ = factor * radius_;
  out.fills_box_ = fills_box_;
  out.setBox({0, 0, 0}, out.size_);
  return out;
}

double ConvexShape::largestLength() const {
  double most = std::max({maxNorm(size_), radius_, std::abs(flat_.offset)});
  for (const Vec& p : points_) most = std::max(most, maxNorm(p));
  return most;
}

bool ConvexShape::isBall() const {
  if (kind_ == Kind::kCapsule) return size_.z == 0;
  return kind_ == Kind::kEllipsoid && size_.x == size_.y && size_.y == size_.z;
}

int ConvexShape::axisOfRevolution() const {
  switch (kind_) {
    case Kind::kCapsule:
    case Kind::kCone:
    case Kind::kCylinder:
      return 2;
    case Kind::kEllipsoid:
      if (size_.x == size_.y) return 2;
      return size_.y == size_.z ? 0 : size_.x == size_.z ? 1 : -1;
    default:
      return -1;
  }
}

int ConvexShape::pieceAt(const Vec& d) const {
  switch (kind_) {
    case Kind::kCapsule:
      return d.z > 0 ? kTop : kBase;
    case Kind::kCuboid:
      return (d.x > 0 ? 1 : 0) + (d.y > 0 ? 2 : 0) + (d.z > 0 ? 4 : 0);
    case Kind::kEllipsoid:
      return 0;
    case Kind::kCone:
      return size_.z * d.z >= circleReach(size_.x, d) - size_.z * d.z ? kTip : kBase;
    case Kind::kCylinder:
      return d.z < 0 ? kBase : kTop;
    default:
      break;
  }
  std::size_t farthest = 0;
  double most = dot(points_.front(), d);
  for (std::size_t i = 1; i < points_.size(); ++i) {
    const double along = dot(points_[i], d);
    if (!(along > most)) continue;
    most = along;
    farthest = i;
  }
  return static_cast<int>(farthest);
}

Vec ConvexShape::supportOf(int piece, const Vec& d) const {
  switch (kind_) {
    case Kind::kCapsule:
      return {0, 0, piece == kBase ? -size_.z : size_.z};
    case Kind::kCuboid:
      return {piece % 2 == 0 ? -size_.x : size_.x,
              piece / 2 % 2 == 0 ? -size_.y : size_.y, piece < 4 ? -size_.z : size_.z};
    case Kind::kEllipsoid: {
      const Vec scaled = {size_.x * d.x, size_.y * d.y, size_.z * d.z};
      const double length = anyNorm(scaled);
      if (!(length > 0)) return {0, 0, 0};
      return {size_.x * (scaled.x / length), size_.y * (scaled.y / length),
              size_.z * (scaled.z / length)};
    }
    case Kind::kCone:
      if (piece == kTip) return {0, 0, size_.z};
      return onCircle(size_.x, -size_.z, d);
    case Kind::kCylinder:
      return onCircle(size_.x, piece == kBase ? -size_.z : size_.z, d);
    default:
      return points_[static_cast<std::size_t>(piece)];
  }
}

Vec ConvexShape::support(const Vec& d) const { return supportOf(pieceAt(d), d); }

Vec ConvexShape::supportChange(int piece, const Vec& d, const Vec& change) const {
  if (!isCurved() || (kind_ == Kind::kCone && piece == kTip)) return {0, 0, 0};
  const bool is_ellipsoid = kind_ == Kind::kEllipsoid;
  // The derivative of a unit vector, between two changes of scale.
  const Vec scale = {size_.x, size_.y, is_ellipsoid ? size_.z : 0},
            along = {scale.x * d.x, scale.y * d.y, scale.z * d.z},
            moved = {scale.x * change.x, scale.y * change.y, scale.z * change.z};
  const double length = anyNorm(along);
  if (!(length > 0)) return {0, 0, 0};
  const Vec n = (1 / length) * along, across = moved - dot(n, moved) * n;
  return {scale.x * (across.x / length), scale.y * (across.y / length),
          scale.z * (across.z / length)};
}

double ConvexShape::reach(const Vec& d) const {
  switch (kind_) {
    case Kind::kCapsule:
      return size_.z * std::abs(d.z);
    case Kind::kCuboid:
      return size_.x * std::abs(d.x) + size_.y * std::abs(d.y) + size_.z * std::abs(d.z);
    case Kind::kEllipsoid:
      return anyNorm({size_.x * d.x, size_.y * d.y, size_.z * d.z});
    case Kind::kCone:
      return std::max(size_.z * d.z, circleReach(size_.x, d) - size_.z * d.z);
    case Kind::kCylinder:
      return circleReach(size_.x, d) + size_.z * std::abs(d.z);
    default:
      return dot(support(d), d);
  }
}

double ConvexShape::innerRadius() const {
  switch (kind_) {
    case Kind::kCuboid:
    case Kind::kEllipsoid:
    case Kind::kCylinder:
      return std::min({size_.x, size_.y, size_.z});
    case Kind::kCone: {
      // The distance of the line from the base to the tip.
      const double length = std::sqrt(size_.x * size_.x + 4 * size_.z * size_.z);
      return length > 0 ? size_.x * (size_.z / length) : 0;
    }
    default:
      return 0;
  }
}

void ConvexShape::setBoxOfHull() {
  constexpr Vec kAxes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  double center[3], half_side[3];
  for (int i = 0; i < 3; ++i) {
    const double upper = reach(kAxes[i]), lower = -reach(-1. * kAxes[i]);
    center[i] = 0.5 * (upper + lower);
    half_side[i] = 0.5 * (upper - lower);
  }
  setBox(vecOf(center), vecOf(half_side));
  fills_box_ = hasCornersOfBox();
}

void ConvexShape::setBox(const Vec& center, const Vec& half_sides) {
  for (int i = 0; i < 3; ++i) box_.axis[i][i] = 1;
  box_.center[0] = center.x;
  box_.center[1] = center.y;
  box_.center[2] = center.z;
  box_.extent[0] = half_sides.x;
  box_.extent[1] = half_sides.y;
  box_.extent[2] = half_sides.z;
  // Every number here rounds by less than this.
  const double half = norm(half_sides);
  box_.pad = 0x1p-45 * (norm(center) + half);
  box_.radius = half * kUpward + box_.pad;
}

bool ConvexShape::hasCornersOfBox() const {
  for (unsigned corner = 0; corner < 8; ++corner) {
    Vec p = center();
    for (unsigned i = 0; i < 3; ++i)
      p = p + ((corner >> i & 1U) != 0 ? box_.extent[i] : -box_.extent[i]) *
                  vecOf(box_.axis[i]);
    if (std::none_of(points_.begin(), points_.end(),
                     [&](const Vec& x) { return norm(x - p) <= box_.pad; }))
      return false;
  }
  return true;
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
