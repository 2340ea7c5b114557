// SPDX-License-Identifier: BSD-3-Clause
//
// The points of eight polygons that are nearest to the origin, the directions in which
// they are and how these turn: nearestPoint() and what belongs to it in
// distance_advance.h, with the same bits.
//
// Polygons is a type with the number of corners `count`, the number next(k) of the corner
// behind corner k, and the velocities of the corners, which nearestPoints() does not
// read.
//
// Included once for each of Highway's targets. So it has no ordinary include guard.
#include "elementary/least_length.h"
#include "elementary/nearest_point.h"
#include "kernels/kernels.h"
#include "kernels/lanes.h"
#include "kernels/vectors.h"

#if defined(FCL_CCD_NEAREST_POINTS_INCLUDED) == defined(HWY_TARGET_TOGGLE)
#ifdef FCL_CCD_NEAREST_POINTS_INCLUDED
#undef FCL_CCD_NEAREST_POINTS_INCLUDED
#else
#define FCL_CCD_NEAREST_POINTS_INCLUDED
#endif

HWY_BEFORE_NAMESPACE();
namespace fcl {
namespace detail {
namespace deformable {
namespace HWY_NAMESPACE {

/// The numbers of parts as Doubles have them.
constexpr double kCorner = Approach::kCorner, kInside = Approach::kInside;

/// NearestPoint of eight polygons.
struct NearestPoints {
  Vectors point, normal;
  Doubles square, distance;
  Doubles part, along, across;
  /// The lanes whose nearest point is not inside of a sliver.
  DoubleMask is_sure;

  FCL_CCD_INLINE DoubleMask isInside() const { return part == all(kInside); }
  FCL_CCD_INLINE DoubleMask isSide() const { return part < all(kCorner); }
};

/// The nearest points of the sides.
template <typename Polygons>
FCL_CCD_INLINE void takeSides(const Polygons& x, const Vectors (&corner)[4],
                              NearestPoints& best) {
  const Doubles zero = all(0), one = all(1);
  for (int k = 0; k < x.count; ++k) {
    const int l = x.next(k);
    const Vectors &p = corner[k], &q = corner[l], way = q - p;
    const Doubles length = dot(way, way), along = zero - dot(p, way);
    const DoubleMask is_behind = along > zero, is_before = along < length;
    const Doubles share = select(is_behind, select(is_before, along / length, one), zero);
    const Vectors point = select(is_behind, select(is_before, p + share * way, q), p);
    const Doubles square = dot(point, point);
    const DoubleMask is_shorter = square < best.square;
    const Doubles part = select(share == zero, all(kCorner + k),
                                select(share == one, all(kCorner + l), all(k)));
    best.point = select(is_shorter, point, best.point);
    best.square = select(is_shorter, square, best.square);
    best.part = select(is_shorter, part, best.part);
    best.along = select(is_shorter, share, best.along);
  }
}

/// nearestPoint().
template <typename Polygons>
FCL_CCD_INLINE NearestPoints nearestPoints(const Polygons& x,
                                           const Vectors (&corner)[4]) {
  const Doubles zero = all(0);
  const Vectors &p = corner[0], v = corner[1] - p, w = corner[x.count - 1] - p;
  NearestPoints sides, near;
  near.normal = cross(v, w);
  const Doubles square = dot(near.normal, near.normal),
                along = dot(cross(w, p), near.normal),
                across = dot(cross(p, v), near.normal);
  const DoubleMask is_inside =
      (along > zero) & (across > zero) &
      (x.count == 3 ? along + across < square : (along < square) & (across < square));
  const Doubles share = along / square;
  near.across = across / square;
  const Vectors point = p + share * v + near.across * w;
  // A lane whose nearest point is inside begins with the square 0, so that no side takes
  // its place.
  sides.square = select(is_inside, all(0), all(HUGE_VAL));
  sides.part = all(kInside);
  sides.along = share;
  sides.point = point;
  takeSides(x, corner, sides);
  near.point = sides.point;
  near.square = select(is_inside, dot(point, point), sides.square);
  near.part = sides.part;
  near.along = sides.along;
  near.distance = squareRoot(near.square);
  near.is_sure =
      (near.part < all(kInside)) |
      ((square > all(kLeastSquare)) & (square > all(kSliver) * (dot(v, v) * dot(w, w))));
  return near;
}

/// The corner or the side that is nearest, and how it moves.
struct NearestSides {
  /// The corner, or where the side begins; and where it ends.
  Vectors from, to, from_velocity, to_velocity;

