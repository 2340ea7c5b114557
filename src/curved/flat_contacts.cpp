// SPDX-License-Identifier: BSD-3-Clause
#include "curved/flat_contacts.h"

#include <algorithm>
#include <cassert>

#include "advance/convex_advance.h"
#include "numerics/error_bounds.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

/// How far apart two parallel flats are at both ends of the step; negative: how deep they
/// overlap. A gap that is not positive at an end is a contact; in between it is linear.
struct FlatGap {
  double at[2];
  /// 1: b is on the side of a's normal; -1: on the other side.
  double side{1};
  /// Halfspaces that are below the same side always overlap.
  bool can_part{true};

  FlatGap(const PosedFlat& a, const PosedFlat& b) {
    const bool is_same_side = dot(a.normal, b.normal) > 0;
    double between[2];
    for (int k = 0; k < 2; ++k)
      between[k] = (is_same_side ? b.offset[k] : -b.offset[k]) - a.offset[k];
    // Which of them is above: a halfspace is below its plane, if it has a's direction.
    if (!a.is_solid && b.is_solid && is_same_side) side = -1;
    if (!a.is_solid && !b.is_solid && between[0] < 0) side = -1;
    can_part = !(a.is_solid && b.is_solid && is_same_side);
    for (int k = 0; k < 2; ++k) at[k] = can_part ? side * between[k] : 0;
  }
};

/// The distance of contact of two flats, or what they have at t = 0 in its place: as
/// ConvexAdvance::ignoreInitiallyCloser().
double distanceOf(double initial_gap, double tolerance, const QueryOptions& options) {
  const double own = initial_gap * (1 - ConvexAdvance::kNearerShare) - 2 * tolerance;
  if (!options.ignores_initially_closer || !(own > 0)) return options.min_distance;
  return std::min(options.min_distance, own);
}

}  // namespace

QueryAnswer queryFlats(const PosedFlat& a, const PosedFlat& b,
                       const QueryOptions& options) {
  constexpr double kParallel = 0x1p-48;
  QueryAnswer answer;
  if (options.filter && !options.filter->rules().accept(-1, -1)) return answer;
  DescribedContact contact;
  Vec position = a.offset[0] * a.normal;
  const bool are_parallel = a.goes_straight && b.goes_straight &&
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
      assert(!(t < 0) && !(t > 1));
      contact.toc_lo = t * (1 - 0x1p-48);
      contact.toc_hi = contact.toc_lo;
      // They are not in contact yet.
      assert(!(begin + (end - begin) * contact.toc_lo < 0));
      contact.within_tolerance = true;
      if (contact.toc_lo > options.t_max) return answer;
    }
    if (options.with_geometry && gap.can_part) {
      contact.normal = gap.side * a.normal;
      contact.depth = std::max(-gap.at[0], 0.);
    }
    position =
        ((1 - contact.toc_lo) * a.offset[0] + contact.toc_lo * a.offset[1]) * a.normal;
  }
  if (options.with_geometry) contact.position = position;
  answer.shape_contacts.push_back(contact);
  answer.first = {contact.toc_lo, contact.toc_hi};
  // Two planes overlap at no other time.
  answer.pose_time = contact.toc_hi;
  if (contact.toc_lo > 0 && (a.is_solid || b.is_solid) && !(options.min_distance > 0))
    answer.pose_time = std::min(options.t_max, contact.toc_lo + options.toc_err);
  assert(!(answer.pose_time < answer.first.hi) && !(answer.pose_time > 1));
  answer.counts.contacts = 1;
  return answer;
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
