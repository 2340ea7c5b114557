// SPDX-License-Identifier: BSD-3-Clause
#include "api/unbounded_shapes.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "api/prepared_motion.h"
#include "fcl/geometry/shape/halfspace.h"
#include "fcl/geometry/shape/plane.h"
#include "motion/convex_advance.h"
#include "motion/posed_vector.h"
#include "numerics/error_bounds.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

/// All x with n . x = offset, or n . x <= offset.
struct Flat {
  Vec normal;
  double offset[2];
  bool is_solid;
  /// Of the coordinates: offsets round by a few u of it.
  double size;
};

template <typename Shape>
Flat flatOf(const Shape& shape, const Pose& beginning, const Pose& end, bool is_solid) {
  const Vec n = {static_cast<double>(shape.n[0]), static_cast<double>(shape.n[1]),
                 static_cast<double>(shape.n[2])};
  // The plane through the foot, which a matrix that scales moves.
  const Vec posed_n = rotated(beginning.rotation, n);
  const double posed_length = norm(posed_n),
               offset = static_cast<double>(shape.d) * (posed_length / dot(n, n));
  Flat out{(1 / posed_length) * posed_n, {}, is_solid, 0};
  for (int k = 0; k < 2; ++k) {
    const double(&t)[3] = (k == 0 ? beginning : end).translation;
    out.offset[k] = dot(out.normal, vecOf(t)) + offset;
    out.size = std::max(out.size, std::hypot(t[0], t[1], t[2]) + std::abs(offset));
  }
  return out;
}

template <typename S>
Flat flatOf(const PlacedGeometry<S>& placed, const char* name) {
  const CollisionGeometry<S>& shape = placed.geometry();
  convexShapeOf(shape, name, 1);
  if (shape.getNodeType() == GEOM_PLANE)
    return flatOf(static_cast<const Plane<S>&>(shape), placed.beginning(), placed.end(),
                  false);
  return flatOf(static_cast<const Halfspace<S>&>(shape), placed.beginning(), placed.end(),
                true);
}

/// How far apart two parallel flats are at both ends of the step. A gap that is not
/// positive at an end is a contact; in between it is linear.
struct FlatGap {
  double at[2];
  /// 1: b is on the side of a's normal; -1: on the other side.
  double side{1};

  FlatGap(const Flat& a, const Flat& b) {
    const bool is_same_side = dot(a.normal, b.normal) > 0;
    double between[2];
    for (int k = 0; k < 2; ++k)
      between[k] = (is_same_side ? b.offset[k] : -b.offset[k]) - a.offset[k];
    // Which of them is above: a halfspace is below its plane, if it has a's direction.
    if (!a.is_solid && b.is_solid && is_same_side) side = -1;
    if (!a.is_solid && !b.is_solid && between[0] < 0) side = -1;
    const bool overlap = a.is_solid && b.is_solid && is_same_side;
    for (int k = 0; k < 2; ++k) at[k] = overlap ? 0 : side * between[k];
  }
};

/// The distance of contact of two flats, or what they have at t = 0 in its place: as
/// ConvexPairMotion::ignoreInitiallyCloser().
double distanceOf(double initial_gap, double tolerance, const QueryOptions& options) {
  const double own = initial_gap * (1 - ConvexPairMotion::kNearerShare) - 2 * tolerance;
  if (!options.ignores_initially_closer || !(own > 0)) return options.min_distance;
  return std::min(options.min_distance, own);
}

}  // namespace

template <typename S>
ShapeAnswer queryUnbounded(const PlacedGeometry<S>& o1, const PlacedGeometry<S>& o2,
                           const QueryOptions& options) {
  constexpr double kParallel = 0x1p-48;
  requireRotations(o1, "o1");
  requireRotations(o2, "o2");
  const Flat a = flatOf(o1, "o1"), b = flatOf(o2, "o2");
  ShapeAnswer answer;
  if (options.filter && !options.filter->rules().accept(-1, -1)) return answer;
  ShapeContact contact{};
  contact.kind = ContinuousContactKind::kShapes;
  std::fill(contact.vertices, contact.vertices + 3, -1);
  std::fill(contact.triangles, contact.triangles + 2, -1);
  contact.position = a.offset[0] * a.normal;
  const bool are_parallel = o1.goesStraight() && o2.goesStraight() &&
                            maxNorm(cross(a.normal, b.normal)) <= kParallel;
  if (are_parallel) {
    const FlatGap gap(a, b);
    const double tolerance = 128 * kUnit * (a.size + b.size),
                 distance = distanceOf(gap.at[0], tolerance, options),
                 begin = gap.at[0] - distance - tolerance,
                 end = gap.at[1] - distance - tolerance;
    if (begin > 0) {
      if (end > 0) return answer;
      const double t = begin / (begin - end);
      contact.toc_lo = t * (1 - 0x1p-48);
      contact.toc_hi = contact.toc_lo;
      contact.within_tolerance = true;
      if (contact.toc_lo > options.t_max) return answer;
    }
    if (begin > 0) contact.normal = gap.side * a.normal;
    contact.position =
        ((1 - contact.toc_lo) * a.offset[0] + contact.toc_lo * a.offset[1]) * a.normal;
  }
  answer.contacts.push_back(contact);
  // Two planes overlap at no other time.
  answer.pose_time = contact.toc_hi;
  if (contact.toc_lo > 0 && (a.is_solid || b.is_solid) && !(options.min_distance > 0))
    answer.pose_time = std::min(options.t_max, contact.toc_lo + options.toc_err);
  answer.counts.contacts = 1;
  return answer;
}

template ShapeAnswer queryUnbounded(const PlacedGeometry<double>&,
                                    const PlacedGeometry<double>&, const QueryOptions&);
template ShapeAnswer queryUnbounded(const PlacedGeometry<float>&,
                                    const PlacedGeometry<float>&, const QueryOptions&);

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