  NearestSides() = default;
  template <typename Polygons>
  FCL_CCD_INLINE NearestSides(const Polygons& x, const Vectors (&corner)[4],
                              const NearestPoints& near)
      : from(corner[0]),
        to(corner[1]),
        from_velocity(x.velocity[0]),
        to_velocity(x.velocity[1]) {
    for (int k = 1; k < x.count; ++k) {
      const DoubleMask is_it = (near.part == all(k)) | (near.part == all(kCorner + k));
      from = select(is_it, corner[k], from);
      to = select(is_it, corner[x.next(k)], to);
      from_velocity = select(is_it, x.velocity[k], from_velocity);
      to_velocity = select(is_it, x.velocity[x.next(k)], to_velocity);
    }
  }
};

/// directionApart(), its first attempt. Lanes without a direction are not finite.
FCL_CCD_INLINE Vectors directionsApart(const NearestPoints& near,
                                       const NearestSides& sides) {
  const Doubles one = all(1);
  const Doubles sign = select(dot(near.normal, near.point) < all(0), all(-1), one);
  const Vectors normal = sign * near.normal;
  const DoubleMask is_inside = near.isInside();
  const Doubles length =
      select(is_inside, squareRoot(dot(normal, normal)), near.distance);
  const Vectors n = (one / length) * select(is_inside, normal, near.point);
  const Vectors side = sides.to - sides.from;
  const Vectors across = n - (dot(n, side) / dot(side, side)) * side;
  const Doubles rest = squareRoot(dot(across, across));
  return select(near.isSide(), (one / rest) * across, n);
}

FCL_CCD_INLINE Vectors without(const Vectors& v, const Vectors& n) {
  return v - dot(v, n) * n;
}

/// turnApart().
template <typename Polygons>
FCL_CCD_INLINE Vectors turnsApart(const Polygons& x, const Vectors (&corner)[4],
                                  const NearestPoints& near, const NearestSides& sides,
                                  const Vectors& n) {
  const Doubles one = all(1);
  const Vectors of_corner = (one / near.distance) * without(sides.from_velocity, n);

  const Vectors side = sides.to - sides.from,
                change = sides.to_velocity - sides.from_velocity, beside = cross(side, n),
                moved = sides.from_velocity + near.along * change;
  const Doubles square = dot(side, side);
  const Vectors of_side = ((all(0) - dot(n, change)) / square) * side +
                          (dot(beside, moved) / (square * near.distance)) * beside;

  const int last = x.count - 1;
  const Vectors v = corner[1] - corner[0], w = corner[last] - corner[0],
                dv = x.velocity[1] - x.velocity[0], dw = x.velocity[last] - x.velocity[0];
  const Vectors of_inside =
      (one / dot(near.normal, n)) * without(cross(dv, w) + cross(v, dw), n);
  return select(near.isInside(), of_inside, select(near.isSide(), of_side, of_corner));
}

/// firstRoot().
FCL_CCD_INLINE Doubles firstRoots(const Doubles& gap, const Doubles& rate,
                                  const Doubles& bend) {
  const Doubles zero = all(0), discriminant = rate * rate - all(4) * gap * bend;
  const Doubles root = squareRoot(discriminant), divisor = root - rate;
  const DoubleMask opens = rate > zero;
  const DoubleMask closes = (opens & (bend < zero)) | ((rate <= zero) & (divisor > zero));
  const Doubles time =
      select(opens, root + rate, all(2) * gap) / select(opens, all(-2) * bend, divisor);
  return select((discriminant >= zero) & closes, time, all(HUGE_VAL));
}

}  // namespace HWY_NAMESPACE
}  // namespace deformable
}  // namespace detail
}  // namespace fcl
HWY_AFTER_NAMESPACE();

#endif
