// SPDX-License-Identifier: BSD-3-Clause
#include "tree/separating_axes.h"

#include <algorithm>
#include <cassert>
#include <cfloat>
#include <cmath>
#include <limits>

namespace fcl {
namespace detail {
namespace deformable {
namespace {

double dot(const double (&x)[3], const double (&y)[3]) {
  return x[0] * y[0] + x[1] * y[1] + x[2] * y[2];
}

double size(const double (&x)[3]) {
  return std::abs(x[0]) + std::abs(x[1]) + std::abs(x[2]);
}

/// The largest distance of a point of the box from its center, along a direction.
double halfExtent(const OrientedBox& box, const double (&direction)[3]) {
  return std::abs(dot(box.axis[0], direction)) * box.extent[0] +
         std::abs(dot(box.axis[1], direction)) * box.extent[1] +
         std::abs(dot(box.axis[2], direction)) * box.extent[2];
}

/// Boxes are tested if their extents are at least this many times as large as the motion,
/// because few boxes that move further are proved apart as a rule (AxisTrials). With a
/// lower limit the test makes a query of meshes that touch slower: by up to 17% where
/// there is no limit, by 1% with this one. With 16 it misses boxes that it could prove
/// apart where meshes interlock without touching.
constexpr float kExtentsOfMotion = 4;

double sizeOf(const OrientedBox& box) { return size(box.center) + 2 * size(box.extent); }

}  // namespace

SeparatingAxes::SeparatingAxes(const MeshInstance& a, const MeshInstance& b,
                               double distance)
    : a_(a.rigid),
      b_(b.rigid),
      distance_(distance * (1 + 0x1p-40)),
      are_oriented_(a_.isOriented() || b_.isOriented()) {
  assert(!a.tree && !b.tree && distance >= 0);
  for (int frame = 0; frame < 2; ++frame) {
    for (int k = 0; k < 3; ++k)
      translation_[frame][k] = b.translation[frame][k] - a.translation[frame][k];
    size_ += size(a.translation[frame]) + size(b.translation[frame]);
  }
  double motion = 0;
  for (int k = 0; k < 3; ++k) motion += std::abs(translation_[1][k] - translation_[0][k]);
  least_extents_ = are_oriented_ ? kExtentsOfMotion * static_cast<float>(motion)
                                 : std::numeric_limits<float>::infinity();
}

bool SeparatingAxes::areApart(int i, int j) const {
  assert(!a_.turns() && !b_.turns());
  OrientedBox a, b;
  a_.orientedBox(i, a);
  b_.orientedBox(j, b);
  double from[3], to[3];
  for (int k = 0; k < 3; ++k) {
    const double between = b.center[k] - a.center[k];
    from[k] = between + translation_[0][k];
    to[k] = between + translation_[1][k];
  }
  const double pad = padOf(sizeOf(a) + sizeOf(b));
  assert(!(pad < 0));
  const auto isSeparating = [&](const double(&axis)[3]) {
    // The length of an axis is at most size(axis).
    const double depth =
        halfExtent(a, axis) + halfExtent(b, axis) + (pad + distance_) * size(axis);
    const double along_from = dot(from, axis), along_to = dot(to, axis);
    return (along_from > depth && along_to > depth) ||
           (along_from < -depth && along_to < -depth);
  };
  return std::any_of(a.axis, a.axis + 3, isSeparating) ||
         std::any_of(b.axis, b.axis + 3, isSeparating);
}

// Points stand out of their boxes by at most the slack times their coordinates. The sum
// below bounds these coordinates, since the axes are unit vectors. The slack is at least
// 2^12 units of rounding. The rounding of areApart(), and of the points' own
// translation, is less than 32 units.
double SeparatingAxes::padOf(double sizes) const {
  return (size_ + sizes) * std::max(a_.slack(), b_.slack()) + DBL_MIN;
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
