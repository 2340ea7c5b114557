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
double reach(const OrientedBox& box, const double (&direction)[3]) {
  return std::abs(dot(box.axis[0], direction)) * box.extent[0] +
         std::abs(dot(box.axis[1], direction)) * box.extent[1] +
         std::abs(dot(box.axis[2], direction)) * box.extent[2];
}

/// Boxes are tested if their extents are at least this many times as large as the motion,
/// because few boxes that move further are proved apart as a rule (AxisTrials). It was
/// measured with two spheres of 100,352 triangles that touch: the test makes the query
/// 17% slower for a limit of 0, 6% for 1, 1% for 4 and 8. If the boxes only interlock,
/// all of these are equally fast, and a limit of 16 is too large.
constexpr float kExtentsOfMotion = 4;

/// Whether (1 - t) g0 + t g1 + 4 t (1 - t) s > 0 for all t in [0, 1]. For s < 0 that is
/// so if sqrt(g0) + sqrt(g1) > 2 sqrt(-s): rounding is in the gaps' pad.
bool staysPositive(double g0, double g1, double s) {
  if (!(g0 > 0 && g1 > 0)) return false;
  const double root = s < 0 ? std::sqrt(g0) + std::sqrt(g1) : 0;
  return !(s < 0) || root * root > -4 * s;
}

/// A box at both ends of the step.
struct TurningBox {
  OrientedBox at[2];
};

/// How far along a direction the bends of the points of a box reach.
struct BendReach {
  double least{0}, most{0};

  /// @param translation  of the mesh, at both ends
  BendReach(const Bend* bend, const TurningBox& box, const double (&translation)[2][3],
            const double (&direction)[3]) {
    if (!bend) return;
    double half[3];
    for (int k = 0; k < 3; ++k)
      half[k] =
          0.5 * (bend->matrix[k] * direction[0] + bend->matrix[3 + k] * direction[1] +
                 bend->matrix[6 + k] * direction[2]);
    const double center = dot(half, box.at[0].center) + dot(half, box.at[1].center) +
                          dot(half, translation[0]) + dot(half, translation[1]) +
                          dot(direction, bend->offset),
                 around = reach(box.at[0], half) + reach(box.at[1], half);
    least = center - around;
    most = center + around;
  }
};

double sizeOf(const OrientedBox& box) { return size(box.center) + 2 * size(box.extent); }

}  // namespace

SeparatingAxes::SeparatingAxes(const MeshInstance& a, const MeshInstance& b,
                               double distance)
    : a_(a),
      b_(b),
      distance_(distance * (1 + 0x1p-40)),
      are_oriented_(a.rigid.isOriented() || b.rigid.isOriented()),
      turn_(a.rigid.turns() || b.rigid.turns() || a.bend || b.bend) {
  for (int frame = 0; frame < 2; ++frame) {
    for (int k = 0; k < 3; ++k)
      translation_[frame][k] = b.translation[frame][k] - a.translation[frame][k];
    size_ += size(a.translation[frame]) + size(b.translation[frame]);
  }
  for (const Bend* bend : {a.bend, b.bend}) {
    if (!bend) continue;
    double square = 0;
    for (const double x : bend->matrix) square += x * x;
    stretch_ = std::max(stretch_, 1 + std::sqrt(square));
    size_ += size(bend->offset);
  }
  double motion = 0;
  for (int k = 0; k < 3; ++k) motion += std::abs(translation_[1][k] - translation_[0][k]);
  least_extents_ = are_oriented_ && !turn_ ? kExtentsOfMotion * static_cast<float>(motion)
                                           : std::numeric_limits<float>::infinity();
}

bool SeparatingAxes::areApart(int i, int j) const {
  if (turn_) return turnApart(i, j);
  OrientedBox a, b;
  a_.rigid.orientedBox(i, a);
  b_.rigid.orientedBox(j, b);
  double from[3], to[3];
  for (int k = 0; k < 3; ++k) {
    const double between = b.center[k] - a.center[k];
    from[k] = between + translation_[0][k];
    to[k] = between + translation_[1][k];
  }
  const double pad = padOf(sizeOf(a) + sizeOf(b));
  const auto isSeparating = [&](const double(&axis)[3]) {
    // The length of an axis is at most size(axis).
    const double depth = reach(a, axis) + reach(b, axis) + (pad + distance_) * size(axis);
    const double along_from = dot(from, axis), along_to = dot(to, axis);
    return (along_from > depth && along_to > depth) ||
           (along_from < -depth && along_to < -depth);
  };
  return std::any_of(a.axis, a.axis + 3, isSeparating) ||
         std::any_of(b.axis, b.axis + 3, isSeparating);
}

// Points stand out of their boxes by at most the slack times their coordinates. The sum
// below bounds these coordinates, since the axes are unit vectors. The slack is at least
// 2^12 units of rounding. The rounding of these functions, and of the points' own
// translation, is less than 64 units.
double SeparatingAxes::padOf(double sizes) const {
  return stretch_ * (size_ + sizes) * std::max(a_.rigid.slack(), b_.rigid.slack()) +
         DBL_MIN;
}

// Each vertex goes straight from its place in the first pose to that in the last one, and
// its bend is added. Along a fixed direction gaps are linear in t without the bends.
bool SeparatingAxes::turnApart(int i, int j) const {
  TurningBox a, b;
  double sizes = 0, between[2][3];
  for (auto frame : {0, 1}) {
    a_.rigid.orientedBox(i, a.at[frame], frame);
    b_.rigid.orientedBox(j, b.at[frame], frame);
    for (int k = 0; k < 3; ++k)
      between[frame][k] =
          b.at[frame].center[k] - a.at[frame].center[k] + translation_[frame][k];
    sizes += sizeOf(a.at[frame]) + sizeOf(b.at[frame]);
  }
  const double pad = padOf(sizes) + distance_;
  const auto separates = [&](const TurningBox& box, int k) {
    double axis[3];
    for (int c = 0; c < 3; ++c) axis[c] = box.at[0].axis[k][c] + box.at[1].axis[k][c];
    double along[2], depth[2];
    for (auto frame : {0, 1}) {
      along[frame] = dot(between[frame], axis);
      depth[frame] =
          reach(a.at[frame], axis) + reach(b.at[frame], axis) + pad * size(axis);
    }
    const bool is_below = along[0] < 0;
    const double side = is_below ? -1 : 1, g0 = side * along[0] - depth[0],
                 g1 = side * along[1] - depth[1];
    if (!(g0 > 0 && g1 > 0)) return false;
    const BendReach of_a(a_.bend, a, a_.translation, axis),
        of_b(b_.bend, b, b_.translation, axis);
    return staysPositive(g0, g1,
                         is_below ? of_a.least - of_b.most : of_b.least - of_a.most);
  };
  for (int k = 0; k < 3; ++k)
    if (separates(a, k) || separates(b, k)) return true;
  return false;
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
