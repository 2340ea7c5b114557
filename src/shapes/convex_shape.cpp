// SPDX-License-Identifier: BSD-3-Clause
#include "shapes/convex_shape.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "numerics/error_bounds.h"
#include "paths/posed_vector.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

/// Whether the box contains the points of the core along its axes and diagonals, and none
/// of them is beyond the reach of its direction. For assertions.
[[maybe_unused]] bool isConsistent(const ConvexShape& shape) {
  const BodyBox& box = shape.box();
  const double size = norm(shape.center()) + box.radius, rounding = 0x1p-48 * size;
  // Squares of other sizes overflow or underflow; a query scales such shapes first.
  if (!(size > 0x1p-400 && size < 0x1p400)) return true;
  for (int i = 0; i < 27; ++i) {
    const int x = i % 3 - 1, y = i / 3 % 3 - 1, z = i / 9 - 1;
    const Vec d = {double(x), double(y), double(z)};
    if (maxNorm(d) == 0) continue;
    const Vec p = shape.support(d), from_center = p - shape.center();
    if (dot(p, d) > shape.reach(d) + rounding ||
        std::abs(from_center.x) > box.extent[0] + box.pad + rounding ||
        std::abs(from_center.y) > box.extent[1] + box.pad + rounding ||
        std::abs(from_center.z) > box.extent[2] + box.pad + rounding ||
        norm(from_center) > box.radius + rounding)
      return false;
  }
  return true;
}

[[maybe_unused]] bool isPowerOfTwo(double x) {
  int exponent;
  return std::frexp(x, &exponent) == 0.5;
}

}  // namespace

ConvexShape ConvexShape::flat(const FlatShape& flat, double other_radius) {
  assert(isUnit(flat.normal) && !(other_radius < 0));
  const Vec foot = flat.foot();
  ConvexShape shape(BoxCore({0, 0, 0}));
  // It has neither points nor an axis.
  shape.core_.emplace<HullCore>(std::vector<Vec>());
  shape.fills_box_ = false;
  shape.flat_ = flat;
  shape.box_.center[0] = foot.x;
  shape.box_.center[1] = foot.y;
  shape.box_.center[2] = foot.z;
  shape.box_.radius = (other_radius + std::sqrt(dot(foot, foot))) * kUpward;
  return shape;
}

ConvexShape ConvexShape::scaled(double factor, double other_radius) const {
  assert(isPowerOfTwo(factor));
  if (flat_)
    return flat({flat_->normal, factor * flat_->offset, flat_->is_solid}, other_radius);
  AnyCore core = core_;
  std::visit([factor](auto& of) { of.scale(factor); }, core);
  return ConvexShape(std::move(core), factor * radius_);
}

double ConvexShape::largestLength() const {
  return std::max({std::visit([](const auto& of) { return of.largestLength(); }, core_),
                   radius_, flat_ ? std::abs(flat_->offset) : 0});
}

bool ConvexShape::isCurved() const {
  return std::visit([](const auto& of) { return of.isCurved(); }, core_);
}

bool ConvexShape::containsCenter() const {
  return std::visit([](const auto& of) { return of.containsCenter(); }, core_);
}

bool ConvexShape::isBall() const {
  return std::visit([](const auto& of) { return of.isBall(); }, core_);
}

int ConvexShape::axisOfRevolution() const {
  return std::visit([](const auto& of) { return of.axisOfRevolution(); }, core_);
}

Vec ConvexShape::support(const Vec& d) const {
  assert(!flat_);
  return std::visit([&d](const auto& of) { return of.supportOf(of.pieceAt(d), d); },
                    core_);
}

Vec ConvexShape::support(const Vec& d, int& piece) const {
  assert(!flat_);
  return std::visit(
      [&](const auto& of) {
        piece = of.pieceAt(d);
        return of.supportOf(piece, d);
      },
      core_);
}

int ConvexShape::pieceAt(const Vec& d) const {
  assert(!flat_);
  return std::visit([&d](const auto& of) { return of.pieceAt(d); }, core_);
}

Vec ConvexShape::supportOf(int piece, const Vec& d) const {
  assert(!flat_);
  return std::visit([piece, &d](const auto& of) { return of.supportOf(piece, d); },
                    core_);
}

Vec ConvexShape::supportChange(int piece, const Vec& d, const Vec& change) const {
  assert(!flat_);
  return std::visit([&](const auto& of) { return of.supportChange(piece, d, change); },
                    core_);
}

double ConvexShape::reach(const Vec& d) const {
  assert(!flat_);
  return std::visit([&d](const auto& of) { return of.reach(d); }, core_);
}

BodyBox ConvexShape::outerBox() const {
  BodyBox box = box_;
  box.pad += radius_;
  box.radius = (box.radius + radius_) * kUpward;
  return box;
}

double ConvexShape::innerRadius(double factor) const {
  assert(0 <= factor && factor <= 1);
  const double inner =
      radius_ +
      factor * std::visit([](const auto& of) { return of.innerRadius(); }, core_);
  assert(!(inner > outerRadius() * kUpward + 0x1p-500));
  return inner;
}

void ConvexShape::setBox() {
  const CoreBox box = std::visit([](const auto& of) { return of.box(); }, core_);
  for (int i = 0; i < 3; ++i) box_.axis[i][i] = 1;
  box_.center[0] = box.center.x;
  box_.center[1] = box.center.y;
  box_.center[2] = box.center.z;
  box_.extent[0] = box.half_sides.x;
  box_.extent[1] = box.half_sides.y;
  box_.extent[2] = box.half_sides.z;
  // Every number here rounds by less than this.
  const double half = norm(box.half_sides);
  box_.pad = 0x1p-45 * (norm(box.center) + half);
  box_.radius = half * kUpward + box_.pad;
  fills_box_ = std::visit([this](const auto& of) { return of.fills(box_); }, core_);
  assert(isConsistent(*this));
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
