// SPDX-License-Identifier: BSD-3-Clause
#include "shapes/posed_convex.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "numerics/error_bounds.h"
#include "paths/posed_vector.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

/// The corner of a box that is farthest along a direction; without the pad.
Vec cornerOf(const BodyBox& box, const Vec& d) {
  Vec corner = {box.center[0], box.center[1], box.center[2]};
  for (int i = 0; i < 3; ++i) {
    const Vec axis = {box.axis[i][0], box.axis[i][1], box.axis[i][2]};
    corner = corner + (dot(axis, d) < 0 ? -box.extent[i] : box.extent[i]) * axis;
  }
  return corner;
}

/// Whether a ball around the origin that is inside of a tetrahedron reaches no corner,
/// and the origin is a mean of these. For assertions.
[[maybe_unused]] bool isDepthInside(const Vec (&corner)[4], const double (&weight)[4],
                                    double depth) {
  for (int i = 0; i < 4; ++i)
    if (weight[i] < 0 || depth > norm(corner[i]) * kUpward + 0x1p-500) return false;
  return true;
}

}  // namespace

Vec PosedConvex::support(const Vec& direction, int& piece) const {
  piece = 0;
  if (shape || box) {
    const Vec d = rotatedBack(pose.rotation, direction),
              local = shape ? shape->support(d, piece) : cornerOf(*box, d);
    return posed(pose, local);
  }
  piece = pieceAt(direction);
  return corner[piece];
}

int PosedConvex::pieceAt(const Vec& direction) const {
  assert(!box);
  if (shape) return shape->pieceAt(rotatedBack(pose.rotation, direction));
  double most = -HUGE_VAL;
  int farthest = 0;
  for (int k = 0; k < 3; ++k) {
    const double along = dot(corner[k], direction);
    if (!(along > most)) continue;
    most = along;
    farthest = k;
  }
  return farthest;
}

Vec PosedConvex::supportOf(int piece, const Vec& direction) const {
  assert(!box && piece >= 0 && (shape || piece < 3));
  if (!shape) return corner[piece];
  return posed(pose, shape->supportOf(piece, rotatedBack(pose.rotation, direction)));
}

void PosedConvex::setCurvature(int piece, const Vec& direction, const Vec (&axis)[2],
                               double (&out)[3]) const {
  out[0] = out[1] = out[2] = 0;
  if (!isCurved()) return;
  const Vec d = rotatedBack(pose.rotation, direction),
            x = rotatedBack(pose.rotation, axis[0]),
            y = rotatedBack(pose.rotation, axis[1]),
            along_x = shape->supportChange(piece, d, x);
  out[0] = dot(x, along_x);
  out[1] = dot(y, along_x);
  out[2] = dot(y, shape->supportChange(piece, d, y));
}

double PosedConvex::reach(const Vec& direction) const {
  int id;
  return dot(direction, support(direction, id));
}

Vec PosedConvex::flatNormal(const Vec& direction) const {
  if (!shape && !box) return cross(corner[1] - corner[0], corner[2] - corner[0]);
  Vec best = direction;
  double most = -1;
  for (const auto& axis : (shape ? shape->box() : *box).axis) {
    const Vec n = rotated(pose.rotation, {axis[0], axis[1], axis[2]});
    const double along = std::abs(dot(n, direction));
    if (!(along > most)) continue;
    most = along;
    best = n;
  }
  return best;
}

double depthInside(const Vec (&corner)[4], double (&weight)[4]) {
  constexpr double kRounding = 0x1p-48;
  double least = HUGE_VAL;
  for (int i = 0; i < 4; ++i) {
    const Vec &a = corner[(i + 1) % 4], u = corner[(i + 2) % 4] - a,
              v = corner[(i + 3) % 4] - a, n = cross(u, v);
    const double length = norm(n),
                 error = kRounding * norm(u) * norm(v) * norm(a) / length;
    if (!(error < HUGE_VAL)) return 0;
    const Vec across = corner[i] - a;
    const double opposite = dot(n, across) / length, origin = -dot(n, a) / length;
    // A flat tetrahedron has no inside.
    if (!(std::abs(opposite) > kRounding * norm(u) * norm(v) * norm(across) / length))
      return 0;
    least = std::min(least, (opposite > 0 ? origin : -origin) - error);
    weight[i] = origin / opposite;
  }
  assert(!(least > 0) || isDepthInside(corner, weight, least));
  return std::max(least, 0.);
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
