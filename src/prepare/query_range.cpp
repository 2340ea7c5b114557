// SPDX-License-Identifier: BSD-3-Clause
#include "prepare/query_range.h"

#include <algorithm>
#include <cmath>

#include "fcl/common/exception.h"

namespace fcl {
namespace detail {
namespace {

using deformable::PreparedMotion;

/// Products of lengths have up to six factors: the square of e x (e x w), for an edge e
/// and a way w. Both are differences of points, below twice the sum of the sizes of both
/// bodies. So for sizes up to 2^160 such a product is below (2^162)^6 = 2^972, times a
/// few units. For a size of 2^-140 it is 2^-840: it stays a normal number, with all its
/// digits, also for edges and ways 2^-30 as long. (Below
/// that a direction may be far from the best, or round to 0: such a pair can be reported
/// early, never late.)
constexpr double kMostSize = 0x1p160, kLeastSize = 0x1p-140;
/// The square of such a size, and of a length 2^-11 of it, is a normal number. The boxes
/// of FCL's tree are made from such squares.
constexpr double kLeastProvenSize = 0x1p-500;

template <typename S>
double largestLength(const MovingGeometry<S>& o, const PreparedMotion& motion) {
  double most = motion.body().shape()->largestLength();
  const auto take = [&most](const auto& lengths) {
    for (const auto x : lengths) most = std::max(most, std::abs(double{x}));
  };
  for (const PoseNumbers<S>& pose : o.pose) take(pose.translation);
  take(o.reference);
  take(o.offset.translation);
  if (o.path == PathKind::kSpline)
    for (const auto& point : o.control[0]) take(point);
  return most;
}

template <typename S>
bool canBeScaled(const MovingGeometry<S>& o, const PreparedMotion& motion) {
  return motion.body().shape() && o.path != PathKind::kBounded;
}

}  // namespace

void requireProvenRange(const PreparedMotion& motion1, const PreparedMotion& motion2) {
  if (!(motion1.size() + motion2.size() <= kMostSize))
    throw Exception(
        "o1 and o2: with their paths they have coordinates beyond 2^160. Use larger "
        "units");
}

void requireLeastSize(const PreparedMotion& motion1, const PreparedMotion& motion2) {
  const double size = motion1.size() + motion2.size();
  if (size > 0 && size < kLeastProvenSize)
    throw Exception(
        "o1 and o2: with their paths they have coordinates below 2^-500. Use smaller "
        "units");
}

template <typename S>
double scaleOf(const MovingGeometry<S>& o1, const PreparedMotion& motion1,
               const MovingGeometry<S>& o2, const PreparedMotion& motion2,
               double distance) {
  const double bodies = motion1.size() + motion2.size();
  double size = bodies + distance;
  if (bodies >= kLeastSize && size <= kMostSize) return 1;
  if (!canBeScaled(o1, motion1) || !canBeScaled(o2, motion2)) {
    requireProvenRange(motion1, motion2);
    requireLeastSize(motion1, motion2);
    return 1;
  }
  if (size >= kLeastSize && size <= kMostSize) return 1;
  if (size < kLeastSize)
    size = std::max({largestLength(o1, motion1), largestLength(o2, motion2), distance});
  if (!(size > 0)) return 1;
  // 2^1000 makes the least double 2^-74.
  constexpr int kMostShift = 1000;
  return std::ldexp(1, std::min(-std::ilogb(size), kMostShift));
}

template <typename S>
bool isWellInRange(const PlacedGeometry<S>& o, const deformable::ConvexShape& shape) {
  constexpr double kMostWell = 0x1p40;
  for (const deformable::Pose* pose : {&o.beginning(), &o.end()})
    for (const double x : pose->translation)
      if (!(std::abs(x) <= kMostWell)) return false;
  // A flat has no size that counts. The center of a hull is bounded by its radius, whose
  // margin for rounding is 2^-45 of the center: it is below 2^85.
  if (const auto* flat = shape.flat()) return std::abs(flat->offset) <= kMostWell;
  const double size = shape.outerRadius();
  return size >= kLeastSize && size <= kMostWell;
}

template <typename S>
MovingGeometry<S> scaledPath(const MovingGeometry<S>& o, double factor) {
  MovingGeometry<S> out = o;
  for (PoseNumbers<S>& pose : out.pose)
    for (S& x : pose.translation) x = static_cast<S>(factor * double{x});
  for (double& x : out.reference) x *= factor;
  for (double& x : out.offset.translation) x *= factor;
  for (auto& point : out.control[0])
    for (double& x : point) x *= factor;
  return out;
}

#define FCL_CCD_INSTANTIATE(S)                                                           \
  template double scaleOf(const MovingGeometry<S>&, const PreparedMotion&,               \
                          const MovingGeometry<S>&, const PreparedMotion&, double);      \
  template bool isWellInRange(const PlacedGeometry<S>&, const deformable::ConvexShape&); \
  template MovingGeometry<S> scaledPath(const MovingGeometry<S>&, double);
FCL_CCD_INSTANTIATE(double)
FCL_CCD_INSTANTIATE(float)
#undef FCL_CCD_INSTANTIATE

}  // namespace detail
}  // namespace fcl
